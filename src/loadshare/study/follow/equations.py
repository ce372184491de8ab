r"""The equations of a machine on one set, for many points at once.

Contacts that yield are eliminated by their closed form F(δ), continued oddly below zero, so that a
branch can be followed across the point where it ends. Rigid contacts, steps and rigid stops keep
their forces as unknowns. With coordinates x and forces p the unknowns are z = (x, p), and

.. math:: G(z) = \Big(\sum_e a_e F_e(a_e x - g_e) + \sum_j P_j^T \Phi_j - f,\; c(x)\Big) = 0.

An arc is an element with a direction like a radial one: its force acts along the line of centres.
Source: formulation, sections 3 to 6.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.elements import Elements
from loadshare.scene.scene import Array
from loadshare.solver.hot import places as at
from loadshare.study.follow.line import Codes, Numbers

Flags = NDArray[np.bool_]

STEPS = 40
"""Newton's steps before a branch counts as lost."""
SOLVED = 1e-11
"""Last step of an answer, relative to the largest unknown."""
ROOTS = 30
"""Newton's steps for a cube root of a force; about six are taken."""
RANK = 1e-12
"""Singular values below this, relative to the largest, of the scaled Jacobian, count as zero."""


@dataclass(frozen=True, slots=True)
class Held:
    """A set: codes of all elements, and on which piece of its table each tabulated contact stands.

    Attributes
    ----------
    code, pieces : tuple of int
    """

    code: tuple[int, ...]
    pieces: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Polar:
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
    limit : ndarray, shape (S,), or None
        Radius at which the element is held by an unknown force.
    """

    matrix: Array
    offset: Array
    radius: Array
    along: Array
    size: Array
    slope: Array
    limit: Array | None

    @property
    def stiffness(self) -> Array:
        """Derivative (S, k, k) of the force with respect to the offset."""
        dyad = self.along[:, :, None] * self.along[:, None, :]
        across = self.size / np.where(self.radius > 0.0, self.radius, np.inf)
        one = np.eye(self.offset.shape[1])
        return np.asarray(self.slope[:, None, None] * dyad + across[:, None, None] * (one - dyad))


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """Everything at S points z.

    Attributes
    ----------
    approach, force, slope : ndarray, shape (S, k)
        Of all springs, flanks and stops; F and dF/dδ, zero for open and rigid ones.
    margin : ndarray, shape (S, arcs)
        Distance beyond each arc.
    arcs, radials : mapping of number to Polar
    laws : list of Graph
        Of the radial elements.
    transmitted : ndarray, shape (S, radials)
        Torque that each radial element transmits.
    """

    approach: Array
    force: Array
    slope: Array
    margin: Array
    arcs: dict[int, Polar]
    radials: dict[int, Polar]
    laws: list[at.Graph]
    transmitted: Array


class Equations:
    """A machine on a set.

    Parameters
    ----------
    elements : Elements
    held : Held
    numbers : Numbers
        At any value: they tell which contacts are rigid, linear, curved or tabulated.
    tabulated : ndarray of int, shape (m,)
        Number of the table of an element, −1 without.
    """

    def __init__(
        self, elements: Elements, held: Held, numbers: Numbers, tabulated: NDArray[np.intp]
    ) -> None:
        self.elements, self.held, self.tabulated = elements, held, tabulated
        self.code: Codes = np.array(held.code, dtype=np.int8)
        self.n = elements.scene.size
        self.scalars = elements.springs + len(elements.scene.rows)
        rows = self.code[: elements.rows] == at.CLOSED
        acting = np.append(np.ones(elements.springs, dtype=bool), rows)
        self.acts = acting[: self.scalars]
        self.arc_acts = acting[self.scalars :]
        curved: Flags = np.asarray((numbers.hertz > 0.0).any(axis=0))
        yields: Flags = np.asarray((numbers.bending > 0.0).any(axis=0) | curved | (tabulated >= 0))
        part = slice(0, self.scalars)
        self.rigid = np.flatnonzero(self.acts & ~yields[part])
        self.linear = np.flatnonzero(self.acts & yields[part] & ~curved[part])
        self.linear = self.linear[tabulated[self.linear] < 0]
        self.curved = np.flatnonzero(self.acts & curved[part])
        self.tables = np.flatnonzero(self.acts & (tabulated[part] >= 0))
        self.places = self.code[elements.rows :]
        self._free: bool | None = None
        self._count_unknowns(yields[self.scalars :])

    def _count_unknowns(self, yields: Flags) -> None:
        """Give every force that does not follow from a displacement its place in z."""
        count = self.n
        self.rigid_at = count + np.arange(len(self.rigid))
        count += len(self.rigid)
        self.arc_at: dict[int, int | None] = {}
        for a in np.flatnonzero(self.arc_acts).tolist():
            self.arc_at[a] = None if yields[a] else count
            count += not yields[a]
        self.radial_at: dict[int, int | None] = {}
        for j, place in enumerate(self.places.tolist()):
            if place == at.OPEN:
                continue
            known = place in (at.STICK, at.SLIP, at.STOP)
            self.radial_at[j] = None if known else count
            count += 0 if known else 2 if place == at.PINNED else 1
        self.size = count

    # --- At points ------------------------------------------------------------------------------

    def state(self, z: Array, numbers: Numbers, every: bool = True) -> State:
        """Return approaches, forces and offsets at points z (S, size); of all, or what acts."""
        x = z[:, : self.n]
        vectors = numbers.vectors[:, : self.scalars]
        approach = (vectors @ x[:, :, None])[:, :, 0] - numbers.gap[:, : self.scalars]
        force, slope = np.zeros_like(approach), np.zeros_like(approach)
        for k in self.linear:
            slope[:, k] = 1.0 / numbers.bending[:, k]
            force[:, k] = approach[:, k] * slope[:, k]
        if len(self.curved):
            b, c = numbers.bending[:, self.curved], numbers.hertz[:, self.curved]
            force[:, self.curved], slope[:, self.curved] = pressed(b, c, approach[:, self.curved])
        for k, piece in zip(self.tables, self.held.pieces, strict=True):
            table = numbers.tables[:, self.tabulated[k]]
            start, rate = table[:, :, piece], np.diff(table[:, :, piece : piece + 2])[:, :, 0]
            slope[:, k] = rate[:, 0] / rate[:, 1]
            force[:, k] = start[:, 0] + slope[:, k] * (approach[:, k] - start[:, 1])
        force[:, self.rigid] = z[:, self.rigid_at]
        transmitted = (numbers.carried[:, :, : self.scalars] @ force[:, :, None])[:, :, 0]
        count = len(z)
        laws = [
            at.graph(np.broadcast_to(numbers.radial[:, j], (count, 6)), transmitted[:, j])
            for j in range(len(self.places))
        ]
        arcs, margin = {}, np.zeros((count, len(self.arc_acts)))
        for a in range(len(self.arc_acts)) if every else self.arc_at:
            arcs[a], margin[:, a] = self._arc(a, z, numbers)
        those = range(len(self.places)) if every else self.radial_at
        radials = {j: self._radial(j, laws[j], z, numbers) for j in those}
        return State(approach, force, slope, margin, arcs, radials, laws, transmitted)

    def _arc(self, a: int, z: Array, numbers: Numbers) -> tuple[Polar, Array]:
        matrix, nominal = numbers.relative[:, a], numbers.nominal[:, a]
        moved = numbers.shift[:, a] + (matrix @ z[:, : self.n, None])[:, :, 0]
        offset = nominal + moved
        radius = np.sqrt((offset * offset).sum(axis=1))
        apart = np.sqrt((nominal * nominal).sum(axis=1))
        grown = 2.0 * (moved * nominal).sum(axis=1) + (moved * moved).sum(axis=1)
        margin = grown / (radius + apart) + numbers.clearance[:, a]
        size, slope, limit = np.zeros_like(radius), np.zeros_like(radius), None
        if a in self.arc_at:
            where = self.arc_at[a]
            if where is None:
                slope = np.broadcast_to(1.0 / numbers.bending[:, self.scalars + a], radius.shape)
                size = margin * slope
            else:
                size, limit = -z[:, where], radius - margin
        return Polar(matrix, offset, radius, offset / radius[:, None], size, slope, limit), margin

    def _radial(self, j: int, law: at.Graph, z: Array, numbers: Numbers) -> Polar:
        column = self.elements.radial_column(j)
        matrix = numbers.vectors[:, column : column + 2]
        offset = (matrix @ z[:, : self.n, None])[:, :, 0] - numbers.gap[:, column : column + 2]
        radius = np.sqrt((offset * offset).sum(axis=1))
        along = offset / np.where(radius > 0.0, radius, 1.0)[:, None]
        size, slope = np.zeros_like(radius), np.zeros_like(radius)
        limit: Array | None = None
        place = self.places[j]
        if place == at.STICK:
            size, slope = law.first * radius, law.first
        elif place == at.SLIP:
            size = law.bound
        elif place == at.STOP:
            size, slope = law.bound + law.last * (radius - law.reach), law.last
        elif place in (at.WALL, at.CORNER):
            where = self.radial_at[j]
            assert where is not None
            size, limit = z[:, where], law.stick if place == at.CORNER else law.reach
        return Polar(matrix, offset, radius, along, size, slope, limit)

    def residual(self, z: Array, numbers: Numbers, state: State | None = None) -> Array:
        """Return G, shape (S, size)."""
        state = state or self.state(z, numbers)
        n = self.n
        found = np.zeros(z.shape)
        vectors = numbers.vectors[:, : self.scalars]
        found[:, :n] = (state.force[:, None, :] @ vectors)[:, 0] - numbers.load
        found[:, self.rigid_at] = state.approach[:, self.rigid]
        for polar, where, pinned in self._acting(state):
            if pinned:
                assert where is not None
                force = z[:, where : where + 2]
                found[:, where : where + 2] = polar.offset
            else:
                force = polar.size[:, None] * polar.along
                if self.places_stick(polar, state):
                    force = polar.slope[:, None] * polar.offset
            found[:, :n] += (force[:, None, :] @ polar.matrix)[:, 0]
        for a, where in self.arc_at.items():
            if where is not None:
                found[:, where] = -state.margin[:, a]
        for j, where in self.radial_at.items():
            limit = state.radials[j].limit
            if limit is not None:
                found[:, where] = state.radials[j].radius - limit
        return found

    def places_stick(self, polar: Polar, state: State) -> bool:
        """Whether a polar element is a spring about its centre."""
        return any(p is polar and self.places[j] == at.STICK for j, p in state.radials.items())

    def _acting(self, state: State) -> list[tuple[Polar, int | None, bool]]:
        """Polar elements that act, where their unknowns stand, and whether they are pinned."""
        arcs = [(state.arcs[a], w, False) for a, w in self.arc_at.items()]
        radials = [
            (state.radials[j], w, bool(self.places[j] == at.PINNED))
            for j, w in self.radial_at.items()
        ]
        return [*arcs, *radials]

    def jacobian(self, z: Array, numbers: Numbers, state: State | None = None) -> Array:
        """Return the derivative of G, shape (S, size, size)."""
        state = state or self.state(z, numbers)
        n, count = self.n, len(z)
        found = np.zeros((count, self.size, self.size))
        vectors = np.broadcast_to(numbers.vectors[:, : self.scalars], (count, self.scalars, n))
        found[:, :n, :n] = vectors.transpose(0, 2, 1) @ (state.slope[:, :, None] * vectors)
        found[:, :n, self.rigid_at] = vectors[:, self.rigid].transpose(0, 2, 1)
        found[:, self.rigid_at, :n] = vectors[:, self.rigid]
        for a, where in self.arc_at.items():
            polar = state.arcs[a]
            turned = polar.matrix.transpose(0, 2, 1)
            found[:, :n, :n] += turned @ polar.stiffness @ polar.matrix
            if where is not None:
                pull = (polar.along[:, None, :] @ polar.matrix)[:, 0]
                found[:, :n, where] = found[:, where, :n] = -pull
        for j, where in self.radial_at.items():
            polar, place = state.radials[j], self.places[j]
            turned = polar.matrix.transpose(0, 2, 1)
            if place == at.PINNED:
                assert where is not None
                both = slice(where, where + 2)
                found[:, :n, both], found[:, both, :n] = turned, polar.matrix
                continue
            springs = polar.slope[:, None, None] * np.eye(2)
            stiff = springs if place == at.STICK else polar.stiffness
            found[:, :n, :n] += turned @ stiff @ polar.matrix
            pull = (polar.along[:, None, :] @ polar.matrix)[:, 0]
            if where is not None:
                found[:, :n, where] = found[:, where, :n] = pull
            if place in (at.SLIP, at.STOP):
                found[:, :n] += pull[:, :, None] * self.follow(j, state, numbers)[:, None, :]
        return found

    def follow(self, j: int, state: State, numbers: Numbers) -> Array:
        """Derivative (S, size) of a friction bound that follows the torque; zero for others."""
        count = len(state.transmitted)
        rate = np.zeros((count, self.size))
        number = np.broadcast_to(numbers.radial[:, j], (count, 6))
        follows = np.isnan(number[:, 3])
        if not follows.any():
            return rate
        per = np.where(follows, number[:, 4] * np.sign(state.transmitted[:, j]), 0.0)
        arms = np.broadcast_to(numbers.carried[:, j, : self.scalars], (count, self.scalars))
        vectors = numbers.vectors[:, : self.scalars]
        rate[:, : self.n] = ((arms * state.slope)[:, None, :] @ vectors)[:, 0]
        rate[:, self.rigid_at] += arms[:, self.rigid]
        return per[:, None] * rate

    # --- Answers --------------------------------------------------------------------------------

    def solve(self, z: Array, numbers: Numbers) -> tuple[Array, Flags]:
        """Solve from points z by Newton's method, by steps of least norm where z is not determined.

        Returns
        -------
        ndarray, shape (S, size)
        ndarray of bool, shape (S,)
            Whether there is a solution near by.
        """
        z = z.copy()
        count = len(z)
        done, lost = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        previous = np.full(count, np.inf)
        for _ in range(STEPS):
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
            step = self._step(jacobian, off)
            z[rows] -= step
            size = np.abs(step).max(axis=1, initial=0.0)
            scale = np.maximum(np.abs(z[rows]).max(axis=1, initial=0.0), 1.0)
            small = size <= SOLVED * scale
            done[rows] = (size <= 1e-15 * scale) | (small & (size >= 0.5 * previous[rows]))
            lost[rows] |= ~np.isfinite(size) | (size > 1e9)
            previous[rows] = size
        with np.errstate(all="ignore"):
            off = np.abs(self.residual(z, numbers)).max(axis=1, initial=0.0)
        unit = np.abs(numbers.load).max(axis=1, initial=0.0)
        return z, (done | (previous <= SOLVED)) & ~lost & (off <= 1e-9 * np.maximum(unit, 1.0))

    def _step(self, jacobian: Array, off: Array) -> Array:
        """Newton's step; of least norm on a set that leaves something free."""
        return least_norm_step(jacobian, off, self.leaves_free(jacobian))

    @property
    def floats(self) -> bool:
        """Whether the set leaves moves free, where it was solved."""
        return bool(self._free)

    def leaves_free(self, jacobian: Array) -> bool:
        """Whether the set leaves moves free, told at the first points at which it is solved."""
        if self._free is None:
            factor = scaling(jacobian)
            scaled = jacobian * factor[:, :, None] * factor[:, None, :]
            self._free = bool(free_moves(scaled)[1].any())
        return self._free

    def start(self, x: Array, numbers: Numbers) -> Array:
        """Return unknowns (S, size) at coordinates (S, n): forces that fit the balance best."""
        z = np.zeros((len(x), self.size))
        z[:, : self.n] = x
        if self.size > self.n:
            off = self.residual(z, numbers)[:, : self.n]
            borders = self.jacobian(z, numbers)[:, : self.n, self.n :]
            z[:, self.n :] = -(np.linalg.pinv(borders) @ off[:, :, None])[:, :, 0]
        return z

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of all switches."""
        return (*self.elements.row_names, *(r.name for r in self.elements.scene.radials))


def pressed(b: Array, c: Array, approach: Array) -> tuple[Array, Array]:
    """Force and slope of closed contacts, δ = bF + cF^(2/3), continued oddly below zero."""
    size = np.abs(approach)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.minimum(np.sqrt(size / c), np.cbrt(size / b))
        # Both bounds lie above the root of a convex function: Newton descends to it.
        for _ in range(ROOTS):
            step = ((b * root + c) * root**2 - size) / ((3.0 * b * root + 2.0 * c) * root)
            root = np.where(size > 0.0, np.where(step > 0.0, root - step, root), 0.0)
            if not (step > 4e-16 * root).any():
                break
        slope = 1.0 / (b + np.where(c > 0.0, 2.0 / 3.0 * c / root, 0.0))
    return np.copysign(root**3, approach), slope


def scaling(jacobian: Array) -> Array:
    """Factors (S, size) that bring the largest entry of every row of a Jacobian to about one."""
    largest = np.abs(jacobian).max(axis=2)
    factor = 1.0 / np.sqrt(np.where(largest > 0.0, largest, 1.0))
    for _ in range(2):
        scaled = np.abs(jacobian) * factor[:, :, None] * factor[:, None, :]
        largest = scaled.max(axis=2)
        factor = factor / np.sqrt(np.where(largest > 0.0, largest, 1.0))
    return np.asarray(factor)


def least_norm_step(jacobian: Array, off: Array, singular: bool = True) -> Array:
    """Solve J step = off, by the least step in scaled unknowns where J is singular."""
    factor = scaling(jacobian)
    scaled = jacobian * factor[:, :, None] * factor[:, None, :]
    if not singular:
        try:
            return np.asarray(factor * np.linalg.solve(scaled, (factor * off)[:, :, None])[:, :, 0])
        except np.linalg.LinAlgError:
            pass
    inverse = np.linalg.pinv(scaled, rcond=RANK)
    step = factor * (inverse @ (factor * off)[:, :, None])[:, :, 0]
    # One refinement: the inverse alone loses digits where stiff and soft parts meet.
    left = off - (jacobian @ step[:, :, None])[:, :, 0]
    return np.asarray(step + factor * (inverse @ (factor * left)[:, :, None])[:, :, 0])


def free_moves(jacobian: Array) -> tuple[Array, Flags]:
    """Moves of the unknowns that a Jacobian (S, size, size) does not resist.

    Returns
    -------
    ndarray, shape (S, size, size)
        In unknowns scaled as by `scaling`, orthonormal, one a row.
    ndarray of bool, shape (S, size)
        Which of the rows are such moves.
    """
    _, sizes, right = np.linalg.svd(jacobian)
    return right, sizes <= RANK * sizes.max(axis=1, initial=0.0)[:, None]
