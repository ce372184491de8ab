"""Putting a pinion and a face gear in mesh, with every limit told."""

from __future__ import annotations

import math

from loadshare.errors import CaseError, Problem
from loadshare.tooth.cylindrical.checks import gear_problems
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.face.gear import FaceGear, Shaper
from loadshare.tooth.face.limits import pointing_limit, undercut_limit
from loadshare.tooth.face.pair import FaceGearPair, FaceMisalignment
from loadshare.tooth.geometry.involute import inv
from loadshare.tooth.geometry.partners import Demand, misfits, same
from loadshare.tooth.unloaded.meeting import meeting_problems
from loadshare.tooth.words import degrees, millimetres, plain, problem


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
        How far the pair is off.

    Returns
    -------
    FaceGearPair
        A pair without undercut, pointed teeth or interference.

    Raises
    ------
    CaseError
        With everything that is wrong with the gears or with their mesh.
    """
    problems = gear_problems(pinion, "driver") + _value_problems(gear)
    if not problems:
        problems = _partner_problems(pinion, gear)
    if not problems:
        problems = _limit_problems(gear)
        pair = FaceGearPair(pinion, gear, misalignment or FaceMisalignment())
        problems += _mesh_problems(pair)
    if not problems:
        problems = meeting_problems(pair, pair.misalignment)
    if problems:
        raise CaseError(problems)
    return pair


def _value_problems(gear: FaceGear) -> list[Problem]:
    shaper: Shaper = gear.shaper
    fits = shaper.addendum > -gear.addendum
    checks = (
        ("teeth", gear.teeth >= 4, str(gear.teeth), "a whole number, 4 or more"),
        ("inner", gear.inner > 0.0, millimetres(gear.inner), "more than 0"),
        (
            "outer",
            gear.outer > gear.inner,
            millimetres(gear.outer),
            f"more than the inner end, {millimetres(gear.inner)}",
        ),
        (
            "shaft_angle",
            math.radians(30.0) < gear.shaft_angle < math.radians(150.0),
            degrees(gear.shaft_angle),
            "between 30 and 150 deg",
        ),
        ("addendum", fits, plain(gear.addendum), "a tip above the root"),
        ("rim", gear.rim_thickness > 0.0, millimetres(gear.rim_thickness), "more than 0"),
        ("youngs_modulus", gear.youngs_modulus > 0.0, plain(gear.youngs_modulus), "more than 0"),
        ("poisson", 0.0 <= gear.poisson < 0.5, plain(gear.poisson), "from 0 to below 0.5"),
        ("shaper.module", shaper.module > 0.0, millimetres(shaper.module), "more than 0"),
        ("shaper.teeth", shaper.teeth >= 4, str(shaper.teeth), "a whole number, 4 or more"),
        (
            "shaper.pressure_angle",
            0.0 < shaper.pressure_angle < math.radians(45.0),
            degrees(shaper.pressure_angle),
            "between 0 and 45 deg",
        ),
    )
    found = [
        problem(f"driven.{name}", given, "this value makes no face gear", allowed)
        for name, fine, given, allowed in checks
        if not fine
    ]
    if found:
        return found
    if shaper.tip <= shaper.base_radius or shaper.tip_half_angle < 0.0:
        found.append(
            problem(
                "driven.shaper.addendum",
                plain(shaper.addendum),
                "the shaper's teeth are pointed below this tip, or lie inside its base circle",
                "a smaller addendum or profile shift of the shaper",
            )
        )
    if gear.axial_scale <= 0.0:
        found.append(
            problem(
                "driven.shaft_angle",
                degrees(gear.shaft_angle),
                "shaper and gear do not roll on each other at this angle",
                f"more than {degrees(math.acos(min(1.0, 1.0 / gear.roll_ratio)))}",
            )
        )
    return found


def _partner_problems(pinion: HelicoidGear, gear: FaceGear) -> list[Problem]:
    shaper = gear.shaper
    demands = (
        Demand("internal", not pinion.internal, "true", "false: only an external pinion drives"),
        Demand("helix_angle", pinion.helix_angle == 0.0, degrees(pinion.helix_angle), "0 deg"),
        Demand("helices", pinion.helices == 1, str(pinion.helices), "1"),
        same("module", pinion.module, shaper.module, millimetres, "shaper"),
        same("pressure_angle", pinion.pressure_angle, shaper.pressure_angle, degrees, "shaper"),
        Demand(
            "teeth",
            pinion.teeth <= shaper.teeth,
            str(pinion.teeth),
            f"at most as many as the shaper, {shaper.teeth}",
        ),
    )
    found = misfits("driver", "the pinion does not fit the face gear", demands)
    return found or _shift_problems(pinion, shaper)


def _shift_problems(pinion: HelicoidGear, shaper: Shaper) -> list[Problem]:
    teeth = shaper.teeth - pinion.teeth
    excess = pinion.profile_shift - shaper.profile_shift
    if teeth == 0:
        fits = excess <= 1e-12
        largest = shaper.profile_shift
    else:
        slope = math.tan(shaper.pressure_angle)
        room = 0.5 * teeth * inv(shaper.pressure_angle) / slope
        fits = excess < room
        largest = shaper.profile_shift + room
    if fits:
        return []
    return [
        problem(
            "driver.profile_shift",
            plain(pinion.profile_shift),
            "the pinion's teeth are too thick for the spaces that the shaper has cut",
            f"{'at most' if teeth == 0 else 'less than'} {plain(largest)}",
            "Give the shaper the same profile shift.",
        )
    ]


def _limit_problems(gear: FaceGear) -> list[Problem]:
    found = []
    undercut, pointed = undercut_limit(gear), pointing_limit(gear)
    if gear.inner < undercut:
        found.append(
            problem(
                "driven.inner",
                millimetres(gear.inner),
                "the shaper's tip undercuts the teeth at the inner end",
                f"at least L1 = {millimetres(undercut)}",
                "A smaller addendum of the shaper lowers this limit.",
            )
        )
    if gear.outer > pointed:
        found.append(
            problem(
                "driven.outer",
                millimetres(gear.outer),
                "the teeth are pointed at the outer end",
                f"at most L2 = {millimetres(pointed)}",
                "A smaller addendum of the gear raises this limit.",
            )
        )
    return found


def _mesh_problems(pair: FaceGearPair) -> list[Problem]:
    found = []
    pinion, gear, shaper = pair.pinion, pair.gear, pair.gear.shaper
    contact, half = pair.contact_length, 0.5 * pair.pinion.face_width
    if not gear.inner < contact < gear.outer:
        end = "inner" if contact <= gear.inner else "outer"
        found.append(
            problem(
                f"driven.{end}",
                millimetres(getattr(gear, end)),
                "the ideal pair's point of contact lies beyond this end of the teeth",
                f"{'less' if end == 'inner' else 'more'} than {millimetres(contact)}",
            )
        )
    elif abs(contact - pair.middle) >= half:
        found.append(
            problem(
                "driver.face_width",
                millimetres(pinion.face_width),
                "the ideal pair's point of contact lies beyond the end of the pinion",
                f"more than {millimetres(2.0 * abs(contact - pair.middle))}",
                "Or choose inner and outer end so that their middle is nearer the contact.",
            )
        )
    deepest = pair.shaper_roll(pinion.tip_roll)
    if deepest > shaper.tip_roll or pair.axis_distance + pinion.tip >= shaper.tip:
        roll = pair.pinion_roll(shaper.tip_roll)
        tip = min(pinion.base_radius * math.hypot(1.0, roll), shaper.tip - pair.axis_distance)
        largest = (tip - pinion.radius) / pinion.module - pinion.profile_shift
        found.append(
            problem(
                "driver.addendum",
                plain(pinion.addendum),
                "the tip of the pinion cuts into the root of the face gear",
                f"less than {plain(largest)} with the shaper's addendum",
                "A larger addendum of the shaper makes room.",
            )
        )
    if pair.first_roll < pinion.form_roll - 1e-9:
        roll = max(pair.shaper_roll(pinion.form_roll), 0.0)
        depth = shaper.base_radius * (
            math.cos(pair.working_angle) + roll * math.sin(pair.working_angle)
        )
        found.append(
            problem(
                "driven.addendum",
                plain(gear.addendum),
                "the tip of the face gear cuts into the root fillet of the pinion",
                f"less than about {plain((shaper.radius - depth) / shaper.module)}",
            )
        )
    if not found and pair.contact_ratio < 1.0:
        found.append(
            problem(
                "driver.addendum",
                plain(pinion.addendum),
                f"the contact ratio is {pair.contact_ratio:.3f}: "
                "at some positions no teeth are in contact",
                "a contact ratio of 1 or more",
                "Larger addenda of pinion, gear and shaper raise it.",
            )
        )
    return found
