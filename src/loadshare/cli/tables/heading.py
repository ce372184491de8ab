"""What is solved."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from loadshare.case import Case
from loadshare.cli.console import say
from loadshare.cli.exits import counted
from loadshare.cli.refusal import ranges
from loadshare.report.records import load_told


def print_heading(
    case: Case,
    file: str,
    count: int,
    wanted: Sequence[int],
    changes: Iterable[str],
) -> None:
    """Print title, file, load and positions of a case.

    Parameters
    ----------
    case : Case
    file : str
        As the user named it.
    count : int
        Positions of the case.
    wanted : sequence of int
        Positions that are solved.
    changes : iterable of str
        Changes made from the command line.
    """
    solved = counted(count, "position")
    if len(wanted) < count:
        solved = f"{ranges(list(wanted))} of {solved}"
    say(case.title or case.name, style="bold")
    say(file, whole=True)
    for change in changes:
        say(f"changed: {change}", whole=True)
    say(f"{load_told(case)}; {solved}")
    turning = any(errors.eccentricity is not None for errors in case.errors.values())
    if turning and case.march is None and count > 1 and case.operating.rotation == "neglected":
        say("Gears stand still over the mesh cycle: eccentricities keep their first direction")
