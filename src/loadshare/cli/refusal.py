"""What is printed and written when an answer is refused."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any, NoReturn

from loadshare._version import __version__
from loadshare.cli.exits import REFUSED, fail
from loadshare.errors import Refused
from loadshare.report.numbers import runs

_PLACED = re.compile(r"position (\d+): (.*)")


def refusal_lines(refusal: Refused) -> list[str]:
    """Return the lines of a refusal, positions that were refused for the same reason together."""
    positions: dict[str, list[int]] = {}
    for line in str(refusal).splitlines():
        placed = _PLACED.fullmatch(line)
        reason = placed[2] if placed else line
        positions.setdefault(reason, []).extend([int(placed[1])] if placed else [])
    return [f"{_named(places)}{reason}" for reason, places in positions.items()]


def _named(positions: list[int]) -> str:
    return f"{places(positions)}: " if positions else ""


def places(positions: list[int]) -> str:
    """Return positions in short: ``positions 1-3, 7``."""
    return f"position{'s' * (len(positions) > 1)} {ranges(positions)}"


def ranges(numbers: list[int]) -> str:
    """Return whole numbers in short: ``1-3, 7``."""
    # A plain hyphen: terminals and logs may know no other dash.
    return ", ".join(runs(numbers, "-"))


def fail_refused(refusal: Refused, more: Iterable[str] = ()) -> NoReturn:
    """Write the lines of a refusal, and more, to stderr and leave with the code of a refusal.

    Raises
    ------
    typer.Exit
        Always.
    """
    fail([*(f"REFUSED  {line}" for line in refusal_lines(refusal)), *more], REFUSED)


def refused_document(refusal: Refused, case: str) -> dict[str, Any]:
    """Return the JSON form of a refusal: the certified positions, and what was refused and why.

    Parameters
    ----------
    refusal : Refused
    case : str
        Name of the case, for a refusal without any certified position.
    """
    none: dict[str, Any] = {"case": case, "version": __version__, "positions": [], "omega": {}}
    document = none if refusal.partial is None else refusal.partial.to_dict()
    # JSON has no infinity and no NaN; such a figure is written as null.
    figures = {n: v if math.isfinite(v) else None for n, v in refusal.figures.items()}
    return document | {"refused": {"message": str(refusal), "figures": figures}}
