"""Impossible geometry is refused, naming the dimension at fault; doubtful geometry is a finding."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.tooth.geometry.samples import face_gear, face_pair, gear, pair

from loadshare.errors import CaseError
from loadshare.tooth.cylindrical.build import helicoid_pair
from loadshare.tooth.cylindrical.checks import gear_problems
from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification
from loadshare.tooth.cylindrical.pair import HelicoidPair, Misalignment
from loadshare.tooth.face.build import face_gear_pair
from loadshare.tooth.face.gear import FaceGear, Shaper
from loadshare.tooth.face.pair import FaceMisalignment
from loadshare.tooth.geometry.gap import NoContactError
from loadshare.tooth.pair.findings import edge_contacts, findings

PINION = HelicoidGear(6.35e-3, 25, 90e-3, math.radians(25.0), tip_radius=0.3)


def keys(build):
    with pytest.raises(CaseError) as caught:
        build()
    for problem in caught.value.problems:
        assert problem.message
        assert problem.allowed
    return {problem.key for problem in caught.value.problems}


@pytest.mark.parametrize(("teeth", "least"), [(10, 0.4151), (12, 0.2981), (14, 0.1812)])
def test_undercut_by_the_rack(teeth, least):
    # x_min = 1 − z sin² 20°/2, tabled with h_a* = 1; the rack's radius 0.38 makes h* 0.99998.
    made = gear(teeth)
    assert made.least_profile_shift == pytest.approx(least, abs=1e-4)
    assert keys(lambda: helicoid_pair(made, gear(53))) == {"driver.profile_shift"}
    fine = gear(teeth, profile_shift=made.least_profile_shift + 1e-9, addendum=0.8)
    assert fine.form_roll == pytest.approx(0.0, abs=1e-8)
    assert not list(gear_problems(fine, "driver"))


def test_pointed_teeth():
    made = gear(20, addendum=1.6)
    with pytest.raises(CaseError) as caught:
        helicoid_pair(made, gear(53))
    (problem,) = caught.value.problems
    assert problem.key == "driver.addendum"
    largest = float(problem.allowed.split()[2])
    # At the limit the tip land is zero.
    assert gear(20, addendum=largest).half_angle(gear(20, addendum=largest).tip) == pytest.approx(
        0.0, abs=1e-6
    )


@pytest.mark.parametrize(("distance", "told"), [(0.0745, True), (None, False)])
def test_tips_that_find_no_room_for_want_of_distance(distance, told):
    """For teeth that overlap, the message used to ask only for addenda below the root."""
    with pytest.raises(CaseError) as caught:
        helicoid_pair(gear(addendum=1.3), gear(53), distance)
    hints = {problem.hint for problem in caught.value.problems}
    assert hints == {"Without backlash, the centre distance would be 77 mm." if told else ""}


def test_teeth_that_are_too_far_apart_are_told_the_distance_that_fits():
    with pytest.raises(CaseError, match=r"Without backlash, the centre distance would be 77 mm\."):
        helicoid_pair(gear(), gear(53), 0.77)


@pytest.mark.parametrize(
    ("build", "expected"),
    [
        (lambda: helicoid_pair(gear(helix_angle=0.2), gear(53)), {"driven.helix_angle"}),
        (lambda: helicoid_pair(gear(), gear(53, module=3e-3)), {"driven.module"}),
        (lambda: helicoid_pair(gear(), gear(26, internal=True)), {"driven.addendum",
                                                                 "driven.tip_radius"}),
        (lambda: helicoid_pair(gear(), gear(80, internal=True)), {"driven.addendum"}),
        (lambda: helicoid_pair(gear(10), gear(53, module=3e-3)),
         {"driver.profile_shift", "driven.module"}),
        (lambda: face_gear_pair(replace(PINION, teeth=29, dedendum=4.0), face_gear()),
         {"driver.tip_radius", "driver.profile_shift", "driver.teeth"}),
        (lambda: helicoid_pair(gear(60), gear(50, internal=True, addendum=0.5)),
         {"driven.teeth"}),
        (lambda: helicoid_pair(gear(80, internal=True), gear(90, internal=True)),
         {"driven.internal"}),
        (lambda: helicoid_pair(gear(tip_radius=0.6), gear(53)), {"driver.tip_radius"}),
        (lambda: helicoid_pair(gear(), gear(53), 0.0805), {"driver.addendum"}),
        (lambda: helicoid_pair(gear(), gear(53), 0.0765), {"driver.addendum", "driven.addendum"}),
        (lambda: helicoid_pair(gear(), gear(53), 0.07), {"centre_distance"}),
        (lambda: helicoid_pair(gear(profile_shift=-0.4), gear(30, profile_shift=-0.74)),
         {"driven.profile_shift"}),
        (lambda: pair(off=Misalignment(axial_shift=0.03)), {"misalignment.axial_shift"}),
        (lambda: helicoid_pair(gear(helices=2), gear(53, helices=2),
                               misalignment=Misalignment(deviation=1e-4)),
         {"misalignment.deviation"}),
        (lambda: helicoid_pair(gear(rim=0.05), gear(53)), {"driver.rim"}),
        (lambda: helicoid_pair(gear(modification=Modification(tip_relief=1e-5)), gear(53)),
         {"driver.modification.tip_relief_length"}),
        (lambda: helicoid_pair(gear(module=-1.0), gear(3)), {"driver.module", "driven.teeth"}),
        (lambda: face_pair(inner=0.44, outer=0.60), {"driven.inner", "driven.outer"}),
        (lambda: face_pair(inner=0.515), {"driven.inner"}),
        (lambda: face_gear_pair(PINION, replace(face_gear(), rim=300.0)), {"driven.rim"}),
        (lambda: face_pair(29), {"driver.teeth"}),
        (lambda: face_gear_pair(PINION, FaceGear(160, Shaper(6.35e-3, 28, math.radians(25.0)),
                                                 0.48, 0.53, addendum=1.3)),
         {"driven.addendum"}),
        (lambda: face_gear_pair(
            HelicoidGear(6.35e-3, 25, 90e-3, math.radians(25.0), tip_radius=0.3, addendum=1.26),
            face_gear()), {"driver.addendum"}),
        (lambda: face_gear_pair(
            HelicoidGear(6.35e-3, 25, 90e-3, math.radians(25.0), tip_radius=0.3,
                         profile_shift=0.1), face_gear()), {"driver.profile_shift"}),
        (lambda: face_gear_pair(
            HelicoidGear(6.35e-3, 25, 10e-3, math.radians(25.0), tip_radius=0.3), face_gear()),
         {"driver.face_width"}),
    ],
)  # fmt: skip
def test_each_fault_is_named(build, expected):
    assert keys(build) == expected


def test_the_room_of_a_root_radius_is_that_of_the_space_at_its_root():
    """The space of an internal gear is narrower the deeper it is, so a smaller dedendum leaves more
    room.
    """
    ring = {"internal": True, "addendum": 0.8, "profile_shift": -0.5013}
    (problem,) = gear_problems(gear(56, **ring), "driven")
    assert problem.key == "driven.tip_radius"
    assert problem.allowed == "a smaller tip radius, or a smaller dedendum"
    assert not list(gear_problems(gear(56, dedendum=1.2, **ring), "driven"))
    assert list(gear_problems(gear(56, dedendum=1.3, **ring), "driven"))


def test_tips_of_internal_pairs_meet_when_the_tooth_counts_are_close():
    # Independent check: the corners of the tips, followed over the rotation in which they pass each
    # other.
    pinion = gear(24, addendum=0.6)
    outcomes = set()
    for teeth in range(28, 60):
        ring = gear(teeth, internal=True, addendum=0.45, dedendum=1.2, tip_radius=0.1)
        message = None
        try:
            mesh = helicoid_pair(pinion, ring)
        except CaseError as error:
            message = str(error)
            if "interfere beside the line of action" not in message:
                continue
            base = ring.base_radius - pinion.base_radius
            mesh = HelicoidPair(pinion, ring, base / math.cos(pinion.transverse_angle))
        assert corners_collide(mesh) == (message is not None), teeth
        outcomes.add(message is not None)
    assert outcomes == {True, False}


def corners_collide(mesh) -> bool:
    """Return whether a pinion's tip corner enters a ring's tooth beside the line of action."""
    pinion, ring = mesh.driver_gear, mesh.driven_gear
    driver, driven = mesh.ideal(0.0)
    corner = pinion.half_angle(pinion.tip)
    centre = mesh.driven.placement.origin[0]
    turn = np.linspace(-math.pi, math.pi, 40001)
    for side in (1, -1):
        # One tooth of the pinion makes a full turn; the ring's teeth are a periodic pattern.
        at = pinion.tip * np.exp(1j * (driver + turn + side * corner)) - centre
        radius, polar = np.abs(at), np.angle(at)
        inside = (radius > ring.tip) & (radius < ring.root)
        pitch = 2.0 * math.pi / ring.teeth
        polar = polar - driven - turn / mesh.ratio
        polar = (polar + 0.5 * pitch) % pitch - 0.5 * pitch
        pressure = np.arccos(np.minimum(ring.base_radius / np.maximum(radius, ring.tip), 1.0))
        half = ring.base_half_angle + np.tan(pressure) - pressure
        if (inside & (np.abs(polar) < half - 1e-6)).any():
            return True
    return False


def test_no_contact_at_a_position():
    mesh = HelicoidPair(gear(), gear(53), 0.0805)
    with pytest.raises(
        NoContactError, match=r"in contact at phase 0\.5 .* mm at the driv(er|en) tip"
    ):
        mesh.positions([0.5], 5)[0]


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("pinion_shift", 0.12, r"misses .* by 18\.8 mm at the driven outer end"),
        ("pinion_shift", -0.12, "nowhere near one another"),
        ("gear_shift", -0.02, r"misses .* by 0\.662 mm at the driven tip"),
    ],
)
def test_a_misalignment_that_parts_the_teeth_is_named_with_the_edge(name, value, message):
    with pytest.raises(CaseError, match=rf"misalignment\.{name} = .*{message}"):
        face_pair(28, FaceMisalignment(**{name: value}))
    off = {name: value, "offset": 1e-6}
    with pytest.raises(CaseError, match="misalignment: no pair of teeth is in contact at phase"):
        face_pair(28, FaceMisalignment(**off))


def test_contact_at_the_end_of_the_teeth_is_a_finding():
    off = Misalignment(deviation=5e-4)
    (found,) = edge_contacts(pair(off=off), 4)
    assert found.key == "driver.face"
    assert "4 of 4 positions" in found.message
    crowned = pair(off=off, modification=Modification(lead_crowning=20e-6))
    assert edge_contacts(crowned, 4) == ()
    assert edge_contacts(pair(), 4) == ()


def test_a_pinion_like_the_shaper_and_thin_tips_are_findings():
    named = {problem.key for problem in findings(face_pair(28), 2)}
    assert named == {"driven.shaper.teeth", "driven.outer"}
    named = {problem.key for problem in findings(face_pair(28, FaceMisalignment(offset=1e-4)), 2)}
    assert "driven.outer_end" in named
    assert findings(face_pair(25, outer=0.54), 2) == ()
    thin = findings(helicoid_pair(gear(profile_shift=1.15), gear(53, addendum=0.9)), 2)
    assert "driver.addendum" in {problem.key for problem in thin}
