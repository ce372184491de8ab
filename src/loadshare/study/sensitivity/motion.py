"""The linearised equations of a branch at a point, and how its unknowns move with an input.

Source: implicit function theorem.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from loadshare.array_types import Array
from loadshare.settings import EPS, SENSITIVITY
from loadshare.study.sensitivity.branch import Branch, BranchGauge
from loadshare.study.sensitivity.differences import SideSlope

Gauges = dict[tuple[int, int], BranchGauge]
"""Gauges, by element and the state to which it would change."""


class Tangent:
    """The linearised equations of a branch at a point, solved by least squares.

    Parameters
    ----------
    branch : Branch
    z : ndarray, shape (size,)

    Attributes
    ----------
    matrix : ndarray, shape (size, size)
        The Jacobian.
    inverse : ndarray, shape (size, size)
        Its pseudo-inverse, computed from the equilibrated matrix.
    unbalanced : ndarray, shape (size, d)
        Orthonormal combinations of equations that no unknown changes.
    loose : ndarray, shape (n, d)
        Directions of the coordinates that change no equation.
    """

    def __init__(self, branch: Branch, z: Array) -> None:
        self.matrix = branch.jacobians(z[None])[0]
        size = len(self.matrix)
        largest = np.abs(self.matrix).max(axis=1, initial=0.0)
        scale = 1.0 / np.sqrt(np.where(largest > 0.0, largest, 1.0))
        left, sizes, right = np.linalg.svd(self.matrix * scale[:, None] * scale)
        rank = int((sizes > SENSITIVITY.rank * sizes.max(initial=0.0)).sum())
        core = (right[:rank].T / sizes[:rank]) @ left[:, :rank].T
        self.inverse = np.asarray(scale[:, None] * core * scale)
        self.unbalanced = _orthonormal(scale[:, None] * left[:, rank:], size)
        spans = _orthonormal(scale[:, None] * right[rank:].T, size)
        self.loose = spans[: branch.n]
        self._branch, self._z = branch, z

    @cached_property
    def _beside(self) -> Array:
        """Change of the Jacobian with the round-off of each equation, (k, size, size).

        The round-off of unknowns is that of the equations, carried through the solve: if two of
        them share it, as those on either side of a stiff contact do, it moves them together.
        """
        steps = (self.inverse * self._branch.rounding(self._z)[: self._branch.size]).T
        return np.asarray(self._branch.jacobians(self._z + steps) - self.matrix)

    def turned(self, rate: Array) -> Array:
        """Return a bound on the errors of the equations' rates as unknowns move at `rate`."""
        return np.asarray(np.abs(self._beside @ rate).sum(axis=0))

    def solve(self, right: Array) -> Array:
        """Solve for a right-hand side, with one refinement."""
        found = self.inverse @ right
        return np.asarray(found + self.inverse @ (right - self.matrix @ found))


def _orthonormal(spans: Array, size: int) -> Array:
    if not spans.shape[1]:
        return np.zeros((size, 0))
    return np.asarray(np.linalg.qr(spans)[0])


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """The motion of the unknowns with an input, on one side.

    Attributes
    ----------
    branch : Branch
        On the active set of that side.
    z : ndarray
        Its unknowns at the value itself; a falling body is where it is caught.
    tangent : Tangent
    rate : ndarray, shape (size,)
        Derivative of z with respect to the input, per SI unit.
    error : ndarray, shape (size,)
        Bound on the error of the equations that the rate solves.
    change : SideSlope
        Derivative of the residual and of the torques with respect to the input, at z.
    elements : tuple of str
        Elements in another state than at the value itself.
    one_sided : bool
        Whether an element leaves the verge or is in another state: the motion then says nothing
        about the other side.
    beside : tuple of Motion
        Motions on sets that differ in elements on the verge whose state cannot be decided: any of
        these sets may be that of this side.
    """

    branch: Branch
    z: Array
    tangent: Tangent
    rate: Array
    error: Array
    change: SideSlope
    elements: tuple[str, ...] = ()
    one_sided: bool = True
    beside: tuple[Motion, ...] = ()

    @property
    def torque(self) -> Array:
        """Derivatives of the meshes' torques [N·m] per SI unit."""
        direct = self.change.value[self.branch.size :]
        return np.asarray(direct + self.branch.torque_gradients(self.z) @ self.rate)

    def bound(self, functionals: Array) -> Array:
        """Return a bound on the error of linear functionals (k, size) of the rate."""
        adjoint = np.abs(functionals @ self.tangent.inverse)
        terms = np.abs(functionals) @ np.abs(self.rate)
        return np.asarray(adjoint @ self.error + 4.0 * EPS * terms)


@dataclass(frozen=True, eq=False)
class BranchPoint:
    """A branch and its unknowns at the input's own value.

    Attributes
    ----------
    branch : Branch
    z : ndarray
    idle : frozenset of int
        Open contacts on the verge that may close: under a law that is infinitely soft at first they
        carry nothing, to first order.
    """

    branch: Branch
    z: Array
    idle: frozenset[int] = frozenset()

    @cached_property
    def tangent(self) -> Tangent:
        """Its linearised equations."""
        return Tangent(self.branch, self.z)

    @cached_property
    def gauges(self) -> Gauges:
        """The gauges of all elements there."""
        return self.branch.gauges(self.z)
