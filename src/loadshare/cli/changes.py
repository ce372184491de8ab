"""A case from the command line, with the changes that were asked for: ``KEY=VALUE``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from loadshare.cli.files import keep_inputs

if TYPE_CHECKING:
    from loadshare.case import Case


def open_case(file: Path, settings: Iterable[str] | None) -> Case:
    """Return the case of a file, changed as the command line asks.

    Parameters
    ----------
    file : Path
    settings : iterable of str or None
        As for `read_changes`.

    Raises
    ------
    CaseError
        With all problems of the case.
    typer.BadParameter
        If the command is asked to write over a file of the case.
    """
    from loadshare.case import load_case

    changes = read_changes(settings or ())
    keep_inputs([file])
    case = load_case(file, changes=changes)
    keep_inputs(case.files)
    return case


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
    import tomllib

    if not text:
        return None
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        # Of TOML that is none, numbers with thousands of digits, and what is nested too deeply.
        return text
