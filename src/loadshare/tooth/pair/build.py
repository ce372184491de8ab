"""From what a pair file says to two gears in mesh, in SI."""

from __future__ import annotations

from typing import Any

from loadshare.tooth.cylindrical.build import helicoid_pair
from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification
from loadshare.tooth.cylindrical.pair import HelicoidPair, Misalignment
from loadshare.tooth.face.build import face_gear_pair
from loadshare.tooth.face.gear import FaceGear, Shaper
from loadshare.tooth.face.pair import FaceGearPair, FaceMisalignment
from loadshare.tooth.pair.model import Cylindrical, FaceGearContent, HelicoidContent


def built(content: HelicoidContent | FaceGearContent) -> HelicoidPair | FaceGearPair:
    """Put the two gears of a pair file in mesh.

    Parameters
    ----------
    content : HelicoidContent or FaceGearContent

    Raises
    ------
    CaseError
        With everything that is wrong with the gears or with their mesh.
    """
    return _helicoid(content) if isinstance(content, HelicoidContent) else _face(content)


def _helicoid(content: HelicoidContent) -> HelicoidPair:
    helices: dict[str, Any] = {
        "helices": content.helices,
        "helix_gap": content.helix_gap.si if content.helices == 2 else 0.0,
    }
    driver = _gear(content.driver, helices)
    kind = -1 if content.driver.internal != content.driven.internal else 1
    # What the driven gear leaves out is what fits its driver.
    fitting = {
        "module": driver.module,
        "pressure_angle": driver.pressure_angle,
        "helix_angle": -kind * driver.helix_angle,
    }
    driven = _gear(content.driven, fitting | helices)
    distance = content.centre_distance
    return helicoid_pair(
        driver, driven, distance.si if distance else None, Misalignment(**_si(content.misalignment))
    )


def _face(content: FaceGearContent) -> FaceGearPair:
    pinion, said = _gear(content.driver, {}), content.driven
    cutter = said.shaper
    shift = pinion.profile_shift if cutter.profile_shift is None else cutter.profile_shift
    shaper = Shaper(pinion.module, cutter.teeth, pinion.pressure_angle, shift, cutter.addendum)
    gear = FaceGear(**(_si(said) | {"shaper": shaper}))
    return face_gear_pair(pinion, gear, FaceMisalignment(**_si(content.misalignment)))


def _gear(said: Cylindrical, fitting: dict[str, Any]) -> HelicoidGear:
    """A gear; `fitting` gives what it leaves out."""
    values = _si(said)
    values["modification"] = Modification(**values["modification"])
    return HelicoidGear(**(fitting | values))


def _si(element: Any) -> dict[str, Any]:
    """The values of an element in SI units, without what it leaves out."""
    found: dict[str, Any] = element.model_dump(mode="json", exclude_none=True, context="SI")
    return found
