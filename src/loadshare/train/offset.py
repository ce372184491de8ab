"""Geometric errors as centre offsets (formulation, section 1).

An offset acts on approaches exactly as a displacement of the centre does, and costs no energy. An
installation error is a vector fixed in the housing, for a planet fixed on its carrier; a
manufacturing eccentricity turns with its gear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.case import Quantity
from loadshare.train.gear import Gear, Vector, transverse_frame

Angle = float | Vector


@dataclass(frozen=True, slots=True, eq=False)
class Offset:
    """Errors of one gear.

    Attributes
    ----------
    installation : ndarray, shape (3,)
        Fixed offset [m].
    eccentricity : ndarray, shape (2,)
        Offset that turns with the gear [m], before it turns, in the gear's transverse frame.
    """

    installation: Vector
    eccentricity: Vector

    def at(self, gear: Gear, rotation: Angle, frame: Angle = 0.0) -> Vector:
        """Return the offset (…, 3) [m] of a gear.

        Parameters
        ----------
        gear : Gear
        rotation : float or ndarray
            Angle by which it has turned in its sense [rad].
        frame : float or ndarray
            Angle by which the carrier from which it is seen has turned about the gear's axis [rad]:
            seen from there, a vector fixed in the housing turns backwards and one fixed on the
            carrier does not turn.
        """
        fixed = self.installation
        if gear.carrier is None and np.any(frame):
            fixed = turned_about(gear, fixed, -frame)
        if not (np.ndim(rotation) or self.eccentricity.any()):
            return fixed
        turning = turned(self.eccentricity, gear.sense * rotation - frame)
        return np.asarray(fixed + turning @ transverse_frame(gear.axis))


def turned_about(gear: Gear, vector: Vector, angle: Angle) -> Vector:
    """Return vectors (…, 3) turned about a gear's axis by angles (…) [rad]."""
    along = (vector @ gear.axis)[..., None] * gear.axis
    return np.asarray(along + turned(vector @ gear.frame.T, angle) @ gear.frame)


def turned(components: Vector, angle: Angle) -> Vector:
    """Return components (…, 2) turned counter-clockwise by angles (…) [rad]."""
    if isinstance(angle, float) and not angle:
        return components
    x, y = components[..., 0], components[..., 1]
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def polar(amount: float, direction: float) -> Vector:
    """Return the vector (2,) of a size and a direction [rad], or (S, 2) of arrays of these."""
    if not isinstance(direction, np.ndarray):
        both = amount * np.cos(direction), amount * np.sin(direction)
        return np.stack(both, axis=-1) if isinstance(amount, np.ndarray) else np.array(both)
    # NumPy finds the tangent eight times as fast as sine and cosine.
    half = np.tan(0.5 * direction)
    square = half * half
    share = amount / (1.0 + square)
    return np.stack([share * (1.0 - square), 2.0 * half * share], axis=-1)


def vector_of(lengths: tuple[Quantity, ...]) -> Vector:
    """Return three components; the last is 0 if it is not given."""
    components = [*(q.si for q in lengths), 0.0][:3]
    return np.stack(np.broadcast_arrays(*components), axis=-1)
