"""Completion in the shell: names from the case on the command line."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from loadshare.case import Case


def setting_names(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the keys of the case, each with an equals sign behind it."""
    return [f"{key}=" for key in key_names(ctx, incomplete)]


def key_names(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the keys of the case that hold a value."""
    from loadshare.case.keys import dotted
    from loadshare.study.parameter import leaves

    case = _case(ctx)
    keys = map(dotted, leaves(case.to_dict()) if case else ())
    return [key for key in keys if key.startswith(incomplete)]


def gear_names(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the names of the case's gears."""
    case = _case(ctx)
    return [name for name in (case.gears if case else ()) if name.startswith(incomplete)]


def study_names(ctx: typer.Context, incomplete: str) -> list[tuple[str, str]]:
    """Return the studies that the case holds, each with its kind."""
    case = _case(ctx)
    held = case.study.items() if case else ()
    return [(name, block.kind) for name, block in held if name.startswith(incomplete)]


def kind_names(incomplete: str) -> list[str]:
    """Return the kinds of case that `new` writes."""
    from loadshare.case.starter import KINDS

    return [kind for kind in KINDS if kind.startswith(incomplete)]


def _case(ctx: typer.Context) -> Case | None:
    """Return the case that is named on the command line; None if there is none, or not yet."""
    from loadshare.case import load_case
    from loadshare.errors import LoadshareError

    given = ctx.params.get("case")
    if given is None:
        return None
    try:
        return load_case(Path(given))
    except (LoadshareError, OSError):
        return None
