"""The flank of a cylindrical gear as a surface in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification
from loadshare.tooth.geometry.body import Array
from loadshare.tooth.geometry.flank import Patch, patch


@dataclass(frozen=True)
class HelicoidFlank:
    """One side of tooth 0 of a cylindrical gear.

    The parameters are the angle of roll ξ = tan α_y and the axial coordinate ζ [m]. The involute
    unwinds from the base circle at the angle φ = s ψ_b − s σ ξ + κ ζ (s the side, σ = +1 external
    or −1 internal, κ the twist), so that

        X = r_b e_r(φ) + s σ r_b ξ e_t(φ) + ζ e_z − h n,    n = s (cos β_b e_t(φ) − sin β_b e_z),

    with h(ξ, ζ) the material taken off by the modification. Curvatures are exact with h included.

    Parameters
    ----------
    gear : HelicoidGear
        The gear.
    side : {+1, −1}
        Which flank.
    """

    gear: HelicoidGear
    side: int = 1

    def patch(self, a: Array, b: Array, turn: Array | float) -> Patch:
        """Return points of the flank at roll `a` [rad] and axial coordinate `b` [m].

        Parameters
        ----------
        a, b : array
            Surface parameters ξ and ζ, broadcast against each other.
        turn : array or float
            Angle by which the tooth has turned about z [rad].

        Returns
        -------
        Patch
            In the frame in which the gear turns.
        """
        from loadshare.tooth.geometry.compiled import helicoids

        return patch(helicoids, self.numbers, a, b, turn)

    @cached_property
    def numbers(self) -> HelicoidNumbers:
        """The flank in the form that compiled code reads."""
        gear, angle = self.gear, self.gear.base_helix_angle
        return HelicoidNumbers(
            side=float(self.side),
            kind=float(gear.kind),
            radius=gear.base_radius,
            twist=gear.twist,
            half_angle=gear.base_half_angle,
            sine=math.sin(angle),
            cosine=math.cos(angle),
            root=gear.base_radius * gear.form_roll,
            tip=gear.base_radius * gear.tip_roll,
            width=float(gear.face_width),
            taken=gear.modification,
        )


class HelicoidNumbers(NamedTuple):
    """Numbers of a flank, named as in `HelicoidGear`; sine and cosine are those of β_b.

    `root` and `tip` are lengths of roll at the ends of the profile [m], root > tip for an internal
    gear; `width` is the face width [m], the flank being −width/2 ≤ ζ ≤ width/2.
    """

    side: float
    kind: float
    radius: float
    twist: float
    half_angle: float
    sine: float
    cosine: float
    root: float
    tip: float
    width: float
    taken: Modification
