"""What can be wrong with a cylindrical gear, each told with the dimension that causes it."""

from __future__ import annotations

import math

from loadshare.errors import Problem
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.cylindrical.root import fillet_angle, rack_tip_half_width
from loadshare.tooth.geometry.involute import inverse_inv
from loadshare.tooth.words import degrees, millimetres, plain, problem


def gear_problems(gear: HelicoidGear, key: str) -> list[Problem]:
    """Everything that is wrong with one gear, keys below `key`."""
    return _value_problems(gear, key) or _tooth_problems(gear, key)


def _value_problems(gear: HelicoidGear, key: str) -> list[Problem]:
    m = gear.modification
    checks = (
        ("module", gear.module > 0.0, millimetres(gear.module), "more than 0"),
        ("teeth", gear.teeth >= 4, str(gear.teeth), "a whole number, 4 or more"),
        ("face_width", gear.face_width > 0.0, millimetres(gear.face_width), "more than 0"),
        (
            "pressure_angle",
            0.0 < gear.pressure_angle < math.radians(45.0),
            degrees(gear.pressure_angle),
            "between 0 and 45 deg",
        ),
        (
            "helix_angle",
            abs(gear.helix_angle) < math.radians(60.0),
            degrees(gear.helix_angle),
            "between −60 and 60 deg",
        ),
        (
            "addendum",
            gear.addendum > -gear.dedendum,
            plain(gear.addendum),
            "a tip above the root: addendum + dedendum more than 0",
        ),
        ("tip_radius", gear.tip_radius >= 0.0, plain(gear.tip_radius), "0 or more"),
        ("helices", gear.helices in (1, 2), str(gear.helices), "1, or 2 for a herringbone gear"),
        ("helix_gap", gear.helix_gap >= 0.0, millimetres(gear.helix_gap), "0 or more"),
        ("youngs_modulus", gear.youngs_modulus > 0.0, plain(gear.youngs_modulus), "more than 0"),
        ("poisson", 0.0 <= gear.poisson < 0.5, plain(gear.poisson), "from 0 to below 0.5"),
        (
            "modification.tip_relief_exponent",
            m.tip_relief_exponent in (1, 2),
            str(m.tip_relief_exponent),
            "1 (linear) or 2 (parabolic)",
        ),
        (
            "modification.tip_relief_length",
            not m.tip_relief or m.tip_relief_length > 0.0,
            millimetres(m.tip_relief_length),
            "more than 0 where there is tip relief",
        ),
        (
            "modification.end_relief_length",
            not m.end_relief or 0.0 < m.end_relief_length <= 0.5 * gear.face_width,
            millimetres(m.end_relief_length),
            f"more than 0 and at most half the face width, {millimetres(0.5 * gear.face_width)}",
        ),
    )
    found = [
        problem(f"{key}.{name}", given, "this value makes no gear", allowed)
        for name, fine, given, allowed in checks
        if not fine
    ]
    for name in ("tip_relief", "profile_crowning", "lead_crowning", "end_relief"):
        amount = getattr(m, name)
        if not 0.0 <= amount <= 0.1 * abs(gear.module):
            found.append(
                problem(
                    f"{key}.modification.{name}",
                    millimetres(amount),
                    "not an amount of material taken off",
                    f"from 0 to a tenth of the module, {millimetres(0.1 * gear.module)}",
                )
            )
    return found


def _tooth_problems(gear: HelicoidGear, key: str) -> list[Problem]:
    found = _internal_problems(gear, key) if gear.internal else _external_problems(gear, key)
    inside = 0.0 < gear.rim_radius < gear.root if gear.kind > 0 else gear.rim_radius > gear.root
    if not inside:
        side = "above 0 and below" if gear.kind > 0 else "above"
        found.append(
            problem(
                f"{key}.rim",
                millimetres(gear.rim_radius),
                "no body is left below the teeth",
                f"{side} the root radius, {millimetres(gear.root)}",
            )
        )
    return found


def _external_problems(gear: HelicoidGear, key: str) -> list[Problem]:
    found = []
    slope = math.tan(gear.pressure_angle)
    if rack_tip_half_width(gear) < 0.0:
        room = math.pi / 4 - gear.dedendum * slope
        largest = room / (1.0 / math.cos(gear.pressure_angle) - slope)
        found.append(
            problem(
                f"{key}.tip_radius",
                plain(gear.tip_radius),
                "the tip of the generating rack has no room for this radius",
                f"at most {plain(largest)} with this dedendum",
            )
        )
    if gear.profile_shift < gear.least_profile_shift - 1e-12:
        found.append(
            problem(
                f"{key}.profile_shift",
                plain(gear.profile_shift),
                "the generating rack undercuts the teeth",
                f"at least {gear.least_profile_shift:.4f} with {gear.teeth} teeth",
                "A smaller dedendum, a larger tip radius or more teeth help too.",
            )
        )
    if gear.tip <= gear.base_radius:
        least = (gear.base_radius - gear.radius) / gear.module - gear.profile_shift
        found.append(
            problem(
                f"{key}.addendum",
                plain(gear.addendum),
                "the tip lies inside the base circle",
                f"more than {plain(least)}",
            )
        )
    elif gear.base_half_angle <= 0.0 or gear.half_angle(gear.tip) <= 0.0:
        largest = -math.inf
        if gear.base_half_angle > 0.0:
            pointed = gear.base_radius / math.cos(inverse_inv(gear.base_half_angle))
            largest = (pointed - gear.radius) / gear.module - gear.profile_shift
        found.append(
            problem(
                f"{key}.addendum",
                plain(gear.addendum),
                "the teeth are pointed below this tip",
                f"less than {plain(largest)} with this profile shift",
                "A smaller profile shift helps too.",
            )
        )
    return found


def _internal_problems(gear: HelicoidGear, key: str) -> list[Problem]:
    found = []
    if gear.tip < gear.base_radius:
        largest = (gear.radius - gear.base_radius) / gear.module - gear.profile_shift
        found.append(
            problem(
                f"{key}.addendum",
                plain(gear.addendum),
                "the tips reach inside the base circle, where there is no involute",
                f"at most {plain(largest)}",
            )
        )
    elif gear.half_angle(gear.tip) <= 0.0:
        found.append(
            problem(
                f"{key}.addendum",
                plain(gear.addendum),
                "the teeth are pointed below this tip",
                "a smaller addendum or a larger profile shift",
            )
        )
    fits = (
        gear.root - gear.tip_radius * gear.module > gear.base_radius
        and fillet_angle(gear) <= math.pi / gear.teeth
        and gear.base_radius * math.hypot(1.0, gear.form_roll) > gear.tip
    )
    if not fits:
        found.append(
            problem(
                f"{key}.tip_radius",
                plain(gear.tip_radius),
                "the tooth space has no room for this root radius",
                "a smaller tip radius, or a larger dedendum",
            )
        )
    return found
