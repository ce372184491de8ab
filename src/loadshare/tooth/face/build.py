"""Construction of pairs of pinion and face gear, with every violated limit reported."""

from __future__ import annotations

import math
from collections.abc import Iterator

from loadshare.errors import Problem
from loadshare.involute import inv
from loadshare.settings import ALLOWED, TEETH
from loadshare.tooth.cylindrical.checks import (
    elasticity_checks,
    gear_problems,
    pressure_angle_check,
    value_problems,
)
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.face.flank import NoLimitError, pointing_limit, undercut_limit
from loadshare.tooth.face.gear import FaceGear, Shaper
from loadshare.tooth.face.pair import FaceGearPair, FaceMisalignment
from loadshare.tooth.problems import (
    Check,
    degrees,
    digits,
    down,
    failed,
    millimetres,
    problem,
    refuse,
    same,
    up,
)
from loadshare.tooth.unloaded.positions import meeting_problems, ratio_problems


def face_gear_pair(
    pinion: HelicoidGear, gear: FaceGear, misalignment: FaceMisalignment | None = None
) -> FaceGearPair:
    """Put a spur pinion in mesh with a face gear that it drives.

    Parameters
    ----------
    pinion : HelicoidGear
        An external spur gear with at most as many teeth as the shaper. With fewer, contact is
        localised; with as many it is along a line, and sensitive to misalignment.
    gear : FaceGear
        The face gear.
    misalignment : FaceMisalignment, optional
        Misalignment of the pair.

    Returns
    -------
    FaceGearPair
        A pair without undercut, pointed teeth or interference.

    Raises
    ------
    CaseError
        If the gears or their mesh have problems; it lists all of them.
    """
    none = "no face gear can have this value"
    refuse(value_problems(pinion, "driver") + failed("driven", none, _values(gear)))
    found = [*gear_problems(pinion, "driver"), *_partner_problems(pinion, gear.shaper)]
    refuse([*found, *_shaper_problems(gear)])
    pair = FaceGearPair(pinion, gear, misalignment or FaceMisalignment())
    try:
        found = list(_contact_problems(pair))
        if not found:
            found += ratio_problems(pair, "Larger addenda of pinion, gear and shaper raise it.")
        refuse((*_limit_problems(gear), *found))
    except NoLimitError:
        what = "the shaper cuts no teeth with this addendum"
        refuse([problem("driven.addendum", gear.addendum, what, "a smaller one")])
    refuse(meeting_problems(pair))
    return pair


def _values(gear: FaceGear) -> Iterator[Check]:
    shaper, rim = gear.shaper, gear.rim_thickness
    low, high = math.radians(30.0), math.radians(150.0)
    yield "teeth", gear.teeth, gear.teeth >= 4, "a whole number, 4 or more"
    yield "inner", gear.inner, gear.inner > 0.0, "more than 0"
    beyond = f"more than the inner end, {millimetres(gear.inner)}"
    yield "outer", gear.outer, gear.outer > gear.inner, beyond
    yield "shaft_angle", gear.shaft_angle, low < gear.shaft_angle < high, "between 30 and 150 deg"
    yield "addendum", gear.addendum, shaper.addendum > -gear.addendum, "a tip above the root"
    # The deeper a body, the more harmonics its model sums.
    deepest = ALLOWED.shape * shaper.module
    yield "rim", rim, 0.0 < rim <= deepest, f"more than 0, up to {millimetres(deepest, down)}"
    yield from elasticity_checks(gear.youngs_modulus, gear.poisson)
    yield "shaper.module", shaper.module, shaper.module > 0.0, "more than 0"
    yield "shaper.teeth", shaper.teeth, shaper.teeth >= 4, "a whole number, 4 or more"
    yield pressure_angle_check("shaper.pressure_angle", shaper.pressure_angle)


def _shaper_problems(gear: FaceGear) -> Iterator[Problem]:
    shaper = gear.shaper
    if shaper.tip <= shaper.base_radius or shaper.tip_half_angle < 0.0:
        what = "the shaper's teeth become pointed below this tip, or lie inside its base circle"
        allowed = "a smaller addendum or profile shift of the shaper"
        yield problem("driven.shaper.addendum", shaper.addendum, what, allowed)
    if gear.axial_scale <= 0.0:
        what = "shaper and gear do not roll on each other at this angle"
        allowed = f"more than {degrees(math.acos(min(1.0, 1.0 / gear.roll_ratio)), up)}"
        yield problem("driven.shaft_angle", gear.shaft_angle, what, allowed)


