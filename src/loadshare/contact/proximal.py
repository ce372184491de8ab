r"""The proximal method of multipliers, for programmes whose active set cannot be read off.

Rigid contacts that oppose each other, contacts on the verge, and coordinates that only contacts
hold make the exact active-set equations singular. Here every pass adds a small stiffness and a
small compliance that pull towards the pass before,

.. math:: \tfrac{\varepsilon}{2}\lVert x - x_k\rVert^2, \qquad
          a_e\cdot x - b_e F_e - \varepsilon (F_e - F_{e,k}) \le g_e ,

so that each pass is positive definite and its active set is found by exchange. The passes converge
to an answer of the original programme; as soon as the active set stays, the exact solve on it is
tried.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.exact import ActiveSet, at_rest, first_guess, solve_exact
from loadshare.contact.findings import StepBudget, Unsolved
from loadshare.contact.programme import Point, Programme
from loadshare.settings import CONTACT


def solve_proximal(
    programme: Programme, start: Point | None = None, work: StepBudget | None = None
) -> tuple[Point, ActiveSet]:
    """Solve a programme without a guess of its active set.

    Parameters
    ----------
    programme : Programme
    start : Point, optional
        Where the passes begin; at rest by default.
    work : StepBudget, optional
        See `solve_exact`.

    Raises
    ------
    Unsolved
        If the passes diverge or find no active set.
    """
    # If forces are not unique, passes that begin without forces end near the smallest ones.
    at = at_rest(programme) if start is None else replace(at_rest(programme), x=start.x)
    active = first_guess(programme)
    drift, run, stretch = at, np.inf, 0.0
    for pull in CONTACT.pulls:
        found = solve_exact(_pulled(programme, at, pull), active, at, work=work)
        if found is None and stretch:
            # The last stride went too far: take it back.
            at, stretch, run = replace(at, x=at.x - stretch * drift.x), 0.0, np.inf
            continue
        if found is None:
            raise Unsolved("no consistent active set was found")
        point, now = found
        if now == active:
            exact = solve_exact(programme, now, point, rounds=1, work=work)
            if exact is not None:
                return exact
            if _arrived(point, at, pull):
                return point, now
        drift = Point(point.x - at.x, point.forces - at.forces, point.cone_forces)
        # A coordinate that only a small load drives moves at a constant pace: take ever longer
        # strides.
        pace = float(np.abs(drift.x).max(initial=0.0))
        stretch = 4.0 * stretch + 1.0 if now == active and pace > 0.5 * run else 0.0
        at, active, run = replace(point, x=point.x + stretch * drift.x), now, pace
    raise Unsolved("the passes of the proximal method did not converge")


def _pulled(programme: Programme, at: Point, pull: float) -> Programme:
    return replace(
        programme,
        stiffness=programme.stiffness + pull * np.eye(len(at.x)),
        load=programme.load + pull * at.x,
        linear=programme.linear + pull,
        gaps=programme.gaps - pull * at.forces,
    )


def _arrived(point: Point, before: Point, pull: float) -> bool:
    """Return whether the pull's contribution to balances and gaps is round-off."""

    def largest(values: Array) -> float:
        return float(np.abs(values).max(initial=0.0))

    unbalanced = pull * largest(point.x - before.x)
    misplaced = pull * largest(point.forces - before.forces)
    return bool(
        unbalanced <= CONTACT.arrived * max(1.0, largest(point.forces))
        and misplaced <= CONTACT.arrived * max(1.0, largest(point.x))
    )
