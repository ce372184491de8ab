"""The gears of a pair, by the keys with which a case states them."""

from __future__ import annotations

import math
from typing import Any, Literal

from loadshare.case.element import Element
from loadshare.case.quantity import Angle
from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.cylindrical.pair import HelicoidPair
from loadshare.tooth.face.pair import FaceGearPair
from loadshare.tooth.pair.model import Amount, Number, Size, Steep, Teeth


class PairGear(Element):
    """One of the two gears; a face gear has neither module nor face width."""

    type: Literal["external", "internal", "face"]
    """Kind of teeth."""

    teeth: Teeth
    """Number of teeth [-]."""

    base_radius: Size
    """Base radius; for a face gear, the acting radius [length]."""

    module: Size | None = None
    """Normal module [length]."""

    pressure_angle: Steep | None = None
    """Normal pressure angle [angle]."""

    helix_angle: Angle | None = None
    """Helix angle, positive for a right-hand helix [angle]; for a herringbone gear, that of either
    half, with either sign."""

    profile_shift: Number | None = None
    """Profile shift coefficient [-]."""

    addendum: Number | None = None
    """Height of the tooth above the datum line, in modules [-]."""

    dedendum: Number | None = None
    """Depth of the tooth below the datum line, in modules [-]."""

    tip_radius: Number | None = None
    """Tip radius of the generating rack, in modules [-]."""

    face_width: Size | None = None
    """Face width; for a herringbone gear, that of both halves [length]."""


class PairGears(Element):
    """Both gears and their line of action."""

    working_angle: Steep
    """Transverse working pressure angle [angle]."""

    base_helix_angle: Angle
    """Base helix angle, without its sign [angle]."""

    shaft_angle: Steep | None = None
    """Angle between the axes of a face-gear pair, if not a right angle [angle]."""

    helices: Literal[1, 2] = 1
    """2 for a herringbone pair [-]."""

    helix_gap: Amount | None = None
    """Gap between the halves of a herringbone pair [length]."""

    driver: PairGear
    """The driving gear."""

    driven: PairGear
    """The driven gear."""


def gears_of(pair: HelicoidPair | FaceGearPair) -> PairGears:
    """Return the gears of a pair as data.

    Parameters
    ----------
    pair : HelicoidPair or FaceGearPair
    """
    gear = pair.driver.gear
    found: dict[str, Any] = {
        "working_angle": _degrees(pair.working_angle),
        "base_helix_angle": _degrees(abs(gear.base_helix_angle)),
        "driver": _cylindrical(gear),
    }
    if isinstance(pair, FaceGearPair):
        radius = gear.base_radius * pair.ratio
        driven = {
            "type": "face",
            "teeth": pair.gear.teeth,
            "base_radius": _millimetres(radius),
        }
        if abs(pair.gear.shaft_angle - 0.5 * math.pi) > TEETH.angle:
            found["shaft_angle"] = _degrees(pair.gear.shaft_angle)
    else:
        driven = _cylindrical(pair.driven_gear)
        if gear.helices == 2:
            found |= {"helices": 2, "helix_gap": _millimetres(gear.helix_gap)}
    return PairGears.model_validate(found | {"driven": driven})


def _cylindrical(gear: HelicoidGear) -> dict[str, Any]:
    same = ("teeth", "profile_shift", "addendum", "dedendum", "tip_radius")
    return {
        "type": gear.shape,
        "base_radius": _millimetres(gear.base_radius),
        "module": _millimetres(gear.module),
        "pressure_angle": _degrees(gear.pressure_angle),
        "helix_angle": _degrees(gear.helix_angle),
        "face_width": _millimetres(gear.helices * gear.face_width),
        **{key: getattr(gear, key) for key in same},
    }


def _millimetres(length: float) -> str:
    return f"{1e3 * length:.9g} mm"


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle) + 0.0:.9g} deg"
