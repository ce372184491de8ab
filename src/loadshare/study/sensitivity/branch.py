"""The equations of an active set at one value of an input, and how far the set is from changing."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array
from loadshare.scene.structure import Structure, structure_of
from loadshare.settings import EPS, SENSITIVITY
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.active import WorkingSet, coordinates, read_states, set_of
from loadshare.study.follow.equations import Equations
from loadshare.study.follow.gauges import gauges_at
from loadshare.study.follow.numbers import Numbers, structure_like
from loadshare.study.follow.stretches import Stretches
from loadshare.train import Train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import Situations, situation_of


class BranchLost(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """A branch has no point where one was sought; the message says why."""


@dataclass(frozen=True, eq=False)
class Setting:
    """A train at a position, in the form that the equations of its active sets need.

    Attributes
    ----------
    train : Train
    structure : Structure
        Of the train at the input's own value, so coordinates and units are the same at all values.
    situation : Situations
    numbers : Numbers
    """

    train: Train
    structure: Structure
    situation: Situations
    numbers: Numbers

    @classmethod
    def at(cls, train: Train, position: int, base: Structure | None = None) -> Setting:
        """Return the setting of a train at a position (1-based).

        Parameters
        ----------
        train : Train
        position : int
        base : Structure, optional
            Of the train at the input's own value; that of the given train by default.

        Raises
        ------
        ValueError
            If the train has other elements than `base`.
        """
        own = structure_of(train) if base is None else structure_like(base, train)
        situation = situation_of(train, position)
        return cls(train, base or own, situation, Numbers.of(own, situation))

    @cached_property
    def levers(self) -> Array:
        """Torques of the meshes [N·m] per unit of every flank's force, shape (meshes, scalars)."""
        driving, structure = self.train.driving.values(), self.structure
        found = np.zeros((len(driving), structure.columns.flat.stop))
        for row, flanks in zip(found, driving, strict=True):
            for flank, lever in flanks:
                row[structure.names.index(flank)] = lever * structure.force
        return found

    def branch_of(self, found: Equilibrium) -> tuple[Branch, Array]:
        """Return the branch of a certified equilibrium, and its unknowns solved to round-off.

        Raises
        ------
        BranchLost
            If the equations of the active set do not reproduce the equilibrium.
        """
        branch = Branch(self, self.active_set(found))
        return branch, branch.solve(coordinates(self.structure, self.situation, found))

    def active_set(self, found: Equilibrium) -> WorkingSet:
        """Read the active set of a certified equilibrium."""
        structure, numbers = self.structure, self.numbers
        x = coordinates(structure, self.situation, found)
        states = tuple(read_states(structure, numbers, found, x).tolist())
        return set_of(structure, numbers, states, x)


class BranchGauge(NamedTuple):
    """How far an element is from leaving its state [deflections or loads].

    Attributes
    ----------
    switch : int
    value : float
    gradient : ndarray, shape (n,), or None
        Of an open contact's approach with respect to the coordinates.
    """

    switch: int
    value: float
    gradient: Array | None

    def closing(self, loose: Array) -> Array | None:
        """Return how fast undetermined moves (n, d) close it; None if they do not affect it."""
        if self.gradient is None:
            return None
        rates = np.asarray(self.gradient @ loose)
        return rates if np.abs(rates).max(initial=0.0) > SENSITIVITY.loose else None


