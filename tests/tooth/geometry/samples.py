"""Gears for the tests of tooth geometry."""

import math

from loadshare.tooth.cylindrical.build import helicoid_pair
from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification
from loadshare.tooth.cylindrical.pair import HelicoidPair, Misalignment
from loadshare.tooth.face.build import face_gear_pair
from loadshare.tooth.face.gear import FaceGear, Shaper
from loadshare.tooth.face.pair import FaceGearPair, FaceMisalignment

RELIEVED = Modification(
    tip_relief=20e-6,
    tip_relief_length=2e-3,
    tip_relief_exponent=2,
    profile_crowning=4e-6,
    lead_crowning=10e-6,
)


def gear(teeth=24, **changes) -> HelicoidGear:
    """Return a gear of module 2 mm, 20 mm wide."""
    return HelicoidGear(**{"module": 2e-3, "teeth": teeth, "face_width": 20e-3} | changes)


def pair(
    z1=24, z2=53, ring=None, helix=0.0, off=None, modification=None, distance=None, **changes
) -> HelicoidPair:
    """Return a cylindrical pair; `ring` names the gear that is internal."""
    opposite = 1.0 if ring else -1.0
    internal = {"internal": True, "addendum": 0.8}
    driver = gear(
        z1,
        helix_angle=helix,
        modification=modification or Modification(),
        **(internal if ring == "driver" else {}) | changes,
    )
    driven = gear(z2, helix_angle=opposite * helix, **internal if ring == "driven" else {})
    return helicoid_pair(driver, driven, distance, off or Misalignment())


def face_gear(angle=90.0, inner=0.48, outer=0.56, **shaper) -> FaceGear:
    """Return a face gear of 160 teeth, shaper of 28, module 6.35 mm, pressure angle 25°."""
    data = {"module": 6.35e-3, "teeth": 28, "pressure_angle": math.radians(25.0)} | shaper
    return FaceGear(160, Shaper(**data), inner, outer, shaft_angle=math.radians(angle))


def face_pair(
    teeth=25, off=None, modification=None, angle=90.0, inner=0.48, outer=0.56
) -> FaceGearPair:
    """Return that face gear with a pinion 90 mm wide."""
    pinion = HelicoidGear(
        6.35e-3,
        teeth,
        90e-3,
        math.radians(25.0),
        tip_radius=0.3,
        modification=modification or Modification(),
    )
    return face_gear_pair(pinion, face_gear(angle, inner, outer), off or FaceMisalignment())
