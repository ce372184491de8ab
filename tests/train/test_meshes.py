"""Mesh geometry: the signs of the expression for the approach, and their consequences for floats.

Source: formulation, section 2. The checks do not use that expression: teeth at the pitch point must
push forwards, a rigid rotation at the speed ratio must not compress, gears must push each other
apart, and forces must do as much work on one body as they take from the other.
"""

import math

import numpy as np
import pytest
from tests.certify.oracle import approach

from loadshare.contact.law import PowerLaw
from loadshare.train.gear import Gear, transverse_frame
from loadshare.train.kinematics import settle
from loadshare.train.mesh import Mesh, MeshGeometryError, contact_of

ANGLE = math.radians(20.0)
X, Y, Z = np.eye(3)


def gear(
    name: str, kind: str, centre: tuple[float, float, float], axis: np.ndarray, radius: float
) -> Gear:
    axis = np.asarray(axis, dtype=float)
    place = np.array(centre, dtype=float)
    frame = transverse_frame(axis)
    return Gear(name, kind, place, axis, frame, radius, 1, None, np.zeros(2), 1.0)


SMALL, BIG, PINION, FACE = 0.05, 0.1, 0.04, 0.2
"""Base radii [m]; for the face gear, the acting radius."""
APART = (SMALL + BIG) / math.cos(ANGLE)
WITHIN = (BIG - SMALL) / math.cos(ANGLE)
OVER = PINION / math.cos(ANGLE)
PAIRS = {
    "external": (
        gear("a", "external", (0, 0, 0), Z, SMALL),
        gear("b", "external", (APART, 0, 0), Z, BIG),
    ),
    "axes against": (
        gear("a", "external", (0, 0, 0), Z, SMALL),
        gear("b", "external", (0, APART, 0), -Z, BIG),
    ),
    "internal": (
        gear("a", "external", (WITHIN, 0, 0), Z, SMALL),
        gear("b", "internal", (0, 0, 0), Z, BIG),
    ),
    "ring drives": (
        gear("a", "internal", (0, 0, 0), Z, BIG),
        gear("b", "external", (WITHIN, 0, 0), Z, SMALL),
    ),
    "face": (
        gear("a", "external", (0, 0, 0), Y, PINION),
        gear("b", "face", (0, 0.4, OVER), Z, FACE),
    ),
    "face below": (
        gear("a", "external", (0, 0, 0), Y, PINION),
        gear("b", "face", (0, -0.4, -OVER), Z, FACE),
    ),
    "face drives": (
        gear("a", "face", (0, 0.4, OVER), Z, FACE),
        gear("b", "external", (0, 0, 0), Y, PINION),
    ),
}
every_pair = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS)
both_senses = pytest.mark.parametrize("sense", [1, -1])


def meshed(pair: tuple[Gear, Gear], sense: int) -> tuple[Gear, Gear, Mesh]:
    """Return the pair with the driver running in `sense`, settled by the kinematics."""
    first = Gear(**{s: getattr(pair[0], s) for s in Gear.__slots__} | {"sense": sense})
    found = settle({"a": first, "b": pair[1]}, {"a-b": ("a", "b")}, {}, "a")
    contact = contact_of(found.gears["a"], found.gears["b"])
    radii = first.base_radius, pair[1].base_radius
    normals = (contact.normal(ANGLE, True), contact.normal(ANGLE, False))
    mesh = Mesh("a-b", "a", "b", radii, *normals, (PowerLaw(1e-9),), (0.0,), 1e-4)
    return found.gears["a"], found.gears["b"], mesh


def pitch_point(driver: Gear, driven: Gear) -> np.ndarray:
    """Return the point where the two pitch circles touch, from the gears' places alone."""
    if "face" in (driver.kind, driven.kind):
        face, pinion = (driver, driven) if driver.kind == "face" else (driven, driver)
        towards = pinion.centre - face.centre
        out = towards - (towards @ face.axis) * face.axis
        return face.centre + face.base_radius * out / np.linalg.norm(out)
    inner, outer = sorted((driver, driven), key=lambda g: g.kind == "internal")
    between = outer.centre - inner.centre
    if outer.kind == "internal":
        between = -between
    return inner.centre + between / np.linalg.norm(between) * inner.base_radius / math.cos(ANGLE)


