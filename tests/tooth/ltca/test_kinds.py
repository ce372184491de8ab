"""The whole analysis for every kind of pair: external, herringbone, internal, face gear."""

import math
from functools import cache

import numpy as np
import pytest

from loadshare.tooth.analysis.ltca import ltca
from loadshare.tooth.cylindrical.build import helicoid_pair
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.face.build import face_gear_pair
from loadshare.tooth.face.gear import FaceGear, Shaper

TURN = math.radians(30.0)


def _herringbone(helices=2):
    gears = (
        HelicoidGear(4e-3, teeth, 40e-3, helix_angle=sign * TURN, helices=helices)
        for teeth, sign in ((23, 1.0), (60, -1.0))
    )
    return helicoid_pair(*gears)


KINDS = {
    "helical": lambda: (_herringbone(helices=1), 2500.0),
    "herringbone": lambda: (_herringbone(), 5000.0),
    "internal": lambda: (
        helicoid_pair(
            HelicoidGear(4e-3, 23, 40e-3),
            HelicoidGear(4e-3, 70, 40e-3, internal=True, addendum=0.85),
        ),
        500.0,
    ),
    "face gear": lambda: (
        face_gear_pair(
            HelicoidGear(3.2e-3, 25, 50e-3),
            FaceGear(116, Shaper(3.2e-3, 28), 0.178, 0.207, addendum=0.95),
        ),
        1087.6,
    ),
}


@cache
def analysed(kind, model="slices"):
    pair, torque = KINDS[kind]()
    return pair, torque, ltca(pair, torque, 3, (0.1, 0.5, 0.9, 1.0), model, points=20)


@pytest.mark.parametrize("kind", KINDS)
def test_certified_and_in_balance_with_the_torque(kind):
    pair, torque, found = analysed(kind)
    worst = max(c.certificate.worst for row in found.contacts for c in row)
    assert worst < 1e-11
    for row in found.lines:
        about_axis = sum(
            float(np.sum(np.cross(one.line.points, one.line.normals)[:, 2] * one.force))
            for one in row[-1]
        )
        # The normal's arm about the driver's axis is r_b cos β_b, except for the inclination of the
        # gap's own normals.
        assert pair.helices * about_axis == pytest.approx(torque, rel=1e-3)
    assert np.all(found.law.b >= 0.0)
    assert np.all(found.law.c >= 0.0)
    assert np.abs(found.misfit).max() < 0.02
    assert np.all(found.tangent() > found.secant(0.1))


def test_one_helix_of_two_carries_half():
    _, _, one = analysed("helical")
    _, _, two = analysed("herringbone")
    np.testing.assert_allclose(two.angle, one.angle, rtol=1e-9)


@pytest.mark.parametrize("model", ["slices", "finite elements"])
def test_a_line_about_to_leave_the_flanks_lets_go_of_its_load(model):
    """The shorter it was, the wider was its contact, and the more it carried: 6 % of the load when
    almost nothing of it was left, for a helical pair.
    """
    pair = helicoid_pair(
        HelicoidGear(3e-3, 25, 20e-3, helix_angle=0.3),
        HelicoidGear(3e-3, 50, 20e-3, helix_angle=-0.3),
    )
    last = max(pair.changes)
    phases = [last + step for step in (-1e-2, 3e-2, 1e-2, 3e-3, 1e-3, 2e-4)]
    found = ltca(pair, 100.0, phases, compliance=model, points=8)
    shares = [min(shares.values()) for shares in found.shares()[1:]]
    assert np.all(np.diff(shares) < 0.0)
    assert shares[-1] < 0.003
    # The approach is continuous with that without the line.
    assert found.approach[-1, -1] == pytest.approx(found.approach[0, -1], rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["herringbone", "internal", "face gear"])
def test_slices_against_finite_elements(kind):
    """Measured: slices stiffer by 6 % (herringbone), 3 % (internal), 1 to 3 % (face gear)."""
    _, _, fast = analysed(kind)
    _, _, slow = analysed(kind, "finite elements")
    ratio = fast.secant() / slow.secant()
    np.testing.assert_allclose(ratio, 1.035, atol=0.04)
