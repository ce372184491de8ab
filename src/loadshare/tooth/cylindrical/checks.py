"""Checks of a cylindrical gear; each problem names the dimension that causes it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from loadshare.errors import Problem
from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.body import fillet_angle, rack_tip_half_width
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.problems import Check, digits, down, failed, millimetres, problem, up


def value_problems(gear: HelicoidGear, key: str) -> list[Problem]:
    """Return the values that no gear can have, each checked alone."""
    found = failed(key, "no gear can have this value", _values(gear))
    return found + failed(key, "is not a possible amount of material to take off", _amounts(gear))


def _values(gear: HelicoidGear) -> Iterator[Check]:
    m = gear.modification
    steep, steepest = abs(gear.helix_angle), math.radians(60.0)
    height, half_width = gear.addendum + gear.dedendum, 0.5 * gear.face_width
    yield "module", gear.module, gear.module > 0.0, "more than 0"
    yield "teeth", gear.teeth, gear.teeth >= 4, "a whole number, 4 or more"
    yield "face_width", gear.face_width, gear.face_width > 0.0, "more than 0"
    yield pressure_angle_check("pressure_angle", gear.pressure_angle)
    yield "helix_angle", gear.helix_angle, steep < steepest, "between −60 and 60 deg"
    above = "a tip above the root: addendum + dedendum more than 0"
    yield "addendum", gear.addendum, height > 0.0, above
    yield "tip_radius", gear.tip_radius, gear.tip_radius >= 0.0, "0 or more"
    yield "helices", gear.helices, gear.helices in (1, 2), "1, or 2 for a herringbone gear"
    yield "helix_gap", gear.helix_gap, gear.helix_gap >= 0.0, "0 or more"
    yield from elasticity_checks(gear.youngs_modulus, gear.poisson)
    known = m.tip_relief_exponent in (1, 2)
    exponents = "1 (linear) or 2 (parabolic)"
    yield "modification.tip_relief_exponent", m.tip_relief_exponent, known, exponents
    fits = not m.tip_relief or m.tip_relief_length > 0.0
    relieved = "more than 0 if there is tip relief"
    yield "modification.tip_relief_length", m.tip_relief_length, fits, relieved
    fits = not m.end_relief or 0.0 < m.end_relief_length <= half_width
    short = f"more than 0 and at most half the face width, {millimetres(half_width)}"
    yield "modification.end_relief_length", m.end_relief_length, fits, short


def pressure_angle_check(name: str, angle: float) -> Check:
    """Check that a pressure angle [rad] is possible for involute teeth."""
    return name, angle, 0.0 < angle < math.radians(45.0), "between 0 and 45 deg"


def elasticity_checks(youngs_modulus: float, poisson: float) -> Iterator[Check]:
    """Check the elastic constants of a gear of any kind."""
    yield "youngs_modulus", youngs_modulus, youngs_modulus > 0.0, "more than 0"
    yield "poisson", poisson, 0.0 <= poisson < 0.5, "from 0 to below 0.5"


def _amounts(gear: HelicoidGear) -> Iterator[Check]:
    largest = 0.1 * abs(gear.module)
    allowed = f"from 0 to a tenth of the module, {millimetres(0.1 * gear.module)}"
    for name in ("tip_relief", "profile_crowning", "lead_crowning", "end_relief"):
        amount = getattr(gear.modification, name)
        yield f"modification.{name}", amount, 0.0 <= amount <= largest, allowed


def gear_problems(gear: HelicoidGear, key: str) -> Iterator[Problem]:
    """Yield the problems of a gear whose values are possible, with keys below `key`."""
    yield from (_internal_problems if gear.internal else _external_problems)(gear, key)
    depth = gear.kind * (gear.root - gear.rim_radius)
    if not (depth > 0.0 and gear.rim_radius > 0.0):
        side, to = ("above", up) if gear.internal else ("above 0 and below", down)
        allowed = f"{side} the root radius, {millimetres(gear.root, to)}"
        yield problem(f"{key}.rim", gear.rim_radius, "no body is left below the teeth", allowed)


def _external_problems(gear: HelicoidGear, key: str) -> Iterator[Problem]:
    slope, addendum = math.tan(gear.pressure_angle), f"{key}.addendum"
    pointed = "the teeth become pointed below this tip"
    if rack_tip_half_width(gear) < 0.0:
        room = math.pi / 4 - gear.dedendum * slope
        largest = room / (1.0 / math.cos(gear.pressure_angle) - slope)
        lower = f"0, with a dedendum of at most {digits(down(math.pi / 4 / slope))}"
        what = "the tip of the generating rack has no room for this radius"
        allowed = f"at most {digits(down(largest))} with this dedendum" if room >= 0.0 else lower
        yield problem(f"{key}.tip_radius", gear.tip_radius, what, allowed)
    if gear.profile_shift < gear.least_profile_shift - TEETH.fits:
        what = "the generating rack undercuts the teeth"
        least = math.ceil(1e4 * (gear.least_profile_shift - TEETH.fits)) / 1e4
        allowed = f"at least {least:.4f} with {gear.teeth} teeth"
        hint = "A smaller dedendum, a larger tip radius or more teeth help too."
        yield problem(f"{key}.profile_shift", gear.profile_shift, what, allowed, hint)
    if gear.tip <= gear.base_radius:
        allowed = f"more than {digits(up(gear.addendum_to(gear.base_radius)))}"
        inside = "the tip lies inside the base circle"
        yield problem(addendum, gear.addendum, inside, allowed)
    elif gear.base_half_angle <= 0.0:
        yield problem(addendum, gear.addendum, pointed, "none with such a small profile shift")
    elif gear.half_angle(gear.tip) <= 0.0:
        allowed = (
            f"less than {digits(down(gear.addendum_to(gear.pointed)))} with this profile shift"
        )
        hint = "A smaller profile shift helps too."
        yield problem(addendum, gear.addendum, pointed, allowed, hint)


def _internal_problems(gear: HelicoidGear, key: str) -> Iterator[Problem]:
    addendum = f"{key}.addendum"
    if gear.tip < gear.base_radius:
        largest = digits(down(gear.addendum_to(gear.base_radius)))
        inside = "the tips reach inside the base circle, where there is no involute"
        yield problem(addendum, gear.addendum, inside, f"at most {largest}")
    elif gear.half_angle(gear.tip) <= 0.0:
        pointed = "the teeth become pointed below this tip"
        allowed = "a smaller addendum or a larger profile shift"
        yield problem(addendum, gear.addendum, pointed, allowed)
    deep = (
        gear.root - gear.tip_radius * gear.module > gear.base_radius
        and gear.base_radius * math.hypot(1.0, gear.form_roll) > gear.tip
    )
    # The space narrows with depth.
    wide = deep and fillet_angle(gear) <= math.pi / gear.teeth
    if not (deep and wide):
        what = "the tooth space has no room for a root radius of this size"
        allowed = f"a smaller tip radius, or a {'smaller' if deep else 'larger'} dedendum"
        yield problem(f"{key}.tip_radius", gear.tip_radius, what, allowed)
