"""Construction of pairs of cylindrical gears, with every interference reported."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress

from loadshare.case.checks.fit import OVERLAP
from loadshare.errors import CaseError, Problem
from loadshare.involute import (
    base_distance,
    distance_without_backlash,
    inv,
    normal_backlash,
    root_clearance,
    tips_pass,
)
from loadshare.settings import TEETH
from loadshare.tooth.cylindrical.checks import gear_problems, value_problems
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.cylindrical.pair import HelicoidPair, Misalignment
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


def helicoid_pair(
    driver: HelicoidGear,
    driven: HelicoidGear,
    centre_distance: float | None = None,
    misalignment: Misalignment | None = None,
) -> HelicoidPair:
    """Put two cylindrical gears in mesh.

    Parameters
    ----------
    driver, driven : HelicoidGear
        The gears; one of them may be internal.
    centre_distance : float, optional
        Centre distance [m]; by default the one without backlash.
    misalignment : Misalignment, optional
        Misalignment of the axes.

    Returns
    -------
    HelicoidPair
        A pair without undercut, pointed teeth or interference.

    Raises
    ------
    CaseError
        If the gears or their mesh have problems; it lists all of them.
    """
    misalignment = misalignment or Misalignment()
    refuse(value_problems(driver, "driver") + value_problems(driven, "driven"))
    found = [*gear_problems(driver, "driver"), *gear_problems(driven, "driven")]
    refuse([*found, *_partner_problems(driver, driven, misalignment)])
    base = base_distance(driver, driven)
    if centre_distance is None:
        try:
            centre_distance = distance_without_backlash(driver, driven)
        except ValueError as error:
            raise CaseError([_no_working_angle(driver, driven)]) from error
    pair = HelicoidPair(driver, driven, centre_distance, misalignment)
    if pair.actual_distance <= base:
        raise CaseError([_no_line_of_action(pair, base)])
    refuse(_mesh_problems(pair))
    refuse(meeting_problems(pair))
    return pair


def overlap_problems(pair: HelicoidPair) -> Iterator[Problem]:
    """Yield a problem if the centre distance leaves no room for the unloaded flanks.

    The check is separate because a case has already made it, with its thickness allowances.
    """
    gears, distance = (pair.driver_gear, pair.driven_gear), pair.centre_distance
    backlash = normal_backlash(*gears, max(distance, base_distance(*gears)))
    if backlash >= -OVERLAP * pair.driver_gear.module:
        return
    overlap = f"at this centre distance the teeth overlap by {millimetres(-backlash)}"
    try:
        fits = distance_without_backlash(*gears)
    except ValueError:
        yield _no_working_angle(*gears)
        return
    least, to = ("at least", up) if pair.kind > 0 else ("at most", down)
    hint = "If the teeth are thinner, reduce profile_shift and raise addendum by as much."
    yield problem("centre_distance", distance, overlap, f"{least} {millimetres(fits, to)}", hint)


def _partner_problems(
    driver: HelicoidGear, driven: HelicoidGear, misalignment: Misalignment
) -> Iterator[Problem]:
    kind = driver.kind * driven.kind
    helix = -kind * driver.helix_angle
    fits = math.isclose(driven.helix_angle, helix, rel_tol=TEETH.fits, abs_tol=TEETH.fits)
    checks: tuple[Check, ...] = (
        same("module", driven.module, driver.module, "driver"),
        same("pressure_angle", driven.pressure_angle, driver.pressure_angle, "driver"),
        ("helix_angle", driven.helix_angle, fits, f"{degrees(helix)}, to run with the driver"),
        same("helices", driven.helices, driver.helices, "driver"),
    )
    yield from failed("driven", "the gears do not fit each other", checks)
    if driver.internal and driven.internal:
        yield problem("driven.internal", "true", "two internal gears cannot mesh", "false")
    elif kind < 0:
        key, ring, pinion = _ring_first(driver, driven)
        if ring.teeth <= pinion.teeth:
            few = "an internal gear needs more teeth than its pinion"
            yield problem(f"{key}.teeth", ring.teeth, few, f"more than {pinion.teeth}")
    for name in ("inclination", "deviation", "axial_shift"):
        if driver.helices == 2 and getattr(misalignment, name):
            what = "the two halves of a herringbone pair would no longer be alike"
            allowed = "0 for a herringbone pair"
            hint = "Treat the halves as two helical pairs."
            yield problem(f"misalignment.{name}", getattr(misalignment, name), what, allowed, hint)


def _ring_first(
    driver: HelicoidGear, driven: HelicoidGear
) -> tuple[str, HelicoidGear, HelicoidGear]:
    """Return the key of the internal gear of a pair, that gear, and its pinion."""
    return ("driver", driver, driven) if driver.internal else ("driven", driven, driver)


def _no_line_of_action(pair: HelicoidPair, base: float) -> Problem:
    """Return the problem of too small a centre distance, or of a misalignment that causes it."""
    key, value, rest = "centre_distance", pair.centre_distance, pair.misalignment.centre_distance
    if value > base:
        key, value, rest = f"misalignment.{key}", rest, value
    none = "at this centre distance the gears have no line of action"
    return problem(key, value, none, f"more than {millimetres(base - rest, up)}")


def _no_working_angle(driver: HelicoidGear, driven: HelicoidGear) -> Problem:
    teeth = driver.kind * driver.teeth + driven.kind * driven.teeth
    least = -driver.profile_shift
    least -= 0.5 * teeth * inv(driver.transverse_angle) / math.tan(driver.pressure_angle)
    more = f"more than {digits(up(least))}" if teeth > 0 else f"less than {digits(down(least))}"
    return problem(
        "driven.profile_shift",
        driven.profile_shift,
        "the base circles would have to overlap for the gears to mesh without backlash",
        f"{more} with the driver's profile shift",
        "Or give the centre distance.",
    )


def _mesh_problems(pair: HelicoidPair) -> Iterator[Problem]:
    driver, driven = pair.driver_gear, pair.driven_gear
    found = [
        *_tip_problems(pair, driver, "driver", driven, "driven"),
        *_tip_problems(pair, driven, "driven", driver, "driver"),
        *(_fouling(pair) if pair.kind < 0 else ()),
    ]
    yield from found
    low, high = pair.ends
    if low >= high:
        reach = 0.5 * (driver.face_width + driven.face_width)
        shift, apart = pair.misalignment.axial_shift, "the face widths no longer overlap"
        allowed = f"less than {millimetres(reach, down)}"
        yield problem("misalignment.axial_shift", millimetres(shift), apart, allowed)
    elif not found:
        hint = "Larger addenda, a smaller centre distance or a wider helical gear raise it."
        yield from ratio_problems(pair, f"{hint} {_apart(pair, -1)}".strip())


def _tip_problems(
    pair: HelicoidPair, gear: HelicoidGear, name: str, other: HelicoidGear, other_name: str
) -> Iterator[Problem]:
    """Yield interferences of the tip of `other` in the tooth spaces of `gear`."""
    key = f"{other_name}.addendum"
    # The partner's tip may reach down to where this gear's involute ends; if that lies beyond
    # the partner's base point on the line of action, only a lower tip helps.
    limit = max(pair.partner_roll(gear.form_roll, of_driven=name == "driven"), 0.0)
    if other.kind * (other.tip_roll - limit) > TEETH.fits:
        largest = other.addendum_to(other.base_radius * math.hypot(1.0, limit))
        cuts = f"the tip of this gear cuts into the root fillet of the {name}"
        allowed = f"at most {digits(down(largest))}"
        yield problem(key, other.addendum, cuts, allowed, _apart(pair, 1))
    clearance = root_clearance(gear, other, pair.actual_distance)
    if clearance <= 0.0:
        allowed = f"less than {digits(down(other.addendum + clearance / other.module))}"
        runs = f"the tip of this gear runs into the root of the {name}"
        yield problem(key, other.addendum, runs, allowed, _apart(pair, 1))


def _apart(pair: HelicoidPair, way: int) -> str:
    """Return a hint with the distance without backlash, if the teeth are on one side of it.

    `way` is 1 for teeth that are too near to each other, −1 for teeth that are too far apart.
    """
    gears = pair.driver_gear, pair.driven_gear
    with suppress(ValueError):  # there may be no distance without backlash
        fits = distance_without_backlash(*gears)
        if way * pair.kind * (fits - pair.actual_distance) > TEETH.fits * fits:
            return f"Without backlash, the centre distance would be {millimetres(fits)}."
    return ""


def _fouling(pair: HelicoidPair) -> Iterator[Problem]:
    """Yield a problem if the tips of pinion and ring meet off the line of action (fouling)."""
    key, ring, pinion = _ring_first(pair.driver_gear, pair.driven_gear)
    if not tips_pass(pinion, ring, pair.actual_distance):
        yield problem(
            f"{key}.addendum",
            ring.addendum,
            "the tips of the internal gear and its pinion interfere beside the line of action, "
            f"with a tooth difference of {ring.teeth - pinion.teeth}",
            "a smaller addendum of either gear, or a larger tooth difference",
        )
