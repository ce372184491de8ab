"""Limit rings (formulation, section 6)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.train.gear import Vector


@dataclass(frozen=True, slots=True, eq=False)
class DrumRing:
    """Rings that roll on the rings of two neighbours, with radial stops: the drum region.

    Attributes
    ----------
    gear : str
    neighbours : tuple of str
    across : ndarray, shape (3,)
        ŷ, across the line from the first neighbour to the second, a quarter turn counter-clockwise
        of it (about the limited gear's axis).
    clearances : tuple of float
        c_x towards each neighbour [m].
    up, down : float
        h1 and h2 [m].
    stiffness : float
        Of every contact [N/m]; infinite for a rigid ring.
    with_errors : bool
        Whether errors of the gears shift the rings (a ring dimensioned on the drawing), or not (a
        ring set with the errors in place).
    """

    gear: str
    neighbours: tuple[str, str]
    across: Vector
    clearances: tuple[float, float]
    up: float
    down: float
    stiffness: float
    with_errors: bool

    def arc_name(self, neighbour: str) -> str:
        """Name of the contact between the ring and the ring of `neighbour`."""
        return f"ring {self.gear}: arc {neighbour}"

    @property
    def stop_names(self) -> tuple[str, str]:
        """Names of the upper and the lower radial stop."""
        return f"ring {self.gear}: upper stop", f"ring {self.gear}: lower stop"


@dataclass(frozen=True, slots=True, eq=False)
class RoundRing:
    """A round limit ring fixed in the housing.

    Attributes
    ----------
    gear : str
    radius : float
        Largest displacement [m].
    offset : ndarray, shape (3,)
        Centre of the ring relative to O [m].
    stiffness : float
        [N/m]; infinite for a rigid ring.
    """

    gear: str
    radius: float
    offset: Vector
    stiffness: float

    @property
    def name(self) -> str:
        """Name of the contact."""
        return f"ring {self.gear}"


Ring = DrumRing | RoundRing


@dataclass(frozen=True, slots=True, eq=False)
class Arc:
    """The exclusion arc between a ring and a neighbour's ring: |d₀ + Δ| ≥ a − c_x.

    It holds on the side on which the limited gear is mounted. Beyond the neighbour, where
    (d₀ + Δ)·nominal ≤ 0, it is continued by its face at rest, so that such a place is never free.

    Attributes
    ----------
    nominal : ndarray, shape (3,)
        From the neighbour's nominal centre to the limited gear's [m]; its length is a.
    shift : ndarray, shape (3,)
        What errors add to it [m]: d₀ = nominal + shift.
    clearance : float
        c_x [m].
    """

    nominal: Vector
    shift: Vector
    clearance: float

    @property
    def distance(self) -> float:
        """a, the nominal centre distance [m]."""
        return math.sqrt(float(self.nominal @ self.nominal))

    @property
    def start(self) -> Vector:
        """d₀ [m]."""
        return np.asarray(self.nominal + self.shift)

    def normal(self, relative: Vector) -> Vector:
        """Unit outward push on the limited gear at the relative displacement Δ (3,) [m]."""
        d = self.nominal if self.beyond(relative) else self.start + relative
        return d / math.sqrt(float(d @ d))

    def beyond(self, relative: Vector) -> bool:
        """Whether Δ (3,) [m] leads past the neighbour, where no gear can be."""
        return not float(self.nominal @ (self.start + relative)) > 0.0

    def margin(self, relative: Vector) -> float:
        """Distance beyond the arc [m], |d₀ + Δ| − a + c_x, free of cancellation for small Δ.

        At rest and without errors it is the clearance, to the last digit.
        """
        moved = self.shift + relative
        if self.beyond(relative):
            return float(self.nominal @ moved) / self.distance + self.clearance
        d = self.nominal + moved
        here = math.sqrt(float(d @ d))
        grown = 2.0 * float(self.nominal @ moved) + float(moved @ moved)
        return grown / (here + self.distance) + self.clearance

    def face(self, relative: Vector) -> tuple[Vector, float]:
        """Tangent half-plane at Δ: unit normal n (3,) and bound g [m] of n·Δ ≥ −g."""
        n = self.normal(relative)
        return n, self.margin(relative) - float(n @ relative)


def transverse(vector: Vector, axis: Vector) -> Vector:
    """Part of `vector` across `axis`."""
    return np.asarray(vector - (vector @ axis) * axis)
