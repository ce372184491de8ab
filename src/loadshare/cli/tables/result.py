"""The complete printout of a result."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from rich.text import Text

from loadshare.case import Case
from loadshare.certify import FloatState
from loadshare.cli.console import say, say_all
from loadshare.cli.exits import places, ranges
from loadshare.cli.tables.table import fits, show, show_table, table, texts
from loadshare.numbers import NONE, counted, decimals, fixed, small
from loadshare.report import records, tables
from loadshare.report.words import advice, undetermined_lines
from loadshare.results import Position, Result
from loadshare.results.share import NO_STAGES

MOST = 6
"""Largest number of positions that are shown side by side."""
RESTS = "Floating gears: displacement x, y and margin [µm], reaction of the ring [N]"


def print_result(result: Result, wanted: int, *, loads: bool = False, cycle: bool = False) -> None:
    """Print load sharing, coefficients, floats, displacements and the certificate.

    Parameters
    ----------
    result : Result
        Result of the certified positions.
    wanted : int
        Number of positions that were asked for.
    loads : bool
        Whether to print what gears, bearings and shafts carry.
    cycle : bool
        Whether to print what meshes and train do at every position.
    """
    certified = [p.position for p in result.positions]
    if len(certified) < wanted:
        say(f"The following holds for the certified positions only: {ranges(certified)}")
    print_sharing(result)
    print_omega(result)
    print_floats(result)
    if loads:
        print_loads(result)
    if cycle:
        print_cycle(result)
    print_validity(result)
    print_certificate(result, wanted)


def print_omega(result: Result) -> None:
    """Print the largest Ω of every stage and of the system, and where each is reached."""
    if not result.stages:
        say(f"\n{NO_STAGES}")
        return
    show_table(tables.omega_table(result))


def print_loads(result: Result) -> None:
    """Print external torques, torques of shafts and forces on bearings, the largest of each."""
    show_table(tables.load_table(result), notes=False)


def print_cycle(result: Result) -> None:
    """Print transmission error, stiffness, share and point of the cycle at every position."""
    show_table(tables.yield_table(result), notes=False)
    if len(result.positions) > 1:
        say(records.error_text(result))
    fields = ("mesh", "position", "cycle point", "Ω stage", "error", "stiffness", "at the driver")
    title = "Meshes: transmission error [µm], stiffness [N/µm] and at the driver [N·m/rad]"
    show(title, texts(records.meshes(result), fields, words=("mesh",)))


def print_validity(result: Result) -> None:
    """Print the largest displacements over the positions, their bounds, and a warning above one."""
    show_table(tables.validity_table(result), notes=False)
    warning = advice(result)
    if warning:
        say(Text.assemble(("WARNING", "bold yellow"), f"  {warning}"))


def print_certificate(result: Result, wanted: int) -> None:
    """Print the worst value of every residual over the positions, and the verdict."""
    show_table(tables.certificate_table(result), notes=False)
    proved = records.proved(result)
    none = "no bound on the torques is proved, but they are in balance"
    say(none if math.isinf(proved) else f"torques proved to {small(proved)} of the largest")
    passed = result.passed and len(result.positions) == wanted
    certified = sum(p.certificate.passed for p in result.positions)
    say(
        Text.assemble(
            ("PASSED", "bold green") if passed else ("REFUSED", "bold red"),
            f"  {certified} of {counted(wanted, 'position')} certified; worst "
            f"{small(result.certificate.worst)}, allowed {result.stamp.tolerance:.0e}",
        )
    )
    verdict = result.uniqueness.text
    say(f"{verdict[0].upper()}{verdict[1:]}.")


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
        Number of positions of the case.
    wanted : sequence of int
        Positions that are solved.
    changes : iterable of str
        Changes made from the command line.
    """
    solved = counted(count, "position")
    if len(wanted) < count:
        # The noun comes first: "3 of 5 positions" would say how many, not which.
        solved = f"{places(list(wanted))} of {count}"
    say(case.title or case.name, style="bold")
    say(file, whole=True)
    for change in changes:
        say(f"changed: {change}", whole=True)
    say(f"{records.load_text(case)}; {solved}")
    turning = any(errors.eccentricity is not None for errors in case.errors.values())
    if turning and case.march is None and count > 1 and case.operating.rotation == "neglected":
        say("Gears do not rotate over the mesh cycle: eccentricities keep their initial direction")


