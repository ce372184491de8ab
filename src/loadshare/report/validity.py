"""What to think of the size of displacements, in words."""

from __future__ import annotations

from loadshare.certify.validity import TOLD
from loadshare.report.numbers import runs
from loadshare.results import Result


def advice(result: Result) -> str:
    """What to think of displacements above the bound of a warning; empty if there are none."""
    names = dict.fromkeys(n for p in result.positions for n in p.validity.warned)
    if not names:
        return ""
    where = ", ".join(runs(p.position for p in result.positions if p.validity.warned))
    told = "; ".join(TOLD[name] for name in names)
    noun = "positions" if len(result.positions) > 1 else "position"
    return (
        f"displacements are large for the geometry in which they were found ({noun} {where}: "
        f"{told}); figures may be off by some per cent"
    )
