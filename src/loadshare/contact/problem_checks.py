"""Faults of a contact problem that was written by hand: wrong kinds, shapes, numbers and names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from loadshare.array_types import floats
from loadshare.contact.arc import Arc
from loadshare.contact.law import Law
from loadshare.contact.law_checks import law_faults
from loadshare.contact.problem import ArcRow, ContactProblem, FollowingLaw, Radial, Row
from loadshare.contact.radial import RadialLaw, RollingLaw
from loadshare.settings import CONTACT

KINDS = {"coordinates": str, "rows": Row, "arcs": ArcRow, "radials": Radial}


def check_problem(problem: object) -> None:
    """Check that the parts of a contact problem fit together.

    Raises
    ------
    TypeError
        If it is no contact problem.
    ValueError
        If they do not; the message has all faults, one per line.
    """
    if not isinstance(problem, ContactProblem):
        raise TypeError(f"a ContactProblem is expected, not {type(problem).__name__}")
    wrong = list(_misplaced(problem))
    if not wrong:
        wrong = [*_unfit(problem), *_lawless(problem)]
        wrong = [*(wrong or _pushing(problem.stiffness)), *_misnamed(problem)]
    if wrong:
        raise ValueError("\n".join(wrong))


def _misplaced(problem: ContactProblem) -> Iterator[str]:
    """Yield what is in the place of something of another kind."""
    for what, kind in KINDS.items():
        given = getattr(problem, what)
        if not isinstance(given, tuple):
            yield f"{what}: {given!r} is no sequence of {kind.__name__}"
            continue
        others = (one for one in given if not isinstance(one, kind))
        yield from (f"{what}: {one!r} is no {kind.__name__}" for one in others)
        parts: list[Any] = [one for one in given if isinstance(one, Row | ArcRow | Radial)]
        for one in parts:
            if not isinstance(one.name, str):
                yield f"{what}: the name {one.name!r} is no str"
            if isinstance(one, ArcRow) and not isinstance(one.arc, Arc):
                yield f"arc of {one.name}: {one.arc!r} is no Arc"
            if isinstance(one, Radial) and not isinstance(one.levers, Mapping):
                yield f"levers of {one.name}: {one.levers!r} is no mapping"


def _unfit(problem: ContactProblem) -> Iterator[str]:
    """Yield arrays that are no finite numbers, do not fit the coordinates or touch nothing."""
    if not problem.size:
        yield "coordinates: there are none"
    for what, array, shape in _arrays(problem):
        if not isinstance(array, np.ndarray):
            yield f"{what}: contains something other than numbers"
        elif array.shape != shape:
            yield f"{what}: has shape {array.shape}, but {shape} is needed"
        elif not np.isfinite(array).all():
            yield f"{what}: contains a number that is not finite"
        elif what.startswith(("vector", "relative", "matrix")) and not array.any():
            yield f"{what}: is zero, so it touches nothing"
        elif what.startswith("nominal") and not array.any():
            yield f"{what}: is zero, so that the two bodies have one centre"


def _arrays(problem: ContactProblem) -> Iterator[tuple[str, Any, tuple[int, ...]]]:
    """Yield every array of numbers: its name, the array, and the shape that it should have."""
    n = problem.size
    yield "stiffness", problem.stiffness, (n, n)
    yield "load", problem.load, (n,)
    for row in problem.rows:
        yield f"vector of {row.name}", row.vector, (n,)
        yield f"gap of {row.name}", floats(row.gap), ()
    for arc in problem.arcs:
        yield f"relative of {arc.name}", arc.relative, (3, n)
        yield f"nominal of {arc.name}", arc.arc.nominal, (3,)
        yield f"shift of {arc.name}", arc.arc.shift, (3,)
        yield f"clearance of {arc.name}", floats(arc.arc.clearance), ()
        yield f"sagitta of {arc.name}", floats(arc.sagitta), ()
    for radial in problem.radials:
        yield f"matrix of {radial.name}", radial.matrix, (2, n)
        yield f"centre of {radial.name}", radial.centre, (2,)
        for name, lever in radial.levers.items():
            yield f"lever of {name} over {radial.name}", floats(lever), ()


def _lawless(problem: ContactProblem) -> Iterator[str]:
    """Yield what is no law, or no law under which something pushes where it touches."""
    rows: list[Row | ArcRow] = [*problem.rows, *problem.arcs]
    laws: list[tuple[str, object, Any]]
    laws = [(f"law of {row.name}", row.law, Law) for row in rows]
    radial = RadialLaw | RollingLaw | FollowingLaw
    laws += [(f"source of {r.name}", r.source, radial) for r in problem.radials]
    for what, law, kind in laws:
        faults = list(law_faults(law))
        if not faults and (isinstance(law, type) or not isinstance(law, kind)):
            faults = [f"{law!r} is not a law"]
        yield from (f"{what}: {fault}" for fault in faults)


def _pushing(stiffness: Any) -> Iterator[str]:
    """Yield why a stiffness is not one of springs."""
    if not np.array_equal(stiffness, stiffness.T):
        yield "stiffness: is not symmetric"
    elif np.linalg.eigvalsh(stiffness)[0] < -CONTACT.singular * np.abs(stiffness).max():
        yield "stiffness: has a negative eigenvalue, so springs would push"


def _misnamed(problem: ContactProblem) -> Iterator[str]:
    """Yield names that stand for two things, and those that stand for nothing."""
    elements: list[Row | ArcRow | Radial] = [*problem.rows, *problem.arcs, *problem.radials]
    names = [*problem.coordinates, *(one.name for one in elements)]
    twice = sorted({name for name in names if names.count(name) > 1})
    yield from (f"{name}: two elements or coordinates have this name" for name in twice)
    for radial in problem.radials:
        unknown = (name for name in radial.levers if name not in problem.laws)
        yield from (f"levers of {radial.name}: {name!r} is no row or arc" for name in unknown)
