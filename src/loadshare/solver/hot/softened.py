"""The laws of one sample, each softened a little: single-valued, with a tangent at every point."""

from __future__ import annotations

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.law import roots
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.solver.hot import contact_states as at


class Laws:
    """Forces of all elements as functions of their compressions.

    Parameters
    ----------
    structure : Structure
    loading : Loading
        Of one sample.
    force : ndarray, shape (m,)
        Of the previous pass: the added compliance pulls towards it, and friction follows its
        torques.
    softer, pull : float
        Compliance that is added to every contact, and to every radial element.

    Attributes
    ----------
    lean : ndarray, shape (m,)
        Compression of the added compliance under the forces of the previous pass.
    graph : Graph
        Laws of the radial elements, not softened.
    rise, jump, level : ndarray, shape (radials,)
        Radii at which the first rise, the jump and the level piece of the softened graphs end.
    """

    def __init__(
        self, structure: Structure, loading: Loading, force: Array, softer: float, pull: float
    ) -> None:
        self.springs, self.scalar = structure.springs, structure.columns.contacts.stop
        self.compliance = loading.bending[0, : self.scalar] + softer
        self.power = np.flatnonzero(loading.hertz[0, : self.scalar] > 0.0)
        self.hertz = loading.hertz[0, self.power]
        self.table = np.flatnonzero(loading.tabulated[: self.scalar] >= 0)
        points = loading.tables[0, loading.tabulated[self.table]]
        self.forces_of, self.ends = points[:, 0], points[:, 1] + softer * points[:, 0]
        self.slopes_of = np.diff(self.forces_of, axis=1) / np.diff(self.ends, axis=1)
        self.last_piece = (~np.isnan(self.ends)).sum(axis=1) - 2
        self.lean = np.repeat([softer, pull], [self.scalar, len(force) - self.scalar]) * force
        size = np.hypot(force[self.scalar :: 2], force[self.scalar + 1 :: 2])
        radius = at.reached(loading.radial[0], size)
        self.graph = law = at.graph(loading.radial[0], loading.carried @ force, radius)
        with np.errstate(invalid="ignore"):
            self.rise = np.where(law.first > 0.0, law.stick * (1.0 + pull * law.first), 0.0)
            self.first = law.first / (1.0 + pull * law.first)
            soft = law.last / (1.0 + pull * law.last)
        self.last = np.where(np.isinf(law.last), 1.0 / pull, soft)
        self.jump = np.maximum(law.stick + pull * law.bound, self.rise)
        self.level = np.maximum(law.reach + pull * law.bound, self.jump)
        self.steep = 1.0 / pull

    def forces(self, pressed: Array) -> Array:
        """Return forces (…, m) at compressions (…, m)."""
        force = np.empty_like(pressed)
        flat = pressed[..., : self.scalar]
        force[..., : self.scalar] = flat / self.compliance
        if len(self.power):
            b, u = self.compliance[self.power], flat[..., self.power]
            force[..., self.power] = roots(b, self.hertz, np.where(u > 0.0, u, 1.0)) ** 3
        if len(self.table):
            k, rows = self._pieces(flat), np.arange(len(self.table))
            beyond = flat[..., self.table] - self.ends[rows, k]
            force[..., self.table] = self.forces_of[rows, k] + self.slopes_of[rows, k] * beyond
        contacts = slice(self.springs, self.scalar)
        force[..., contacts][~(pressed[..., contacts] > 0.0)] = 0.0
        radius = self.radii(pressed)
        over = self._sizes(radius) / np.where(radius > 0.0, radius, 1.0)
        force[..., self.scalar :] = np.repeat(over, 2, axis=-1) * pressed[..., self.scalar :]
        return force

    def tangents(self, pressed: Array, force: Array) -> tuple[Array, Array]:
        """Return compliances of scalar elements, infinite without a push, and radial stiffnesses.

        Parameters
        ----------
        pressed, force : ndarray, shape (m,)

        Returns
        -------
        ndarray, shape (scalar elements,)
        ndarray, shape (radial elements, 2, 2)
        """
        compliance = np.array(self.compliance)
        if len(self.power):
            # The force of a contact that pushes may be too small for a double.
            pushes = (pressed[self.power] > 0.0) & (force[self.power] > 0.0)
            root = np.cbrt(np.where(pushes, force[self.power], 1.0))
            compliance[self.power] += 2.0 / 3.0 * self.hertz / root
        if len(self.table):
            k = self._pieces(pressed[: self.scalar])
            compliance[self.table] = 1.0 / self.slopes_of[np.arange(len(self.table)), k]
        contacts = slice(self.springs, self.scalar)
        compliance[contacts][~(pressed[contacts] > 0.0)] = np.inf
        radius = self.radii(pressed)
        slope = self._chosen(radius, (self.first, self.steep, 0.0, self.last))
        there = np.where(radius > 0.0, radius, 1.0)
        across = np.where(radius > 0.0, self._sizes(radius) / there, slope)
        along = pressed[self.scalar :].reshape(-1, 2) / there[:, None]
        dyad = along[:, :, None] * along[:, None, :]
        return compliance, (
            slope[:, None, None] * dyad + across[:, None, None] * (np.eye(2) - dyad)
        )

    def kinks(self, pressed: Array, speed: Array) -> Array:
        """Return the shares of a way, within (0, 1) and in order, at which some law has a kink."""
        contacts = slice(self.springs, self.scalar)
        with np.errstate(all="ignore"):
            found = [-pressed[contacts] / speed[contacts]]
            if len(self.table):
                ways = (self.ends - pressed[self.table, None]) / speed[self.table, None]
                found.append(ways.ravel())
            offset = pressed[self.scalar :].reshape(-1, 2)
            velocity = speed[self.scalar :].reshape(-1, 2)
            square = (velocity * velocity).sum(axis=1)
            nearest = -(offset * velocity).sum(axis=1) / square
            far = np.stack([self.rise, self.jump, self.level]) ** 2
            least = offset + nearest[:, None] * velocity
            half = np.sqrt((far - (least * least).sum(axis=1)) / square)
            found += [(nearest - half).ravel(), (nearest + half).ravel(), nearest]
        ways = np.concatenate(found)
        return np.unique(ways[(ways > 0.0) & (ways < 1.0)])

    def radii(self, pressed: Array) -> Array:
        """Return the radius (…, radials) of every radial element."""
        square = pressed[..., self.scalar :] ** 2
        return np.asarray(np.sqrt(square[..., ::2] + square[..., 1::2]))

    def _sizes(self, radius: Array) -> Array:
        """Return the sizes of radial forces."""
        law = self.graph
        with np.errstate(invalid="ignore"):
            jumping = (radius - law.stick) * self.steep
            beyond = law.bound + self.last * (radius - self.level)
            return self._chosen(radius, (self.first * radius, jumping, law.bound, beyond))

    def _chosen(self, radius: Array, values: tuple[Array | float, ...]) -> Array:
        """Return the value of the piece on which each radial element is."""
        rising, jumping, level, beyond = values
        found = np.where(radius <= self.level, level, beyond)
        found = np.where(radius <= self.jump, jumping, found)
        return np.where(radius <= self.rise, rising, found)

    def _pieces(self, flat: Array) -> np.ndarray:
        """Return the piece (…, tables) of every tabulated law."""
        passed = (self.ends <= flat[..., self.table, None]).sum(axis=-1)
        return np.asarray(np.clip(passed - 1, 0, self.last_piece))
