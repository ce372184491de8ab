"""How an equilibrium moves with an input, on either side of the input's value.

Where every element is clear of its limits, the answer is one linear solve with the Jacobian of the
active set. Where some are on the verge (no gap and no force, a radius exactly at a corner), or a
body floats free and the input loads it, each side has an active set of its own. It is read from a
certified solve a small step to that side and followed back to the value; the point of its branch
there is where a falling body is caught. A set is accepted only if it is proved there to first
order: its equations hold, no element is violated, and none on the verge moves across it. The
directional derivative of a convex contact problem is unique in its forces, so a set that passes is
the right one, however it was found. Source: implicit function theorem; for the verge, the
directional derivative of a complementarity problem.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import chain

import numpy as np

from loadshare.array_types import Array
from loadshare.errors import CaseError, Refused
from loadshare.libraries import optimize
from loadshare.settings import EPS, SENSITIVITY
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.active import set_of, switch_names
from loadshare.study.sensitivity.branch import Branch, BranchLost, Setting
from loadshare.study.sensitivity.differences import SideSlope
from loadshare.study.sensitivity.motion import BranchPoint, Gauges, Motion
from loadshare.study.sensitivity.variation import Variation
from loadshare.train.equilibrium import Equilibrium

_NOTHING = (CaseError, ValueError, BranchLost, Refused)


class Neighbourhood:
    """A certified equilibrium, and the active sets that meet there.

    Parameters
    ----------
    setting : Setting
    found : Equilibrium
        Certified.

    Attributes
    ----------
    own : BranchPoint or None
        The equilibrium on its own active set; None if that cannot be read.
    verge : tuple of str
        Elements that have neither gap nor force there, or are at a corner of their law.
    """

    def __init__(self, setting: Setting, found: Equilibrium) -> None:
        self._setting = setting
        self.own: BranchPoint | None = None
        self.verge: tuple[str, ...] = ()
        self._points: list[BranchPoint] = []
        self._others: dict[tuple[BranchPoint, tuple[tuple[int, int], ...]], BranchPoint | None] = {}
        try:
            self.own = BranchPoint(*setting.branch_of(found))
        except BranchLost:
            return
        names = switch_names(setting.structure)
        near = [g for g in self.own.gauges.values() if abs(g.value) <= SENSITIVITY.verge]
        loose = self.own.tangent.loose
        self.verge = tuple(dict.fromkeys(names[g.switch] for g in near if g.closing(loose) is None))
        self._points.append(self.own)

    def motion(self, sign: float, varied: Variation) -> Motion | None:
        """Return how the equilibrium moves as an input rises (sign 1) or falls (−1).

        Returns
        -------
        Motion or None
            None if no active set was found that holds on that side.
        """
        for point in chain(tuple(self._points), self._near(sign, varied)):
            found = self._followed(point, sign, varied)
            if found is not None:
                self._points += [] if point in self._points else [point]
                return found
        return None

    def gives_way(self, change: SideSlope, step: float) -> bool:
        """Return whether an input loads a body along a move that nothing resists, however far."""
        if self.own is None or not self._unbalanced(self.own, change, step)[0]:
            return False
        loose, equations = self.own.tangent.loose, self.own.branch.equations
        free = [k for k in equations.radials if equations.states[k] == at.OPEN]
        caught = any(
            np.abs(equations.matrix(k, self._setting.numbers)[0] @ loose).max(initial=0.0)
            > SENSITIVITY.loose
            for k in free
        )
        return not caught and all(g.closing(loose) is None for g in self.own.gauges.values())

    @staticmethod
    def _unbalanced(point: BranchPoint, slope: SideSlope, step: float) -> tuple[bool, Array]:
        """Return whether a set cannot balance an input's effect, and what is left unbalanced."""
        branch, unbalanced = point.branch, point.tangent.unbalanced
        explicit, error = slope.value[: branch.size], slope.error[: branch.size]
        size = float(np.abs(explicit).max(initial=0.0))
        left = np.abs(unbalanced.T @ explicit)
        known = np.abs(unbalanced.T) @ error + SENSITIVITY.follows * size
        return bool((left > np.maximum(known, SENSITIVITY.round_off / step)).any()), left

    def _followed(self, point: BranchPoint, sign: float, varied: Variation) -> Motion | None:
        """Return the motion on a set, if the set holds on that side."""
        branch, z, tangent = point.branch, point.z, point.tangent
        slope, step = self._slope(point, sign, varied)
        if slope is None:
            return None
        explicit, error = slope.value[: branch.size], slope.error[: branch.size]
        cannot, left = self._unbalanced(point, slope, step)
        if cannot:
            return None
        rate = -tangent.solve(explicit)
        terms = np.abs(tangent.matrix) @ np.abs(rate) + np.abs(explicit)
        error = error + len(error) * EPS * terms + tangent.turned(rate)
        error = error + float(left.max(initial=0.0))
        verge = self._verge(point)
        if verge is None:
            return None
        still = self._still(point, sign, rate, step, varied, verge)
        if still is None:
            return None
        elements: tuple[str, ...] = ()
        if self.own is not None:
            structure = self._setting.structure
            changed = self.own.branch.active.changes(branch.active, structure)
            elements = tuple(switch_names(structure)[k] for k in changed)
        # What an input does not move, on the verge or not, stays put on the other side as well.
        one_sided = bool(elements) or len(still) < len(verge)
        beside = tuple(self._with(point, still, sign, varied))
        return Motion(branch, z, tangent, rate, error, slope, elements, one_sided, beside)

    @staticmethod
    def _slope(
        point: BranchPoint, sign: float, varied: Variation
    ) -> tuple[SideSlope | None, float]:
        """Return how an input changes the equations on a side, if it can, and the step used."""
        try:
            change = varied.change(point.branch, point.z)
        except _NOTHING:
            return None, 0.0
        slope = change.to(sign)
        return slope if isinstance(slope, SideSlope) else None, change.step

    @staticmethod
    def _verge(point: BranchPoint) -> Gauges | None:
        """Return the gauges on the verge, undetermined ones included; None if one is violated."""
        gauges = {key: g for key, g in point.gauges.items() if g.switch not in point.idle}
        if any(g.value < -10.0 * SENSITIVITY.verge for g in gauges.values()):
            return None
        return {key: g for key, g in gauges.items() if g.value <= 10.0 * SENSITIVITY.verge}

    def _with(
        self, point: BranchPoint, still: tuple[tuple[int, int], ...], sign: float, varied: Variation
    ) -> Iterator[Motion]:
        """Yield motions with elements in their other states, all and one by one, if they hold."""
        for changes in (still, *((one,) for one in still if len(still) > 1)) if still else ():
            other = self._beside(point, changes)
            if other is None:
                continue
            (slope, step), verge = self._slope(other, sign, varied), self._verge(other)
            if slope is None or verge is None:
                continue
            size = other.branch.size
            rate = -other.tangent.solve(slope.value[:size])
            if self._still(other, sign, rate, step, varied, verge, later=True) is not None:
                error = slope.error[:size]
                yield Motion(other.branch, other.z, other.tangent, rate, error, slope)

    def _beside(
        self, point: BranchPoint, changes: tuple[tuple[int, int], ...]
    ) -> BranchPoint | None:
        """Return a point with elements in other states, if there is one; it suits every input."""
        if (point, changes) not in self._others:
            states = list(point.branch.active.states)
            for switch, to in changes:
                states[switch] = to
            setting, x = self._setting, point.z[: point.branch.n]
            other = None
            with suppress(BranchLost, ValueError):
                known, tied = (setting.structure, setting.numbers), point.branch.active.tied
                branch = Branch(setting, set_of(*known, tuple(states), x, tied))
                other = BranchPoint(branch, branch.solve(x), point.idle)
            self._others[point, changes] = other
        return self._others[point, changes]

    def _still(
        self,
        point: BranchPoint,
        sign: float,
        rate: Array,
        step: float,
        varied: Variation,
        verge: Gauges,
        later: bool = False,
    ) -> tuple[tuple[int, int], ...] | None:
        """Return what stays on the verge, in either state; None if any element moves across it.

        Such an element moves neither way except by round-off, or is across by round-off and returns
        only at a distance from the value. With `later`, a crossing at a distance does not count.
        """
        if not verge:
            return ()
        branch, z = point.branch, point.z
        fastest = float(np.abs(rate).max(initial=0.0))
        if step * fastest > SENSITIVITY.way:
            # By a power of 2, so that sets that move at similar rates share their trains.
            step *= 2.0 ** math.floor(math.log2(SENSITIVITY.way / (step * fastest)))
        along = []
        try:
            for k in (1.0, 2.0):
                there = Branch(varied.setting(k * sign * step), branch.active)
                along.append(there.gauges(z + k * sign * step * rate, [k for k, _ in verge]))
        except _NOTHING:
            return None
        slack = SENSITIVITY.slides * fastest + SENSITIVITY.round_off / step
        tied: list[tuple[Array, float]] = []
        still = []
        for key, gauge in verge.items():
            if any(key not in there for there in along):
                continue
            once, twice = (there[key].value for there in along)
            grows = (4.0 * once - twice - 3.0 * gauge.value) / (2.0 * step)
            closing = gauge.closing(point.tangent.loose)
            if closing is not None:
                tied.append((closing, grows + slack))
            elif grows < -slack and not (later and gauge.value > -grows * SENSITIVITY.apart * step):
                return None
            elif grows < max(slack, -gauge.value / (SENSITIVITY.apart * step)):
                still.append(key)
        return tuple(still) if _has_room(tied) else None

    def _near(self, sign: float, varied: Variation) -> Iterator[BranchPoint]:
        """Yield points on the sets of certified solves a small step to that side."""
        for amount in self._amounts(sign, varied):
            try:
                branch, z = varied.setting(amount).branch_of(varied.answer(amount))
            except _NOTHING:
                continue
            # Under a law that is infinitely soft at first, a contact carries either nothing, to
            # first order, or the load that nothing else can carry.
            soft = self._soft(branch)
            for tied in (frozenset[int](), soft) if soft else (frozenset[int](),):
                try:
                    yield self._back(branch, z, soft, tied, amount, varied)
                except _NOTHING:
                    continue

    def _amounts(self, sign: float, varied: Variation) -> Iterator[float]:
        """Yield steps of the input [SI], sized by their effect on the equations and gauges."""
        if self.own is None:
            return
        branch, z = self.own.branch, self.own.z
        change = varied.change(branch, z)
        slope, reach = change.to(sign), 4.0 * change.step
        if not isinstance(slope, SideSlope):
            return
        before = branch.gauges(z)
        after = Branch(varied.setting(sign * change.step), branch.active).gauges(z)
        shifts = [abs(after[k].value - g.value) for k, g in before.items() if k in after]
        shifts = [s for s in shifts if np.isfinite(s)]
        effect = float(np.abs(slope.value[: branch.size]).max(initial=0.0))
        effect = max([effect, *(s / change.step for s in shifts)])
        if effect * reach <= SENSITIVITY.round_off:
            return
        for near in SENSITIVITY.near:
            yield sign * min(near / effect, reach)

    def _soft(self, branch: Branch) -> frozenset[int]:
        """Return closed contacts with laws soft at first that carry nothing at the value itself."""
        assert self.own is not None
        springs, own = branch.equations.structure.springs, self.own.branch.equations
        curved = (branch.equations.curved - springs).tolist()
        return frozenset(k for k in curved if k >= 0 and own.states[k] == at.OPEN)

    def _back(
        self,
        branch: Branch,
        z: Array,
        soft: frozenset[int],
        tied: frozenset[int],
        amount: float,
        varied: Variation,
    ) -> BranchPoint:
        """Follow a set back to the value, from three points on its branch by Newton's method."""
        idle = soft - tied
        states = tuple(at.OPEN if k in idle else c for k, c in enumerate(branch.active.states))
        active = replace(branch.active, states=states, tied=tied)
        here = Branch(self._setting, active)
        branch_points = []
        for share in (1.0, 0.5, 0.25):
            there = Branch(varied.setting(share * amount), active)
            z = there.solve(z[: there.n])
            branch_points.append(z)
        first, second, third = branch_points
        z = here.solve((first / 3.0 - 2.0 * second + 8.0 / 3.0 * third)[: here.n])
        return BranchPoint(here, z, idle)


def _has_room(rows: list[tuple[Array, float]]) -> bool:
    """Return whether undetermined moves v can keep contacts on the verge open: row·v ≤ room."""
    if not rows:
        return True
    matrix, room = np.array([r for r, _ in rows]), np.array([b for _, b in rows])
    # Rooms are scaled by the largest: the free moves are as large as the gaps demand.
    scale = float(np.abs(room).max()) or 1.0
    count = matrix.shape[1]
    found = optimize.linprog(
        np.zeros(count), A_ub=matrix, b_ub=room / scale, bounds=[(None, None)] * count
    )
    return bool(found.status == 0)
