"""The contact problem of one position, in SI: coordinates, rows and radial elements."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from statistics import median

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.problem import ContactProblem, Radial
from loadshare.scene.coordinates import Rotation
from loadshare.settings import CONTACT
from loadshare.train.situations import Situations
from loadshare.train.train import Train


@dataclass(frozen=True, slots=True, eq=False)
class GearRadial(Radial):
    """A spline or a round ring.

    Attributes
    ----------
    gear : str
        Gear whose displacement it limits.
    """

    gear: str = field(kw_only=True)


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene(ContactProblem):
    """The whole contact problem of a position, in metres and newtons.

    Attributes
    ----------
    coordinates : tuple of str
        Names; every coordinate is a length [m].
    stiffness : ndarray, shape (n, n)
        H [N/m], from shafts and supports.
    load : ndarray, shape (n,)
        f [N].
    rows : tuple of Row
    arcs : tuple of ArcRow
    radials : tuple of GearRadial
    train, situation
        What the scene was assembled from.
    springs : ndarray, shape (k, n)
        Directions of shafts and supports.
    rotation : mapping of gear to Rotation
    turned : mapping of gear to float
        Rotation at zero coordinates [rad], from clockings of rigid shafts.
    displacement : mapping of gear to slice
        The two displacement components of a moving gear.
    removed : tuple of (str, str)
        Names of what did not become a coordinate or row, and why.
    """

    radials: tuple[GearRadial, ...]
    train: Train
    situation: Situations
    springs: Array
    rotation: dict[str, Rotation]
    turned: dict[str, float]
    displacement: dict[str, slice]
    removed: tuple[tuple[str, str], ...]

    @property
    def position(self) -> int:
        """Position (1-based)."""
        return self.situation.position

    @cached_property
    def torques(self) -> dict[str, float]:
        """External torques [N·m], by gear."""
        return self.situation.torques

    def force_unit(self) -> float:
        """Return the unit of force of the scene [N]: the largest external push, or 1 N at rest."""
        pushes = [abs(t) / self.train.gears[g].base_radius for g, t in self.torques.items()]
        pushes.append(float(np.abs(self.situation.push).max(initial=0.0)))
        return max(pushes) or 1.0

    def length_unit(self) -> float:
        """Return the unit of length [m]: the compression of flanks, or 1/1000 of their gaps.

        Under a light load the gaps are far larger than the compressions; in units of the latter,
        they would exceed the range that a solver resolves.
        """
        force = self.force_unit()
        flanks = [r for r in self.rows if r.kind == "drive flank"]
        if not flanks:
            return CONTACT.least_length
        yielded = median(r.law.compression(force) for r in flanks)
        return max(yielded, CONTACT.of_gaps * max(abs(r.gap) for r in flanks))

    def first_torques(self) -> dict[str, float]:
        """Return a first guess of the torques over splines [N·m]: the whole input torque."""
        driving, gears = self.torques[self.train.input], self.train.gears
        return {r.name: driving / (gears[r.gear].ratio or 1.0) for r in self.radials}

    def angle(self, gear: str, x: Array) -> float:
        """Return the rotation φ [rad] of a gear at the coordinates x."""
        r = self.rotation[gear]
        return self.turned[gear] + (r.rate * float(x[r.index]) if r.index is not None else 0.0)

    def moved(self, gear: str, x: Array) -> Array:
        """Return the displacement p (3,) [m] of a gear at the coordinates x."""
        where = self.displacement.get(gear)
        if where is None:
            return np.zeros(3)
        return np.asarray(x[where] @ self.train.gears[gear].frame)