def print_sharing(result: Result) -> None:
    """Print the torque of every mesh: once if alike everywhere, else by position, or summed up."""
    alike = records.alike(result)
    rows = list(records.torques(result, "alike" if alike else "each"))
    made = texts(rows, rows[0], words=("stage", "mesh"))
    if not alike and (len(result.positions) > MOST or not fits(made)):
        rows = list(records.torques(result, "summed"))
        made = texts(rows, rows[0], words=("stage", "mesh"))
    show("Load sharing: torque on the driver [N·m]", made)
    say_all([*records.torque_notes(result, rows), *_coast(result)])


def _coast(result: Result) -> list[str]:
    """Say which meshes are squeezed: both their flanks carry load."""
    places, least = records.torque_places(result), records.unloaded(result)
    most: dict[str, float] = {}
    for p in result.positions:
        for mesh, coast in p.coast_torque.items():
            if min(coast, p.torque[mesh] + coast) > least:
                most[mesh] = max(coast, most.get(mesh, 0.0))
    return [
        f"Mesh {mesh}: the coast flank carries up to {fixed(torque, places)} N·m; "
        "the torque shown is the difference."
        for mesh, torque in most.items()
    ]


def print_floats(result: Result) -> None:
    """Print where the floats rest, and which displacements and rotations forces leave open."""
    if result.positions[0].floats:
        _print_rests(result.positions)
    lines = undetermined_lines(result.positions)
    note = "Where displacements are not determined, the smallest are given."
    say_all([*lines, *([note] if lines else [])])


def _print_rests(positions: tuple[Position, ...]) -> None:
    """Print where every float rests: once if alike everywhere, else by position, or summed up."""
    places = records.reaction_places(positions)
    each = {g: [_rest(p, g, places) for p in positions] for g in positions[0].floats}
    alike = all(rests.count(rests[0]) == len(rests) for rests in each.values())
    heads = ["gear", "rests", "x", "y", "margin", "reaction", "spline"]
    rows: list[tuple[str, ...]]
    if alike:
        rows = [(gear, *rests[0]) for gear, rests in each.items()]
    elif len(positions) <= MOST:
        heads.insert(1, "at")
        rows = [
            (gear, str(p.position), *rest)
            for gear, rests in each.items()
            for p, rest in zip(positions, rests, strict=True)
        ]
    else:
        heads[2:4] = ["displacement"]
        rows = [(gear, *_summed(positions, gear)) for gear in each]
    if not any(f.spline for p in positions for f in p.floats.values()):
        heads, rows = heads[:-1], [row[:-1] for row in rows]
    show(RESTS, table(heads, rows, words=("gear", "rests", "spline")))
    say_all(["The same at all positions."] if alike and len(positions) > 1 else [])


def _rest(position: Position, gear: str, places: int) -> tuple[str, ...]:
    cells = records.rest(position, gear, places).values()
    return _state(position.floats[gear]), *(cell.text for cell in cells)


def _state(rest: FloatState) -> str:
    return f"{rest.state}: {rest.boundary}" if rest.boundary else rest.state


def _summed(positions: tuple[Position, ...], gear: str) -> Iterator[str]:
    rests = [p.floats[gear] for p in positions]
    yield _shares(_state(r) for r in rests)
    yield _span([1e6 * math.hypot(*p.displacement[gear]) for p in positions])
    yield _span([1e6 * r.margin for r in rests if r.margin is not None])
    yield _span([math.hypot(*r.reaction) for r in rests])
    yield _shares(r.spline or NONE for r in rests)


def _span(values: list[float]) -> str:
    if not values:
        return NONE
    places = min(decimals(values), 3)
    low, high = fixed(min(values), places), fixed(max(values), places)
    return low if low == high else f"{low} … {high}"


def _shares(states: Iterable[str]) -> str:
    """Return the states; if there are several, each with its number of positions."""
    counts = Counter(states)
    if len(counts) == 1:
        return next(iter(counts))
    return "\n".join(f"{state} ({count}×)" for state, count in counts.most_common())
