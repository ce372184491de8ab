"""Changes to a case from the command line: ``--set KEY=VALUE``."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from typing import Any

import typer


def read_changes(settings: Iterable[str]) -> dict[str, Any]:
    """Return the changes that ``--set`` asks for, as `Case.replace` takes them.

    Parameters
    ----------
    settings : iterable of str
        ``KEY=VALUE`` each. A value is read as TOML; what is not TOML is a text, so that quantities
        need no quotes. No value removes the key.

    Raises
    ------
    typer.BadParameter
        For a setting without a key or without an equals sign.
    """
    changes: dict[str, Any] = {}
    for setting in settings:
        key, equals, value = setting.partition("=")
        if not key.strip() or not equals:
            raise typer.BadParameter(
                f"{setting!r} is not of the form KEY=VALUE, as in operating.torque='100 N*m'",
                param_hint="--set",
            )
        changes[key.strip()] = _value(value.strip())
    return changes


def _value(text: str) -> Any:
    if not text:
        return None
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
