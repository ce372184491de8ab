"""The equations of an active set: their Jacobian, and that they reproduce certified answers."""

import numpy as np
import pytest
from tests.support import coasting, lost_contact, round_ring, shipped

from loadshare.certify import certify
from loadshare.scene import assemble
from loadshare.study.answers import certified
from loadshare.study.branch.system import identified
from loadshare.train import build_train

CASES = {
    "limit_ring": lambda: shipped("fgfbstts/limit_ring"),
    "all_elements": lambda: shipped("fgfbstts/all_elements"),
    "slip": lambda: shipped("fgfbstts/full_float"),
    "stop": lambda: shipped("fgfbstts/spline_clearance"),
    "round ring": round_ring,
    "elastic round ring": lambda: round_ring("1e8 N/m"),
    "coast flanks": coasting,
    "lost contact": lost_contact,
    "friction that follows the torque": lambda: shipped("fgfbstts/full_float").replace(
        {
            "splines.4.normal_force": None,
            "splines.4.friction": 0.0005,
            "splines.4.radius": "35 mm",
        }
    ),
}


@pytest.fixture(params=CASES, ids=str)
def standing(request):
    """A train, and the branch and unknowns of its first position."""
    train = build_train(CASES[request.param]())
    answer = certified(train, 1)
    return train, answer, *identified(assemble(train, 1), answer.equilibrium)


def test_the_jacobian_is_the_derivative_of_the_residual(standing):
    _, _, branch, z = standing
    h = 1e-6
    differences = np.array(
        [
            (branch.residual(z + h * e) - branch.residual(z - h * e)) / (2.0 * h)
            for e in np.eye(branch.size)
        ]
    ).T
    jacobian = branch.jacobian(z)
    # Central differences of smooth terms: h² and round-off over h, both below 1e-8 of the largest.
    assert np.abs(jacobian - differences).max() < 1e-7 * np.abs(jacobian).max()


def test_a_branch_gives_back_its_equilibrium(standing):
    train, answer, branch, z = standing
    found = branch.equilibrium(z)
    certificate = certify(train, found)
    assert certificate.passed, certificate.failing
    for name, force in answer.equilibrium.flank_force.items():
        # Torques are unique: two certified answers differ by what the certificate leaves open.
        assert found.flank_force[name] == pytest.approx(force, abs=1e-9 * certificate.load)


def test_every_gauge_is_positive_at_an_equilibrium(standing):
    _, _, branch, z = standing
    assert all(gauge.value > -1e-9 for gauge in branch.gauges(z))
