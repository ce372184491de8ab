"""Elements that limit a float: rings, bearings with clearance (formulation, sections 6 and 14)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.train.gear import Vector


@dataclass(frozen=True, slots=True, eq=False)
class DrumRing:
    """Ring that rolls on the rings of two neighbours, with radial stops: the drum region.

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
        [N/m^power]; infinite for a rigid ring.
    power : float
        Exponent with which the force grows with the displacement beyond the radius [-].
    """

    gear: str
    radius: float
    offset: Vector
    stiffness: float
    power: float = 1.0

    @property
    def name(self) -> str:
        """Name of the contact."""
        return f"ring {self.gear}"


@dataclass(frozen=True, slots=True, eq=False)
class Bearing(RoundRing):
    """A bearing whose clearance is the radius within which its gear moves freely."""

    @property
    def name(self) -> str:
        """Name of the contact."""
        return f"bearing {self.gear}: outer race"


Ring = DrumRing | RoundRing


def transverse(vector: Vector, axis: Vector) -> Vector:
    """Return the part of `vector` across `axis`."""
    return np.asarray(vector - (vector @ axis) * axis)
