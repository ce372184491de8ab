"""Putting two cylindrical gears in mesh, with every interference told."""

from __future__ import annotations

import math

from loadshare.errors import CaseError, Problem
from loadshare.tooth.cylindrical.checks import gear_problems
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.cylindrical.pair import (
    HelicoidPair,
    Misalignment,
    working_angle_without_backlash,
)
from loadshare.tooth.geometry.involute import inv
from loadshare.tooth.geometry.partners import Demand, misfits, same
from loadshare.tooth.unloaded.meeting import meeting_problems
from loadshare.tooth.words import degrees, millimetres, plain, problem


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
        How far the axes are off.

    Returns
    -------
    HelicoidPair
        A pair without undercut, pointed teeth or interference.

    Raises
    ------
    CaseError
        With everything that is wrong with the gears or with their mesh.
    """
    misalignment = misalignment or Misalignment()
    problems = gear_problems(driver, "driver") + gear_problems(driven, "driven")
    if not problems:
        problems = _partner_problems(driver, driven, misalignment)
    if problems:
        raise CaseError(problems)
    if centre_distance is None:
        try:
            angle = working_angle_without_backlash(driver, driven)
        except ValueError as error:
            raise CaseError([_no_working_angle(driver, driven)]) from error
        base = driven.base_radius + driver.kind * driven.kind * driver.base_radius
        centre_distance = abs(base) / math.cos(angle)
    problems = _distance_problems(driver, driven, centre_distance, misalignment)
    if problems:
        raise CaseError(problems)
    pair = HelicoidPair(driver, driven, centre_distance, misalignment)
    problems = _mesh_problems(pair) or meeting_problems(pair, misalignment)
    if problems:
        raise CaseError(problems)
    return pair


def _partner_problems(
    driver: HelicoidGear, driven: HelicoidGear, misalignment: Misalignment
) -> list[Problem]:
    kind = driver.kind * driven.kind
    helix = -kind * driver.helix_angle
    demands = (
        same("module", driven.module, driver.module, millimetres, "driver"),
        same("pressure_angle", driven.pressure_angle, driver.pressure_angle, degrees, "driver"),
        Demand(
            "helix_angle",
            math.isclose(driven.helix_angle, helix, rel_tol=1e-9, abs_tol=1e-12),
            degrees(driven.helix_angle),
            f"{degrees(helix)}, to run with the driver",
        ),
        same("helices", driven.helices, driver.helices, plain, "driver"),
    )
    found = misfits("driven", "the gears do not fit each other", demands)
    if driver.internal and driven.internal:
        found.append(problem("driven.internal", "true", "two internal gears cannot mesh", "false"))
    elif kind < 0:
        ring, pinion, key = (
            (driver, driven, "driver") if driver.internal else (driven, driver, "driven")
        )
        if ring.teeth <= pinion.teeth:
            found.append(
                problem(
                    f"{key}.teeth",
                    str(ring.teeth),
                    "an internal gear needs more teeth than its pinion",
                    f"more than {pinion.teeth}",
                )
            )
    if driver.helices == 2:
        found += [
            problem(
                f"misalignment.{name}",
                plain(getattr(misalignment, name)),
                "the two halves of a herringbone pair would no longer be alike",
                "0 for a herringbone pair",
                "Treat the halves as two helical pairs.",
            )
            for name in ("inclination", "deviation", "axial_shift")
            if getattr(misalignment, name)
        ]
    return found


def _no_working_angle(driver: HelicoidGear, driven: HelicoidGear) -> Problem:
    teeth = driver.kind * driver.teeth + driven.kind * driven.teeth
    least = -driver.profile_shift
    least -= 0.5 * teeth * inv(driver.transverse_angle) / math.tan(driver.pressure_angle)
    return problem(
        "driven.profile_shift",
        plain(driven.profile_shift),
        "the base circles would have to overlap for the gears to mesh without backlash",
        f"{'more' if teeth > 0 else 'less'} than {plain(least)} with the driver's profile shift",
        "Or give the centre distance.",
    )


def _distance_problems(
    driver: HelicoidGear, driven: HelicoidGear, distance: float, misalignment: Misalignment
) -> list[Problem]:
    base = abs(driven.base_radius + driver.kind * driven.kind * driver.base_radius)
    actual = distance + misalignment.centre_distance
    if actual > base:
        return []
    return [
        problem(
            "centre_distance",
            millimetres(actual),
            "at this centre distance the gears have no line of action",
            f"more than {millimetres(base)}",
        )
    ]


def _mesh_problems(pair: HelicoidPair) -> list[Problem]:
    found = []
    for name, gear, other_name, other in (
        ("driver", pair.driver_gear, "driven", pair.driven_gear),
        ("driven", pair.driven_gear, "driver", pair.driver_gear),
    ):
        # The partner's tip may come down to where this gear's involute ends; where that lies
        # beyond the partner's base point of the line of action, only a lower tip helps.
        limit = pair.partner_roll(gear.form_roll, of_driven=name == "driven")
        if other.kind * (other.tip_roll - max(limit, 0.0)) > 1e-9:
            radius = other.base_radius * math.hypot(1.0, max(limit, 0.0))
            largest = other.kind * (radius - other.radius) / other.module - other.profile_shift
            found.append(
                problem(
                    f"{other_name}.addendum",
                    plain(other.addendum),
                    f"the tip of this gear cuts into the root fillet of the {name}",
                    f"at most {plain(largest)}",
                )
            )
        clearance = _clearance(pair, gear, other)
        if clearance <= 0.0:
            found.append(
                problem(
                    f"{other_name}.addendum",
                    plain(other.addendum),
                    f"the tip of this gear runs into the root of the {name}",
                    f"less than {plain(other.addendum + clearance / other.module)}",
                )
            )
    if pair.kind < 0:
        found += _fouling(pair)
    total = pair.contact_ratio + pair.overlap_ratio
    low, high = pair.axial_range
    if low >= high:
        reach = 0.5 * (pair.driver_gear.face_width + pair.driven_gear.face_width)
        found.append(
            problem(
                "misalignment.axial_shift",
                millimetres(pair.misalignment.axial_shift),
                "the face widths no longer overlap",
                f"less than {millimetres(reach)}",
            )
        )
    elif not found and (total < 1.0 or pair.contact_ratio <= 0.0):
        found.append(
            problem(
                "driver.addendum",
                plain(pair.driver_gear.addendum),
                f"the contact ratio is {total:.3f}: at some positions no teeth are in contact",
                "a contact ratio of 1 or more",
                "Larger addenda, a smaller centre distance or a wider helical gear raise it.",
            )
        )
    return found


def _clearance(pair: HelicoidPair, gear: HelicoidGear, other: HelicoidGear) -> float:
    """Distance left between the tip of `other` and the root of `gear` [m]."""
    distance = pair.centre_distance + pair.misalignment.centre_distance
    if pair.kind > 0:
        return distance - other.tip - gear.root
    if gear.internal:
        return gear.root - distance - other.tip
    return other.tip - distance - gear.root


def _fouling(pair: HelicoidPair) -> list[Problem]:
    """Tips of pinion and ring that meet outside the line of action (trimming, fouling).

    Where the tip circles cross, at polar angles θ1 and θ2 from the line of centres, the pinion's
    tip must have passed the ring's:
    z1 (inv α_a1 + θ1) − z2 (inv α_a2 + θ2) + (z2 − z1) inv α_w ≥ 0.
    """
    gears = [pair.driver_gear, pair.driven_gear]
    pinion, ring = sorted(gears, key=lambda gear: gear.internal)
    key = "driver" if pair.driver_gear is ring else "driven"
    distance = pair.centre_distance + pair.misalignment.centre_distance
    r1, r2 = pinion.tip, ring.tip
    cosine = (r2**2 - r1**2 - distance**2) / (2.0 * distance * r1)
    if abs(cosine) >= 1.0:
        return []
    theta_1 = math.acos(cosine)
    theta_2 = math.acos((distance**2 + r2**2 - r1**2) / (2.0 * distance * r2))

    def inv_tip(gear: HelicoidGear) -> float:
        return gear.tip_roll - math.atan(gear.tip_roll)

    working = math.tan(pair.working_angle) - pair.working_angle
    passed = pinion.teeth * (inv_tip(pinion) + theta_1) - ring.teeth * (inv_tip(ring) + theta_2)
    passed += (ring.teeth - pinion.teeth) * working
    if passed >= 0.0:
        return []
    return [
        problem(
            f"{key}.addendum",
            plain(ring.addendum),
            "the tips of the internal gear and of its pinion meet beside the line of action, "
            f"with {ring.teeth - pinion.teeth} teeth difference",
            "a smaller addendum of either gear, or more teeth difference",
        )
    ]
