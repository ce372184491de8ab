"""The equations of an active set: their Jacobian, and agreement with certified answers."""

import numpy as np
import pytest
from tests.support import coasting, lost_contact, round_ring, shipped

from loadshare.study.positions import certified
from loadshare.study.sensitivity.branch import Setting, figures
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
    """Return a certified answer, the branch of its first position and the unknowns there."""
    train = build_train(CASES[request.param]())
    answer = certified(train, 1)
    return answer, *Setting.at(train, 1).branch_of(answer.equilibrium)


def figures_at(branch, z):
    (found,) = figures([branch], z)
    return found


def test_the_jacobian_is_the_derivative_of_the_residual(standing):
    _, branch, z = standing
    h = 1e-6
    differences = np.array(
        [
            (figures_at(branch, z + h * e) - figures_at(branch, z - h * e)) / (2.0 * h)
            for e in np.eye(branch.size)
        ]
    ).T
    found = np.vstack([branch.jacobians(z[None])[0], branch.torque_gradients(z)])
    # Central differences of smooth terms: h² and round-off over h are both below 1e-8 of the
    # largest.
    assert np.abs(found - differences).max() < 1e-7 * np.abs(found).max()


def test_a_branch_gives_back_its_equilibrium(standing):
    answer, branch, z = standing
    elements = branch.setting.structure
    force = branch.equations.state(z[None], branch.numbers).force[0] * elements.force
    found = dict(zip(elements.row_names, force[elements.springs :], strict=False))
    for name, certain in answer.equilibrium.flank_force.items():
        # Torques are unique: two certified answers differ by the tolerance of the certificate.
        assert found[name] == pytest.approx(certain, abs=1e-9 * answer.certificate.load)
    assert np.abs(figures_at(branch, z)[: branch.size]).max() <= 1e-12 * np.abs(z).max()


def test_every_gauge_is_positive_at_an_equilibrium(standing):
    _, branch, z = standing
    assert all(gauge.value > -1e-9 for gauge in branch.gauges(z).values())