def _partner_problems(pinion: HelicoidGear, shaper: Shaper) -> list[Problem]:
    few = f"at most as many as the shaper, {shaper.teeth}"
    checks: tuple[Check, ...] = (
        ("internal", "true", not pinion.internal, "false: only an external pinion drives"),
        ("helix_angle", pinion.helix_angle, pinion.helix_angle == 0.0, "0 deg"),
        ("helices", pinion.helices, pinion.helices == 1, "1"),
        same("module", pinion.module, shaper.module, "shaper"),
        same("pressure_angle", pinion.pressure_angle, shaper.pressure_angle, "shaper"),
        ("teeth", pinion.teeth, pinion.teeth <= shaper.teeth, few),
    )
    found = failed("driver", "the pinion does not fit the face gear", checks)
    return found or list(_shift_problems(pinion, shaper))


def _shift_problems(pinion: HelicoidGear, shaper: Shaper) -> Iterator[Problem]:
    teeth = shaper.teeth - pinion.teeth
    excess = pinion.profile_shift - shaper.profile_shift
    room = 0.5 * teeth * inv(shaper.pressure_angle) / math.tan(shaper.pressure_angle)
    if not (excess <= TEETH.fits if teeth == 0 else excess < room):
        largest = digits(down(shaper.profile_shift + room))
        what = "the pinion's teeth are too thick for the spaces that the shaper has cut"
        allowed = f"{'at most' if teeth == 0 else 'less than'} {largest}"
        hint = "Give the shaper the same profile shift."
        yield problem("driver.profile_shift", pinion.profile_shift, what, allowed, hint)


def _limit_problems(gear: FaceGear) -> Iterator[Problem]:
    undercut, pointed = undercut_limit(gear), pointing_limit(gear)
    if gear.inner < undercut:
        what = "the shaper's tip undercuts the teeth at the inner end"
        allowed = f"at least L1 = {millimetres(undercut, up)}"
        hint = "A smaller addendum of the shaper lowers this limit."
        yield problem("driven.inner", gear.inner, what, allowed, hint)
    if gear.outer > pointed:
        what = "the teeth are pointed at the outer end"
        allowed = f"at most L2 = {millimetres(pointed, down)}"
        hint = "A smaller addendum of the gear raises this limit."
        yield problem("driven.outer", gear.outer, what, allowed, hint)


def _contact_problems(pair: FaceGearPair) -> Iterator[Problem]:
    pinion, gear, shaper = pair.pinion, pair.gear, pair.gear.shaper
    contact, beside = pair.contact_length, abs(pair.contact_length - pair.gear.pitch_radius)
    if not gear.inner < contact < gear.outer:
        inside = contact <= gear.inner
        end, more, to = ("inner", "less", down) if inside else ("outer", "more", up)
        beyond = "the ideal pair's point of contact lies beyond this end of the teeth"
        allowed = f"{more} than {millimetres(contact, to)}"
        yield problem(f"driven.{end}", getattr(gear, end), beyond, allowed)
    elif beside >= 0.5 * pinion.face_width:
        what = "the ideal pair's point of contact lies beyond the end of the pinion"
        allowed = f"more than {millimetres(2.0 * beside, up)}"
        hint = "Or choose inner and outer so that their middle is nearer to the contact."
        yield problem("driver.face_width", pinion.face_width, what, allowed, hint)
    deepest = pair.shaper_roll(pinion.tip_roll)
    if deepest > shaper.tip_roll or pair.axis_distance + pinion.tip >= shaper.tip:
        roll = pair.pinion_roll(shaper.tip_roll)
        tip = min(pinion.base_radius * math.hypot(1.0, roll), shaper.tip - pair.axis_distance)
        what = "the tip of the pinion cuts into the root of the face gear"
        allowed = f"less than {digits(down(pinion.addendum_to(tip)))} with the shaper's addendum"
        hint = "A larger addendum of the shaper makes room."
        yield problem("driver.addendum", pinion.addendum, what, allowed, hint)
    if pair.roll_range[0] < pinion.form_roll - TEETH.fits:
        depth = pair.depth(pair.shaper_roll(pinion.form_roll))
        what = "the tip of the face gear cuts into the root fillet of the pinion"
        allowed = f"at most {digits(down((shaper.radius - depth) / shaper.module))}"
        yield problem("driven.addendum", gear.addendum, what, allowed)
