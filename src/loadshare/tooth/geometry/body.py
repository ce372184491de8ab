"""Solid teeth of gears of all kinds, and the placement of a gear in the fixed frame."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from loadshare.tooth.cylindrical.gear import HelicoidGear
    from loadshare.tooth.face.gear import FaceGear

Array: TypeAlias = NDArray[np.float64]


HEIGHTS = 1.5
"""Default depth of the body below the teeth, in tooth heights [-]."""
RIM = f"{HEIGHTS} tooth heights"
"""The same in words."""
HALVED = "half the root radius"
"""The same for an external gear in which 1.5 tooth heights would leave hardly any bore."""


@dataclass(frozen=True)
class PitchDeviations:
    """Deviations of the loaded flanks of a gear's teeth from even pitches.

    Parameters
    ----------
    cumulative : tuple of float
        By tooth, in the order in which they come into mesh: how far each is ahead in the sense
        of rotation, as an arc of the pitch circle [m]; 0 for teeth beyond the list.
    first : int
        Tooth of pair 0, counted from 1.
    """

    cumulative: tuple[float, ...]
    first: int = 1


class Gear:
    """Data common to gears of every kind."""

    teeth: int
    """Number of teeth."""
    youngs_modulus: float
    """Modulus of elasticity [Pa]."""
    poisson: float
    """Poisson's ratio."""
    pitch: PitchDeviations | None = None
    """Pitch deviations, if any."""

    @property
    def pitch_radius(self) -> float:
        """Radius of the circle along which pitch deviations are measured [m]."""
        raise NotImplementedError

    def tooth_of(self, pair: int) -> int:
        """Return the tooth number of a pair, from 1; teeth that meet later have larger numbers."""
        first = self.pitch.first if self.pitch else 1
        return (first - 1 - pair) % self.teeth + 1

    def ahead(self, pair: int) -> float:
        """Return the angle by which the tooth of a pair is ahead [rad]."""
        number = self.tooth_of(pair)
        if self.pitch is None or number > len(self.pitch.cumulative):
            return 0.0
        return self.pitch.cumulative[number - 1] / self.pitch_radius


@dataclass(frozen=True, eq=False)
class Placement:
    """Position of a gear's frame, before the gear turns, in the fixed frame.

    Parameters
    ----------
    origin : array (3,)
        The gear frame's origin [m].
    axes : array (3, 3)
        The gear frame's axes as columns.
    """

    origin: Array
    axes: Array


def fixed() -> Placement:
    """Return the fixed frame itself, where every driver is placed."""
    return Placement(np.zeros(3), np.eye(3))


@dataclass(frozen=True)
class ToothBody(ABC):
    """One gear's solid tooth, in the gear's own frame.

    The gear's axis is z, and tooth 0 is centred on +x: at the middle of the face width for a
    cylindrical gear; a face gear's teeth point to +z. Tooth k is tooth 0 turned by 2πk/`teeth`
    about z. Side +1 is the flank that leads when the gear turns by a positive angle, side −1 the
    one that trails.

    Parameters
    ----------
    gear : HelicoidGear or FaceGear
        The gear.
    placement : Placement
        Its placement in the fixed frame.
    foot : float
        The u at which the fillet ends and the flank begins.
    """

    gear: HelicoidGear | FaceGear
    placement: Placement = field(default_factory=fixed)
    foot: float = 0.4

    @property
    @abstractmethod
    def rim(self) -> float:
        """Inner radius (external), outer radius (internal), thickness below root (face) [m]."""

    @property
    def axial_pitches(self) -> float:
        """Number of axial pitches in the whole face width (ε_β); 0 for straight teeth."""
        return 0.0

    @abstractmethod
    def outline(self, u: ArrayLike, w: ArrayLike, side: int) -> Array:
        """Return the boundary of half of tooth 0 at a width station.

        Parameters
        ----------
        u : array_like
            0 in the middle of the root space, `foot` at the end of the fillet, 1 at the tip
            corner. The curve is smooth on either side of `foot`.
        w : array_like
            Width station, 0 to 1; broadcast against `u`.
        side : {+1, −1}
            Which half.

        Returns
        -------
        array (..., 3)
            Points [m].
        """

    @abstractmethod
    def locate(self, points: Array) -> tuple[Array, Array]:
        """Return the flank coordinates (u, w) of points on any tooth's flanks, in the gear frame.

        Parameters
        ----------
        points : array (..., 3)
            Points [m]; those that do not lie on a flank are projected.

        Returns
        -------
        u, w : array (...)
            Not clipped: a point beyond the tip has u > 1.
        """

    @abstractmethod
    def margins(self, a: Array, b: Array) -> Mapping[str, Array]:
        """Return the distances [m] of flank points, at surface parameters, to the named edges."""

    def to_body(self, points: Array, rotation: Array | float) -> Array:
        """Carry points (..., 3) from the fixed frame to the gear turned by `rotation` [rad]."""
        placed: Array = (points - self.placement.origin) @ self.placement.axes
        return turned(placed, -np.asarray(rotation))


def turned(points: Array, angle: Array | float) -> Array:
    """Turn points (..., 3) about z by angles (...) [rad]."""
    x, y, z = np.moveaxis(points, -1, 0)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


def about_y(angle: float) -> Array:
    """Return the rotation matrix about y."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def about_x(angle: float) -> Array:
    """Return the rotation matrix about x."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
