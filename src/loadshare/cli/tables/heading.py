"""What is solved."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.console import Console

from loadshare.case import Case
from loadshare.cli.exits import counted
from loadshare.cli.refusal import ranges


def print_heading(
    console: Console,
    case: Case,
    file: str,
    count: int,
    wanted: Sequence[int],
    changes: Iterable[str],
) -> None:
    """Print title, file, load and positions of a case.

    Parameters
    ----------
    console : Console
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
    operating = case.operating
    torques = operating.input_torque
    low, high = min(torques), max(torques)
    load = f"{high:.7g}" if low == high else f"{low:.7g} to {high:.7g}"
    solved = counted(count, "position")
    if len(wanted) < count:
        solved = f"{ranges(list(wanted))} of {solved}"
    console.print(case.title or case.name, style="bold")
    console.print(file, soft_wrap=True)
    for change in changes:
        console.print(f"changed: {change}", soft_wrap=True)
    console.print(
        f"Input torque {load} N·m on gear {operating.input}, "
        f"output gear {operating.output}; {solved}"
    )
    turning = any(errors.eccentricity is not None for errors in case.errors.values())
    if turning and case.march is None and count > 1 and operating.rotation == "neglected":
        console.print(
            "Gears stand still over the mesh cycle: eccentricities keep their first direction"
        )
