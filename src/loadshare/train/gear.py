"""A gear as a body: where it is, how it turns, what holds it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array

Vector = NDArray[np.float64]

ORIGIN: Vector = np.zeros(3)
ORIGIN.flags.writeable = False


def cross(first: Vector, second: Vector) -> Vector:
    """Return the cross product of two vectors (3,): as `numpy.cross`, in a tenth of the time."""
    a, b, c = first.tolist()
    p, q, r = second.tolist()
    return np.array([b * r - c * q, c * p - a * r, a * q - b * p])


def transverse_frame(axis: Vector, turned: float = 0.0) -> Array:
    """Return two unit vectors (2, 3) that span the plane across `axis`, right-handed about it.

    The first is the global x direction projected into the plane; y for a gear whose axis is x
    itself. For an axis along z the frame is the global x, y. Both are then turned about the axis by
    `turned` [rad]. Gears with the same axis share the array.
    """
    return _frame_across(tuple(axis.tolist()), turned)


@lru_cache(maxsize=256)
def _frame_across(along: tuple[float, ...], turned: float) -> Array:
    axis, seed = np.array(along), np.array([1.0, 0.0, 0.0])
    if abs(axis @ seed) > 1.0 - 1e-9:
        seed = np.array([0.0, 1.0, 0.0])
    first = seed - (seed @ axis) * axis
    first /= np.linalg.norm(first)
    frame = np.array([first, cross(axis, first)])
    if turned:
        c, s = np.cos(turned), np.sin(turned)
        frame = np.array([[c, s], [-s, c]]) @ frame
    frame.flags.writeable = False
    return frame


@dataclass(frozen=True, slots=True, eq=False)
class Gear:
    """One gear of a train.

    Attributes
    ----------
    name : str
    kind : str
        "external", "internal", "face", "carrier" or "harmonic".
    centre : ndarray, shape (3,)
        O [m].
    axis : ndarray, shape (3,)
        Unit vector.
    frame : ndarray, shape (2, 3)
        Unit vectors of the transverse plane, along which a support's stiffness is given: those of
        `plane`, or turned to the directions of largest and smallest stiffness.
    base_radius : float
        r_b [m]; the acting radius of a face gear, the distance of a carrier's outermost pin.
    sense : int
        Sense in which its rotation is counted: +1 if counter-clockwise seen against its axis, −1
        otherwise. It is the running sense, for a planet as seen from its carrier.
    teeth : float or None
        Number of teeth, given or derived from those of gears that it meshes with; None if unknown.
    support : ndarray, shape (2,), or None
        Stiffness along the frame's directions [N/m]; zeros for a free gear, None for a rigid
        bearing.
    ratio : float
        Speed along its sense over the input gear's speed.
    relative : float
        The same as seen from the carrier about which it turns; the ratio outside planetary sets.
    held : bool
        Whether the housing keeps it from turning; the output is held by the load instead.
    carrier : str or None
        Carrier on whose pin it rides.
    pin_motion : ndarray, shape (3,)
        How far its pin moves per rotation of the carrier [m].
    frame_of : str or None
        Carrier in whose frame it is described: that of the planets with which it meshes, its own,
        or itself.
    rim_of : str or None
        Internal gear of whose rim it is a harmonic: not a body but a bending mode of that rim. Its
        displacement holds the amplitudes of cos nψ and sin nψ.
    harmonic : int
        n.
    seen_at : float
        Angle by which `plane` has turned [rad], if the gear is placed in the frame of the housing
        and its components are given in that of a turning carrier (see `placed.py`).
    """

    name: str
    kind: str
    centre: Vector
    axis: Vector
    frame: Array
    base_radius: float
    sense: int
    teeth: float | None
    support: Vector | None
    ratio: float
    relative: float = 1.0
    held: bool = False
    carrier: str | None = None
    pin_motion: Vector = field(default_factory=lambda: ORIGIN)
    frame_of: str | None = None
    rim_of: str | None = None
    harmonic: int = 0
    seen_at: float = 0.0

    @property
    def plane(self) -> Array:
        """Unit vectors of the transverse plane, shape (2, 3), along which components are given."""
        return transverse_frame(self.axis, self.seen_at)

    @property
    def is_tilted(self) -> bool:
        """Whether `frame` differs from `plane`."""
        # The same object, unless the gear was pickled.
        plane = self.plane
        return self.frame is not plane and not np.array_equal(self.frame, plane)

    def in_plane(self, components: Vector) -> Vector:
        """Convert components (2,) along `frame` into those along `plane`."""
        return components @ self.frame @ self.plane.T if self.is_tilted else components

    @property
    def running(self) -> int:
        """Sense in which it runs in the housing, 0 if it does not turn."""
        return self.sense * ((self.ratio > 0.0) - (self.ratio < 0.0))

    @property
    def moves(self) -> bool:
        """Whether the centre can be displaced."""
        return self.support is not None

    @property
    def floats(self) -> bool:
        """Whether no bearing holds the centre."""
        return self.support is not None and not self.support.any()
