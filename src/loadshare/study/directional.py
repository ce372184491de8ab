"""How an equilibrium moves with an input, on either side of it.

Where every element stands clear of its limits the answer is one linear solve with the Jacobian of
the active set. An element on the verge (no gap and no force, or a radius just at a corner) makes a
kink: each side has its own active set, found by exchanging verge elements until none is violated to
first order. A body that floats free stands on a verge as well: where the input loads it along its
free move, the contacts in the way catch it and carry what is new. Source: implicit function
theorem; for the verge, the directional derivative of a complementarity problem.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from loadshare.scene.scene import Array, Scene
from loadshare.study.branch import ActiveSet, Branch
from loadshare.study.branch.system import RANK, BranchLost
from loadshare.study.differences import Derivative

VERGE = 1e-9
"""Gauge below which an element stands on the verge, in deflections or loads."""
MOST = 10
"""Verge elements up to which all their combinations are tried."""
FOLLOWS = 1e-7
"""Part of a derivative that an active set may leave unbalanced: what differencing leaves open."""
ROUND_OFF = 1e-11
"""Effect of an input's step on the equations, in loads and deflections, that counts as none."""
SLIDES = 1e-5
"""First-order violation of a verge element that counts as none, relative to the largest."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """How the unknowns move with an input, to one side.

    Attributes
    ----------
    branch : Branch
        On the active set of that side.
    z : ndarray
        Its unknowns at the equilibrium.
    rate : ndarray
        Their derivative with respect to the input, per SI unit.
    caught : tuple of str
        Contacts that catch bodies which floated free.
    """

    branch: Branch
    z: Array
    rate: Array
    caught: tuple[str, ...] = ()


class Neighbourhood:
    """An equilibrium, its active set, and the sets that it stands on the verge of.

    Parameters
    ----------
    branch : Branch
    z : ndarray
        The unknowns, solved.
    """

    def __init__(self, branch: Branch, z: Array) -> None:
        self.branch, self.z = branch, z
        self.verge = {g.element: g for g in branch.gauges(z) if abs(g.value) <= VERGE}
        self._factors: dict[ActiveSet, tuple[Array, Array]] = {}

    def sets(self) -> list[ActiveSet]:
        """All active sets that meet here: the own one first, then by number of exchanges."""
        gauges = list(self.verge.values())[:MOST]
        found = []
        for choice in sorted(product((False, True), repeat=len(gauges)), key=sum):
            active = self.branch.active
            for gauge, switch in zip(gauges, choice, strict=True):
                if switch:
                    active = active.switched(gauge.element, gauge.to)
            found.append(active)
        return found

    def on(self, active: ActiveSet, scene: Scene | None = None) -> Branch:
        """Return the branch of another active set, or of another scene near by."""
        if scene is None and active == self.branch.active:
            return self.branch
        return Branch(scene or self.branch.scene, active, self.branch.units)

    def unknowns(self, branch: Branch) -> Array:
        """Return the equilibrium in the unknowns of a branch that meets here."""
        if branch.active == self.branch.active:
            return self.z
        forces = {n: f for n, (f, _) in self.branch.contacts(self.z).items()}
        pulls = self.branch.pulls(self.z)
        return branch.start(self.branch.x(self.z), forces, pulls)

    def rate(self, branch: Branch, z: Array, change: Derivative) -> Array | None:
        """Return dz for a derivative of the residual, or None if the set cannot follow."""
        explicit = change.value[: branch.size]
        if branch.active not in self._factors:
            jacobian = branch.jacobian(z)
            inverse = np.asarray(np.linalg.pinv(jacobian, rcond=RANK), dtype=np.float64)
            self._factors[branch.active] = jacobian, inverse
        jacobian, inverse = self._factors[branch.active]
        found = -(inverse @ explicit)
        # A singular set follows only what its equations can balance.
        left = float(np.abs(jacobian @ found + explicit).max(initial=0.0))
        size = float(np.abs(explicit).max(initial=0.0))
        return found if left <= max(FOLLOWS * size, ROUND_OFF / change.step) else None

    def motion(
        self,
        sign: float,
        explicit: Callable[[Branch, Array], Derivative],
        shifted: Callable[[float], Scene],
    ) -> Motion | None:
        """Return how the equilibrium moves as an input rises (sign 1) or falls (−1).

        Parameters
        ----------
        sign : float
        explicit : callable
            Derivative of a branch's residual with respect to the input, at unknowns.
        shifted : callable
            Scene with the input moved by an amount [SI].

        Returns
        -------
        Motion or None
            None if no active set can follow to that side.
        """
        for active, caught in self._ways():
            branch = self.on(active)
            z = self.unknowns(branch)
            try:
                change = explicit(branch, z)
                rate = self.rate(branch, z, change)
            except BranchLost:
                continue
            if rate is None or not self._pressed(branch, z, sign * rate, caught):
                continue
            if not self.verge or self._holds(branch, z, sign, rate, change.step, shifted):
                return Motion(branch, z, rate, caught)
        return None

    def _ways(self) -> Iterator[tuple[ActiveSet, tuple[str, ...]]]:
        """Yield the sets that meet here; then those in which contacts catch what floats free."""
        for active in self.sets():
            yield active, ()
        free = self.branch.undetermined(self.z).shape[1]
        names = self.branch.catching(self.z)[:MOST]
        for count in range(1, min(free, len(names)) + 1):
            for caught in combinations(names, count):
                for active in self.sets():
                    yield replace(active, closed=active.closed | set(caught)), caught

    @staticmethod
    def _pressed(branch: Branch, z: Array, rate: Array, caught: tuple[str, ...]) -> bool:
        """Whether the contacts that catch a body are pressed and do not pull."""
        contacts = branch.contacts(z) if caught else {}
        return all(float(contacts[name][1] @ rate) >= 0.0 for name in caught)

    def _holds(
        self,
        branch: Branch,
        z: Array,
        sign: float,
        rate: Array,
        step: float,
        shifted: Callable[[float], Scene],
    ) -> bool:
        """Whether no verge element is violated to first order after a small step to one side."""
        # A step well within the neighbourhood, yet far above the round-off of the gauges.
        step *= min(1.0, 1e-6 / max(float(np.abs(rate).max(initial=0.0)) * step, 1e-300))
        try:
            after = self.on(branch.active, shifted(sign * step)).gauges(z + sign * step * rate)
        except BranchLost:
            return False
        before = {(g.element, g.to): g.value for g in branch.gauges(z)}
        moved: dict[str, float] = {}
        for g in after:
            if g.element in self.verge and abs(before.get((g.element, g.to), 1.0)) <= VERGE * 10:
                moved[g.element] = g.value - before[(g.element, g.to)]
        size = max(float(np.abs(rate).max(initial=0.0)) * step, 1e-300)
        return all(change >= -SLIDES * size for change in moved.values())
