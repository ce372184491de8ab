r"""The equations of a machine on one active set, for many points at once.

Contacts that yield are eliminated by their closed form F(δ), continued as an odd function below
zero, so that a branch can be followed across the point where it ends. The forces of rigid contacts,
steps and rigid stops remain unknown. With coordinates x and forces p the unknowns are z = (x, p),
and

.. math:: G(z) = \Big(\sum_e a_e F_e(a_e x - g_e) + \sum_j P_j^T \Phi_j - f,\; c(x)\Big) = 0.

An arc has a direction, like a radial element: its force acts along the line of centres.
Source: formulation, sections 3 to 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array, Flags, States
from loadshare.contact.arc import rolled
from loadshare.contact.law import roots
from loadshare.scene.structure import Structure
from loadshare.settings import FOLLOW
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.active import WorkingSet
from loadshare.study.follow.numbers import Numbers


@dataclass(frozen=True, slots=True, eq=False)
class PolarFrame:
    """An element whose force acts along its own offset, at S points.

    Attributes
    ----------
    matrix : ndarray, shape (S or 1, k, n)
        Offset per unit of the coordinates; k is 2, or 3 for an arc.
    offset : ndarray, shape (S, k)
    radius : ndarray, shape (S,)
    along : ndarray, shape (S, k)
        Unit vector; zero at the centre.
    size, slope : ndarray, shape (S,)
        φ, the force along it, and its derivative with respect to the radius.
    beyond : ndarray, shape (S,), or None
        Distance beyond the radius at which an unknown force holds the element.
    sense : float
        Factor that makes an unknown force act along the offset.
    """

    matrix: Array
    offset: Array
    radius: Array
    along: Array
    size: Array
    slope: Array
    beyond: Array | None
    sense: float = 1.0

    @property
    def force(self) -> Array:
        """Force (S, k) along the offset."""
        return np.asarray(self.size[:, None] * self.along)

    @property
    def stiffness(self) -> Array:
        """Derivative (S, k, k) of the force with respect to the offset."""
        one = np.eye(self.offset.shape[1])
        dyad = self.along[:, :, None] * self.along[:, None, :]
        # At the centre all directions are alike.
        off = self.radius > 0.0
        across = np.where(off, self.size / np.where(off, self.radius, 1.0), self.slope)
        return np.asarray(self.slope[:, None, None] * dyad + across[:, None, None] * (one - dyad))


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """Approaches, forces and offsets of all elements at S points z.

    Attributes
    ----------
    approach, force, slope : ndarray, shape (S, k)
        Of all springs, flanks and stops; F and dF/dδ, zero for open and rigid ones.
    polars : mapping of switch to Polar
        Arcs and radial elements, by their number in an active set.
    margin : mapping of switch to ndarray, shape (S,)
        Distance beyond each arc.
    laws : mapping of switch to Graph
        Of the radial elements.
    transmitted : ndarray, shape (S, radials)
        Torque that each radial element transmits.
    """

    approach: Array
    force: Array
    slope: Array
    polars: dict[int, PolarFrame]
    margin: dict[int, Array]
    laws: dict[int, at.Graph]
    transmitted: Array


class Equations:
    """The equations of a machine on an active set.

    Parameters
    ----------
    structure : Structure
    active : WorkingSet
    numbers : Numbers
        At any value; they decide which contacts are rigid, linear, curved or tabulated.

    Attributes
    ----------
    arcs, radials : range
        Their numbers in an active set.
    polar_at : mapping of switch to int or None
        Arcs and radial elements that act, and where their unknown forces are in z.
    """

    def __init__(self, structure: Structure, active: WorkingSet, numbers: Numbers) -> None:
        self.structure, self.active = structure, active
        self._kinds = numbers.kinds
        self.tabulated = tabulated = numbers.tabulated[0]
        self.states: States = np.array(active.states, dtype=np.int8)
        self.n = structure.size
        self.scalars = structure.columns.arcs.start
        self.arcs = range(structure.flat, structure.rows)
        self.radials = range(structure.rows, structure.switches)
        rows = self.states[: structure.rows] == at.CLOSED
        acting = np.append(np.ones(structure.springs, dtype=bool), rows)
        self.acts = acting[: self.scalars]
        curved, bends, _ = self._kinds
        curved, yields = curved.copy(), bends | curved | (tabulated >= 0)
        tied = [structure.springs + k for k in active.tied]
        yields[tied] = curved[tied] = False
        part = slice(0, self.scalars)
        self.rigid = np.flatnonzero(self.acts & ~yields[part])
        self.linear = np.flatnonzero(self.acts & yields[part] & ~curved[part])
        self.linear = self.linear[tabulated[self.linear] < 0]
        self.curved = np.flatnonzero(self.acts & curved[part])
        self.tables = np.flatnonzero(self.acts & (tabulated[part] >= 0))
        self._free: bool | None = None
        # Every force that does not follow from a displacement is an unknown in z.
        self.rigid_at = self.n + np.arange(len(self.rigid))
        self.size = self.n + len(self.rigid)
        self.polar_at: dict[int, int | None] = {}
        for k in (*self.arcs, *self.radials):
            width = self._forces_of(k, yields)
            if self.states[k] != at.OPEN:
                self.polar_at[k] = self.size if width else None
                self.size += width

    def serve(self, numbers: Numbers) -> bool:
        """Return whether `numbers` have the same rigid, linear, curved and tabulated contacts."""
        return all(map(np.array_equal, self._kinds, numbers.kinds))

    def _forces_of(self, k: int, yields: Flags) -> int:
        """Return the number of unknown forces of an acting arc or radial element."""
        if k in self.arcs:
            return int(not yields[self.structure.springs + k])
        return {at.PINNED: 2, at.CORNER: 1, at.WALL: 1}.get(int(self.states[k]), 0)

    def matrix(self, k: int, numbers: Numbers) -> Array:
        """Return the offset of an arc or radial element per unit of x, (S or 1, 3 or 2, n)."""
        if k in self.arcs:
            return np.asarray(numbers.relative[:, k - self.arcs.start])
        return np.asarray(numbers.vectors[:, self._columns(k)])

    def _columns(self, k: int) -> slice:
        column = self.structure.radial_column(k - self.radials.start)
        return slice(column, column + 2)

    # --- At points ------------------------------------------------------------------------------

    def state(self, z: Array, numbers: Numbers, every: bool = True) -> Evaluation:
        """Return approaches, forces, offsets at points z (S, size); if not `every`, acting ones."""
        x = z[:, : self.n]
        vectors = numbers.vectors[:, : self.scalars]
        approach = (vectors @ x[:, :, None])[:, :, 0] - numbers.gap[:, : self.scalars]
        force, slope = np.zeros_like(approach), np.zeros_like(approach)
        for k in self.linear.tolist():
            slope[:, k] = 1.0 / numbers.bending[:, k]
            force[:, k] = approach[:, k] * slope[:, k]
        if len(self.curved):
            b, c = numbers.bending[:, self.curved], numbers.hertz[:, self.curved]
            force[:, self.curved], slope[:, self.curved] = pressed(b, c, approach[:, self.curved])
        for k, piece in zip(self.tables.tolist(), self.active.pieces, strict=True):
            table = numbers.tables[:, self.tabulated[k]]
            start, rate = table[:, :, piece], np.diff(table[:, :, piece : piece + 2])[:, :, 0]
            slope[:, k] = rate[:, 0] / rate[:, 1]
            force[:, k] = start[:, 0] + slope[:, k] * (approach[:, k] - start[:, 1])
        force[:, self.rigid] = z[:, self.rigid_at]
        transmitted = (numbers.carried[:, :, : self.scalars] @ force[:, :, None])[:, :, 0]
        laws = self._laws(z, numbers, transmitted)
        polars, margin = {}, {}
        for k in (*self.arcs, *self.radials) if every else self.polar_at:
            if k in self.arcs:
                polars[k], margin[k] = self._arc(k, z, numbers)
            else:
                polars[k] = self._radial(k, laws[k], z, numbers)
        return Evaluation(approach, force, slope, polars, margin, laws, transmitted)

    def _laws(self, z: Array, numbers: Numbers, transmitted: Array) -> dict[int, at.Graph]:
        """Return the laws of the radial elements, evaluated in one call."""
        if not self.radials:
            return {}
        offsets = np.stack([self._offset(k, z, numbers) for k in self.radials], axis=1)
        shape = transmitted.shape
        given = np.broadcast_to(numbers.radial, (*shape, numbers.radial.shape[2]))
        radii = np.sqrt((offsets * offsets).sum(axis=2))
        found = at.graph(given.reshape(-1, given.shape[2]), transmitted.ravel(), radii.ravel())
        parts = [part.reshape(shape) for part in found]
        return {k: at.Graph(*(p[:, j] for p in parts)) for j, k in enumerate(self.radials)}

    def _arc(self, k: int, z: Array, numbers: Numbers) -> tuple[PolarFrame, Array]:
        a, matrix = k - self.arcs.start, self.matrix(k, numbers)
        nominal = numbers.nominal[:, a]
        moved = numbers.shift[:, a] + (matrix @ z[:, : self.n, None])[:, :, 0]
        offset, radius, margin = rolled(nominal, moved)
        margin = margin + numbers.clearance[:, a]
        size, slope, beyond = np.zeros_like(radius), np.zeros_like(radius), None
        where = self.polar_at.get(k)
        if where is not None:
            size, beyond = -z[:, where], -margin
        elif k in self.polar_at:
            slope = np.broadcast_to(1.0 / numbers.bending[:, self.scalars + a], radius.shape)
            size = margin * slope
        along = offset / radius[:, None]
        return PolarFrame(matrix, offset, radius, along, size, slope, beyond, sense=-1.0), margin

    def _offset(self, k: int, z: Array, numbers: Numbers) -> Array:
        moved = (self.matrix(k, numbers) @ z[:, : self.n, None])[:, :, 0]
        return np.asarray(moved - numbers.gap[:, self._columns(k)])

    def _radial(self, k: int, law: at.Graph, z: Array, numbers: Numbers) -> PolarFrame:
        matrix, states, where = self.matrix(k, numbers), self.states[k], self.polar_at.get(k)
        offset = self._offset(k, z, numbers)
        radius = np.sqrt((offset * offset).sum(axis=1))
        along = offset / np.where(radius > 0.0, radius, 1.0)[:, None]
        size, slope = np.zeros_like(radius), np.zeros_like(radius)
        beyond: Array | None = None
        if states == at.STICK:
            size, slope = law.first * radius, law.first
        elif states == at.SLIP:
            size = law.bound
        elif states == at.STOP:
            size, slope = law.bound + law.last * (radius - law.reach), law.last
        elif states in (at.WALL, at.CORNER):
            assert where is not None
            size = z[:, where]
            beyond = radius - (law.stick if states == at.CORNER else law.reach)
        return PolarFrame(matrix, offset, radius, along, size, slope, beyond)

    def residual(self, z: Array, numbers: Numbers, state: Evaluation | None = None) -> Array:
        """Return G, shape (S, size)."""
        state = state or self.state(z, numbers)
        n = self.n
        found = np.zeros(z.shape)
        vectors = numbers.vectors[:, : self.scalars]
        found[:, :n] = (state.force[:, None, :] @ vectors)[:, 0] - numbers.load
        found[:, self.rigid_at] = state.approach[:, self.rigid]
        for k, where in self.polar_at.items():
            polar = state.polars[k]
            force = polar.force
            if self.states[k] == at.PINNED:
                assert where is not None
                force = z[:, where : where + 2]
                found[:, where : where + 2] = polar.offset
            elif polar.beyond is not None:
                found[:, where] = polar.beyond
            found[:, :n] += (force[:, None, :] @ polar.matrix)[:, 0]
        return found

    def jacobian(self, z: Array, numbers: Numbers, state: Evaluation | None = None) -> Array:
        """Return the derivative of G, shape (S, size, size)."""
        state = state or self.state(z, numbers)
        n, count = self.n, len(z)
        found = np.zeros((count, self.size, self.size))
        vectors = np.broadcast_to(numbers.vectors[:, : self.scalars], (count, self.scalars, n))
        found[:, :n, :n] = vectors.transpose(0, 2, 1) @ (state.slope[:, :, None] * vectors)
        found[:, :n, self.rigid_at] = vectors[:, self.rigid].transpose(0, 2, 1)
        found[:, self.rigid_at, :n] = vectors[:, self.rigid]
        for k, where in self.polar_at.items():
            polar = state.polars[k]
            turned = polar.matrix.transpose(0, 2, 1)
            if self.states[k] == at.PINNED:
                assert where is not None
                both = slice(where, where + 2)
                found[:, :n, both], found[:, both, :n] = turned, polar.matrix
                continue
            found[:, :n, :n] += turned @ polar.stiffness @ polar.matrix
            pull = polar.sense * (polar.along[:, None, :] @ polar.matrix)[:, 0]
            if where is not None:
                found[:, :n, where] = found[:, where, :n] = pull
            elif k in self.radials and self.states[k] in (at.SLIP, at.STOP):
                found[:, :n] += pull[:, :, None] * self._follow(k, state, numbers)[:, None, :]
        return found

    def _follow(self, k: int, state: Evaluation, numbers: Numbers) -> Array:
        """Return the derivative (S, size) of a friction bound that follows the torque, or zero."""
        j, count = k - self.radials.start, len(state.transmitted)
        number = np.broadcast_to(numbers.radial[:, j], (count, numbers.radial.shape[2]))
        follows = np.isnan(number[:, 3])
        if not follows.any():
            return np.zeros((count, self.size))
        per = np.where(follows, number[:, 4] * np.sign(state.transmitted[:, j]), 0.0)
        arms = numbers.carried[:, [j], : self.scalars]
        return np.asarray(per[:, None] * self.along_forces(arms, state, numbers)[:, 0])

    def along_forces(self, weights: Array, state: Evaluation, numbers: Numbers) -> Array:
        """Return the derivative (S, k, size) of sums of forces by weights (S or 1, k, scalars)."""
        count = len(state.slope)
        rate = np.zeros((count, weights.shape[1], self.size))
        rate[:, :, : self.n] = (weights * state.slope[:, None]) @ numbers.vectors[:, : self.scalars]
        rate[:, :, self.rigid_at] += weights[:, :, self.rigid]
        return rate

    def sizes(self, z: Array, numbers: Numbers, state: Evaluation, yields: bool = True) -> Array:
        """Return the sum of the sizes of the terms of every equation, shape (S, size).

        With `yields`, the terms of a displacement also count by the force that follows it.
        """
        vectors = np.abs(numbers.vectors[:, : self.scalars])
        x = np.abs(z[:, : self.n])
        reach = self.lengths(x, numbers)
        pushes = np.abs(state.force) + yields * state.slope * reach
        found = np.zeros(z.shape)
        found[:, : self.n] = (pushes[:, None, :] @ vectors)[:, 0] + np.abs(numbers.load)
        found[:, self.rigid_at] = reach[:, self.rigid]
        for k, polar in state.polars.items():
            matrix = np.abs(polar.matrix)
            moved = (matrix @ x[:, :, None])[:, :, 0]
            push = (np.abs(polar.size) + yields * polar.slope * moved.max(axis=1))[:, None]
            found[:, : self.n] += (np.broadcast_to(push, moved.shape)[:, None, :] @ matrix)[:, 0]
            where = self.polar_at.get(k)
            if where is not None:
                width = 2 if self.states[k] == at.PINNED else 1
                found[:, where : where + width] += moved.max(axis=1)[:, None]
        return found

    def lengths(self, x: Array, numbers: Numbers) -> Array:
        """Return the sum of the sizes of the terms of every approach (S, scalars), from |x|."""
        gap = np.where(np.isfinite(numbers.gap), np.abs(numbers.gap), 0.0)
        vectors = np.abs(numbers.vectors[:, : self.scalars])
        return np.asarray((vectors @ x[:, :, None])[:, :, 0] + gap[:, : self.scalars])

    # --- Answers --------------------------------------------------------------------------------

    def solve(self, z: Array, numbers: Numbers) -> tuple[Array, Flags]:
        """Solve from points z by Newton's method, with least-norm steps where z is undetermined.

        Returns
        -------
        ndarray, shape (S, size)
        ndarray of bool, shape (S,)
            Whether there is a solution nearby.
        """
        z = z.copy()
        count = len(z)
        done, lost = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        previous = np.full(count, np.inf)
        for _ in range(FOLLOW.steps):
            rows = np.flatnonzero(~done & ~lost)
            if not len(rows):
                break
            here = numbers.take(rows)
            with np.errstate(all="ignore"):
                state = self.state(z[rows], here, every=False)
                off = self.residual(z[rows], here, state)
                jacobian = self.jacobian(z[rows], here, state)
            finite = np.isfinite(jacobian).all(axis=(1, 2)) & np.isfinite(off).all(axis=1)
            lost[rows[~finite]] = True
            rows, off, jacobian = rows[finite], off[finite], jacobian[finite]
            if not len(rows):
                continue
            step = least_norm_step(jacobian, off, self.leaves_free(jacobian))
            z[rows] -= step
            size = np.abs(step).max(axis=1, initial=0.0)
            scale = np.maximum(np.abs(z[rows]).max(axis=1, initial=0.0), 1.0)
            small = size <= FOLLOW.solved * scale
            done[rows] = (size <= FOLLOW.last * scale) | (small & (size >= 0.5 * previous[rows]))
            lost[rows] |= ~np.isfinite(size) | (size > FOLLOW.lost)
            previous[rows] = size
        with np.errstate(all="ignore"):
            off = np.abs(self.residual(z, numbers)).max(axis=1, initial=0.0)
        unit = np.abs(numbers.load).max(axis=1, initial=0.0)
        return z, (done | (previous <= FOLLOW.solved)) & ~lost & (
            off <= FOLLOW.balanced * np.maximum(unit, 1.0)
        )

    @property
    def floats(self) -> bool:
        """Whether the set leaves moves free, at the points where it was first solved."""
        return bool(self._free)

    def leaves_free(self, jacobian: Array) -> bool:
        """Return whether the set leaves moves free, as found where it is first solved."""
        if self._free is None:
            self._free = bool(free_moves(balanced(jacobian)[1])[1].any())
        return self._free

    def start(self, x: Array, numbers: Numbers) -> Array:
        """Return unknowns (S, size) at coordinates (S, n); their forces fit the balance best."""
        z = np.zeros((len(x), self.size))
        z[:, : self.n] = x
        if self.size > self.n:
            # On a set that cannot act here, nothing is finite: there is no solution nearby.
            with np.errstate(all="ignore"):
                off = self.residual(z, numbers)[:, : self.n]
                borders = self.jacobian(z, numbers)[:, : self.n, self.n :]
            z[:, self.n :] = -(np.linalg.pinv(borders) @ off[:, :, None])[:, :, 0]
        return z


def pressed(b: Array, c: Array, approach: Array) -> tuple[Array, Array]:
    """Return F and dF/dδ of closed contacts, δ = bF + cF^(2/3), with F continued as odd in δ."""
    size = np.abs(approach)
    with np.errstate(divide="ignore", invalid="ignore"):
        curved = roots(b, np.where(c > 0.0, c, 1.0), np.where(size > 0.0, size, 1.0))
        root = np.where((c > 0.0) & (size > 0.0), curved, np.cbrt(size / b))
        slope = 1.0 / (b + np.where(c > 0.0, 2.0 / 3.0 * c / root, 0.0))
    return np.copysign(root**3, approach), slope


def balanced(jacobian: Array) -> tuple[Array, Array]:
    """Scale the rows and columns of a Jacobian so that the largest entry of each is about one.

    Returns
    -------
    ndarray, shape (S, size)
        Factors of the rows, which are those of the columns as well.
    ndarray, shape (S, size, size)
        The scaled Jacobian.
    """
    factor, scaled = np.ones(jacobian.shape[:2]), jacobian
    for _ in range(3):
        largest = np.abs(scaled).max(axis=2)
        factor = factor / np.sqrt(np.where(largest > 0.0, largest, 1.0))
        scaled = jacobian * factor[:, :, None] * factor[:, None, :]
    return factor, scaled


def least_norm_step(jacobian: Array, off: Array, singular: bool = True) -> Array:
    """Solve J step = off, with the least step in scaled unknowns where J is singular."""
    factor, scaled = balanced(jacobian)
    if not singular:
        try:
            return np.asarray(factor * np.linalg.solve(scaled, (factor * off)[:, :, None])[:, :, 0])
        except np.linalg.LinAlgError:
            pass
    inverse = np.linalg.pinv(scaled, rcond=FOLLOW.rank)
    step = factor * (inverse @ (factor * off)[:, :, None])[:, :, 0]
    # One refinement: the inverse alone loses digits where stiff and soft parts meet.
    left = off - (jacobian @ step[:, :, None])[:, :, 0]
    return np.asarray(step + factor * (inverse @ (factor * left)[:, :, None])[:, :, 0])


def free_moves(jacobian: Array) -> tuple[Array, Flags]:
    """Return the moves of the unknowns that a Jacobian (S, size, size) does not resist.

    Returns
    -------
    ndarray, shape (S, size, size)
        Orthonormal moves, one per row, in unknowns scaled as by `balanced`.
    ndarray of bool, shape (S, size)
        Which of the rows are not resisted.
    """
    _, sizes, right = np.linalg.svd(jacobian)
    return right, sizes <= FOLLOW.rank * sizes.max(axis=1, initial=0.0)[:, None]
