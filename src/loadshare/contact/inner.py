"""Solve one programme: on an active set that still holds, or by a back-end and the exact solve."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.contact.backends.backend import Backend, BackendFailure
from loadshare.contact.exact import ActiveSet, first_guess, identify, solve_exact
from loadshare.contact.findings import StepBudget, Unsolved
from loadshare.contact.programme import Point, Programme
from loadshare.contact.proximal import solve_proximal


@dataclass(frozen=True, slots=True, eq=False)
class Inner:
    """Answer of one programme, its active set, and how it was found."""

    point: Point
    active: ActiveSet | None
    via: str


def solve_programme(
    programme: Programme,
    backend: Backend,
    warm: Inner | None,
    polish: bool,
    work: StepBudget | None = None,
) -> Inner:
    """Solve a programme.

    Parameters
    ----------
    programme : Programme
    backend : Backend
    warm : Inner or None
        Answer of a neighbouring programme (the pass before); its active set is tried first.
    polish : bool
        Whether to solve exactly on the identified active set.
    work : StepBudget, optional
        See `solve_exact`.

    Raises
    ------
    Unsolved
        If the programme contradicts itself or no consistent active set is found.
    """
    kind = programme.kind
    if polish and kind == "linear":
        exact = solve_exact(programme, first_guess(programme), work=work)
        if exact is None:
            raise Unsolved("the linear system contradicts itself")
        return Inner(*exact, "linear solve")
    if polish and warm is not None and warm.active is not None and warm.active.fits(programme):
        exact = solve_exact(programme, warm.active, warm.point, rounds=3, work=work)
        if exact is not None:
            return Inner(*exact, "active set kept")
    if kind not in backend.kinds:
        raise Unsolved(f"{backend.name} does not solve programmes of class {kind}")
    try:
        rough = backend.solve(programme)
    except BackendFailure as failure:
        if not polish:
            raise Unsolved(str(failure)) from failure
        return Inner(*solve_proximal(programme, None, work), "proximal + exact")
    if not polish:
        return Inner(rough, None, backend.name)
    point, active, via = _from_rough(programme, rough, work)
    return Inner(point, active, f"{backend.name} + {via}")


def solve_near(programme: Programme, point: Point) -> tuple[Point, ActiveSet]:
    """Solve a programme exactly, given an answer of a few digits.

    Raises
    ------
    Unsolved
        If the programme contradicts itself or no consistent active set is found.
    """
    found, active, _ = _from_rough(programme, point, None)
    return found, active


def _from_rough(
    programme: Programme, rough: Point, work: StepBudget | None
) -> tuple[Point, ActiveSet, str]:
    """Solve exactly, given an answer of a few digits; also return how.

    Coordinates that forces leave open take their least norm. If contacts that carry nothing close
    and open there without end, these coordinates stay where the answer has them: an interior point
    keeps clear of such contacts.
    """
    guess = identify(programme, rough)
    exact = solve_exact(programme, guess, rough, work=work)
    if exact is not None:
        return *exact, "exact"
    try:
        return *solve_proximal(programme, rough, work), "proximal + exact"
    except Unsolved:
        for shared, via in ((False, "exact in place"), (True, "exact as shared")):
            exact = solve_exact(programme, guess, rough, work=work, stay=True, shared=shared)
            if exact is not None:
                return *exact, via
        raise