class Branch:
    """The equations of an active set at one value of an input.

    Parameters
    ----------
    setting : Setting
    active : WorkingSet
    like : Equations, optional
        Equations of this set at another value, which are reused if they fit this value.

    Attributes
    ----------
    pins : mapping of switch to float
        Rigid rings that pin their gears in this set, and the play that they have at this value.

    Raises
    ------
    BranchLost
        If a radial law lacks the step that the set assumes.
    """

    def __init__(self, setting: Setting, active: WorkingSet, like: Equations | None = None) -> None:
        self.setting, self.active = setting, active
        self.numbers = numbers = setting.numbers
        if like is None or not like.serve(numbers):
            like = Equations(setting.structure, active, numbers)
        e = self.equations = like
        self.size, self.n = e.size, e.n
        law = at.graph(numbers.radial[0], np.zeros(len(e.radials)))
        self.pins: dict[int, float] = {}
        for j, k in enumerate(e.radials):
            rigid = bool(np.isinf(law.last[j]))
            play = float((law.reach if rigid else law.stick)[j])
            if rigid and e.states[k] == at.PINNED:
                self.pins[k] = play
            elif not {at.PINNED: play == 0.0, at.WALL: play > 0.0}.get(int(e.states[k]), True):
                raise BranchLost("a limit without play is a different element from one with play")

    def beside(self, setting: Setting) -> Branch:
        """Return the branch of the same set at another value of the input.

        Raises
        ------
        BranchLost
            If the set has other unknowns there.
        """
        there = Branch(setting, self.active, self.equations)
        if there.size != self.size:
            raise BranchLost("a limit without play is a different element from one with play")
        return there

    def play(self, z: Array) -> Array:
        """Return how far pins let their gears move at unknowns z, as part of G.

        Raises
        ------
        BranchLost
            If no force acts on such a gear.
        """
        found = np.zeros(self.size)
        for k, play in self.pins.items():
            if play > 0.0:
                where = self.equations.polar_at[k]
                assert where is not None
                force = z[where : where + 2]
                size = float(np.linalg.norm(force))
                if size <= SENSITIVITY.verge:
                    why = "a gear on which no force acts floats as soon as its limit has play"
                    raise BranchLost(why)
                # The gear moves the way it is pushed.
                found[where : where + 2] = play * (force / size)
        return found

    def jacobians(self, z: Array) -> Array:
        """Return the derivative of G at points z (S, size)."""
        return self.equations.jacobian(z, self.numbers)

    def rounding(self, z: Array) -> Array:
        """Return a bound on the round-off of `figures`, from the sizes of their terms."""
        state = self.equations.state(z[None], self.numbers)
        sizes = self.equations.sizes(z[None], self.numbers, state)[0]
        torques = np.abs(self.setting.levers @ state.force[0])
        torques += np.abs(self.torque_gradients(z)) @ np.abs(z)
        return EPS * np.concatenate(
            [SENSITIVITY.roundings * sizes, 2.0 * SENSITIVITY.roundings * torques]
        )

    def solve(self, x: Array) -> Array:
        """Solve the equations from nearby coordinates and return the unknowns.

        Raises
        ------
        BranchLost
            If there is no solution nearby.
        """
        start = self.equations.start(x[None], self.numbers)
        z, good = self.equations.solve(start, self.numbers)
        if not good[0]:
            raise BranchLost("the equations of the active set have no solution nearby")
        return np.asarray(z[0])

    def torque_gradients(self, z: Array) -> Array:
        """Return the derivatives (meshes, size) of the torques with respect to z."""
        state = self.equations.state(z[None], self.numbers)
        levers = self.setting.levers[None]
        return np.asarray(self.equations.along_forces(levers, state, self.numbers)[0])

    def gauges(
        self, z: Array, only: Collection[int] | None = None
    ) -> dict[tuple[int, int], BranchGauge]:
        """Return the gauges of elements, by element and the state to which it would change.

        Parameters
        ----------
        z : ndarray, shape (size,)
        only : collection of int, optional
            Numbers of elements in an active set; all by default.
        """
        e = self.equations
        with np.errstate(all="ignore"):
            here = Stretches.at_points(e, z[None], self.numbers)
            found = gauges_at(here, only)
        gauges = {}
        for gauge in found:
            k, gradient = gauge.switch, None
            if k in self.pins:
                # The play of a pin depends on the input alone.
                continue
            if k in e.arcs and k not in e.polar_at:
                gradient = -here.frames[k][0, 0] @ e.matrix(k, self.numbers)[0]
            elif k < e.arcs.start and e.states[k] == at.OPEN:
                gradient = here.vectors[0, e.structure.springs + k]
            # A contact that the coordinates cannot close has no gauge.
            if gradient is None or gradient.any():
                gauges[k, gauge.to] = BranchGauge(k, float(gauge.first[0]), gradient)
        return gauges


def figures(branches: Sequence[Branch], z: Array) -> list[Array | BranchLost]:
    """Return G at unknowns z (size,), then the torque of every mesh [N·m], for several branches.

    A branch without them, such as one at which a radial law would drop, gives the reason instead.
    """
    together: dict[int, list[int]] = {}
    for k, branch in enumerate(branches):
        together.setdefault(id(branch.equations), []).append(k)
    found: dict[int, Array | BranchLost] = {}
    for rows in together.values():
        found |= zip(rows, _figures([branches[k] for k in rows], z), strict=True)
    return [found[k] for k in range(len(branches))]


def _figures(branches: Sequence[Branch], z: Array) -> list[Array | BranchLost]:
    """Return the figures of branches with the same equations."""
    equations = branches[0].equations
    numbers = Numbers.stacked([branch.numbers for branch in branches])
    points = np.repeat(z[None], len(branches), axis=0)
    state = equations.state(points, numbers)
    residual = equations.residual(points, numbers, state)
    levers = np.array([branch.setting.levers for branch in branches])
    torque = (levers @ state.force[:, :, None])[:, :, 0]
    lost = np.zeros(len(branches), dtype=bool)
    for law in state.laws.values():
        lost |= ~law.valid
    found: list[Array | BranchLost] = []
    for row, branch in enumerate(branches):
        if lost[row]:
            found.append(BranchLost("a spline's force would drop where it starts to slip"))
            continue
        try:
            residual[row] -= branch.play(z)
        except BranchLost as why:
            found.append(why)
        else:
            found.append(np.concatenate([residual[row], torque[row]]))
    return found