@every_pair
@both_senses
def test_teeth_run_the_same_way_at_the_pitch_point(pair, sense):
    """The velocities ω × r of both gears at the pitch point have the direction of the push."""
    driver, driven, mesh = meshed(pair, sense)
    at = pitch_point(driver, driven)
    speeds = [g.sense * np.cross(g.axis, at - g.centre) for g in (driver, driven)]
    ways = [v / np.linalg.norm(v) for v in speeds]
    assert ways[0] @ ways[1] == pytest.approx(1.0, abs=1e-12)
    assert mesh.drive_normal @ ways[0] == pytest.approx(math.cos(ANGLE), abs=1e-12)
    assert mesh.coast_normal @ ways[0] == pytest.approx(-math.cos(ANGLE), abs=1e-12)


@every_pair
@both_senses
def test_a_rigid_rotation_at_the_speed_ratio_gives_no_approach(pair, sense):
    driver, driven, mesh = meshed(pair, sense)
    assert driven.ratio == pytest.approx(driver.base_radius / driven.base_radius)
    turns = 1e-3, 1e-3 * driven.ratio
    for drive in (True, False):
        gap = mesh.gap(0, drive)
        assert approach(mesh, drive, 0, turns, np.zeros(3)) + gap == pytest.approx(0.0, abs=1e-18)
    assert approach(mesh, True, 0, (1e-3, 0.0), np.zeros(3)) > 0.0
    assert approach(mesh, False, 0, (-2e-2, 0.0), np.zeros(3)) > 0.0


@every_pair
@both_senses
def test_tooth_bodies_press_apart(pair, sense):
    """Pushing the bodies into each other closes both flanks equally, by sin α of the distance."""
    driver, driven, mesh = meshed(pair, sense)
    into = pitch_point(driver, driven) - driver.centre
    if driver.kind == "face":
        into = np.sign((driven.centre - driver.centre) @ driver.axis) * driver.axis
    elif driven.kind == "face":
        into = np.sign((driven.centre - driver.centre) @ driven.axis) * driven.axis
    elif driver.kind == "internal":
        into = driver.centre - driven.centre  # the rim moves towards the pinion's far side
        into = -into if into @ (driven.centre - driver.centre) > 0 else into
    into = into / np.linalg.norm(into)
    for drive in (True, False):
        moved = approach(mesh, drive, 0, (0.0, 0.0), 1e-5 * into) + mesh.gap(0, drive)
        assert moved == pytest.approx(1e-5 * math.sin(ANGLE), abs=1e-14)


@every_pair
@both_senses
@pytest.mark.parametrize("drive", [True, False])
def test_torques_are_the_moments_of_the_push(pair, sense, drive):
    """F n at the pitch point turns the driven gear forwards by r_b F, and its reaction turns the
    driver backwards.
    """
    driver, driven, mesh = meshed(pair, sense)
    on_driver, on_driven, normal = mesh.direction(drive)
    for body, push, coefficient in ((driven, normal, on_driven), (driver, -normal, on_driver)):
        arm = pitch_point(driver, driven) - body.centre
        # A contact compresses by its approach, so a force does the work −coefficient per unit of
        # rotation.
        moment = body.sense * (body.axis @ np.cross(arm, push))
        if body.kind == "face":
            # Its acting radius is the lever of the tooth force itself.
            moment /= math.cos(ANGLE)
        assert moment == pytest.approx(-coefficient, rel=1e-12)


@every_pair
def test_a_reversed_train_uses_the_other_flank(pair):
    """Drive and coast flanks are exchanged when the train runs the other way."""
    _, _, ahead = meshed(pair, 1)
    _, _, back = meshed(pair, -1)
    assert ahead.drive_normal == pytest.approx(back.coast_normal)
    assert ahead.coast_normal == pytest.approx(back.drive_normal)


def test_gears_that_cannot_mesh_as_placed():
    with pytest.raises(MeshGeometryError, match="coincide"):
        contact_of(PAIRS["external"][0], PAIRS["external"][0])
    pinion = gear("a", "external", (0, 0, 0.05), Y, 0.04)
    with pytest.raises(MeshGeometryError, match="axis"):
        contact_of(pinion, gear("b", "face", (0, 0, 0), Z, 0.2))
    with pytest.raises(MeshGeometryError, match="pitch plane"):
        contact_of(pinion, gear("b", "face", (0, 0.4, 0.05), Z, 0.2))
