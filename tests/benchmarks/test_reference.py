"""The 50-digit reference against closed forms and the certificate, and its own digits.

Source of the closed forms: reconstruction of the seed's case (no floats, rigid supports); the
radial law of formulation, section 5.
"""

import math
from decimal import Decimal

import numpy as np
import pytest
from tests.support import CASES, coasting, lost_contact, round_ring, shipped

import loadshare as ls
from benchmarks import families
from benchmarks.reference import NoReference, reference
from benchmarks.reference.elimination import Contradiction, solve_sparse
from loadshare.certify import certify
from loadshare.train import build_train

ROUND_OFF = 1e-12
"""Round-off of our solver in double precision: some tens of unknowns, condition numbers up to 1e4.
"""
DETERMINED = ("rigid_closed_form", "both_errors", "spline_clearance", "full_float", "limit_ring")


def test_it_meets_the_closed_form_of_the_rigid_train():
    # I46 = 3, I12 = 4.641, K12 = 8.365e5, K46 = 4.275e6, K610 = 6.425e6, K_T = 5e5, E46 = 3e-4 rad.
    found = reference(build_train(shipped("fgfbstts/rigid_closed_form")))
    assert found.torque["1-2"] == pytest.approx(1081.975, abs=5e-4)  # as printed, three decimals
    assert found.torque["1-3"] == pytest.approx(1093.225, abs=5e-4)


def test_branches_that_are_alike_share_to_the_last_of_50_digits():
    case = families.star(4, floating=False).replace({'meshes."sun-planet1".gap': None})
    found = reference(build_train(case))
    torques = {Decimal(found.exact[f"sun-planet{k}"]) for k in range(1, 5)}
    # Planets are on the axes, but cos 90° in doubles is 6e-17, not 0; they may differ by as much.
    assert max(torques) - min(torques) < Decimal("1e-13")
    assert abs(sum(torques) / len(torques) - 250) < Decimal("1e-13")


@pytest.mark.parametrize("name", DETERMINED)
def test_residuals_are_below_forty_digits_and_ours_agrees(name):
    case = shipped(f"fgfbstts/{name}")
    train = build_train(case)
    answer = ls.explain(case, 1).equilibrium
    for hint in (None, answer):
        found = reference(train, 1, hint)
        assert found.residual < 1e-40
        largest = max(found.force.values())
        ours = {**answer.flank_force, **answer.ring_force}
        assert max(abs(found.force[n] - f) for n, f in ours.items()) < ROUND_OFF * largest


def test_a_sun_that_rattles_between_two_planets_has_torques_all_the_same():
    """Two planets lose contact, the sun is loose between the others: its float is undetermined."""
    case = lost_contact()
    train = build_train(case)
    for hint in (None, ls.explain(case, 1).equilibrium):
        found = reference(train, 1, hint)
        assert found.residual < 1e-40
        assert found.undetermined == {"sun"}
        torques = [found.torque[f"sun-planet{k}"] for k in range(1, 5)]
        # Opposite planets balance the sun, so each of them carries half.
        assert sorted(torques) == pytest.approx([0.0, 0.0, 50.0, 50.0], abs=1e-12)


@pytest.mark.parametrize("make", [round_ring, coasting])
def test_round_rings_and_coast_flanks(make):
    case = make()
    train = build_train(case)
    found = reference(train, 1, ls.explain(case, 1).equilibrium)
    assert found.residual < 1e-40
    assert found.slack >= 0.0
    if make is round_ring:
        ring = next(iter(found.pull.values()))
        assert np.linalg.norm(ring) > 0.0


def test_every_element_at_once_is_certified_from_the_reference_alone():
    case = ls.load_case(CASES / "fgfbstts/all_elements.toml")
    answer = ls.explain(case, 1)
    found = reference(answer.train, 1, answer.equilibrium)
    assert found.residual < 1e-40
    assert certify(answer.train, answer.equilibrium).passed
    for name, torque in found.torque.items():
        mesh = answer.train.meshes[name]
        signs = ((d, 1.0 if d else -1.0) for d in mesh.flanks)
        ours = mesh.radii[0] * math.fsum(
            s * answer.equilibrium.flank_force[mesh.flank_name(d)] for d, s in signs
        )
        assert ours == pytest.approx(torque, rel=1e-11, abs=1e-9)


def test_a_float_that_only_round_off_holds_is_called_loose():
    """A free pinion between two idlers is in balance only as far as their normals are opposite."""
    case = shipped("fgfbstts/limit_ring")
    inside = case.replace({"rings.4.float": "1 mm", "rings.4.clearance": "1 mm"})
    for text, loose in ((case, {"1"}), (inside, {"1", "4"})):
        train = build_train(text)
        found = reference(train, 1, ls.explain(text, 1).equilibrium)
        assert found.residual < 1e-40
        assert found.loose == loose
        assert found.imbalance < 1e-9


def test_a_wrong_hint_cannot_change_the_answer():
    case = shipped("fgfbstts/spline_clearance")
    train = build_train(case)
    far = ls.explain(case.replace({"errors.6": None}), 1).equilibrium
    misled, own = reference(train, 1, far), reference(train, 1)
    for name, torque in own.exact.items():
        assert abs(Decimal(misled.exact[name]) - Decimal(torque)) < Decimal("1e-38")


def test_a_train_that_nothing_balances_has_no_reference():
    case = families.star(2).replace({"gears.planet2.centre.angle": "150 deg"})
    with pytest.raises(NoReference):
        reference(build_train(case))


def test_elimination_solves_and_finds_what_is_free():
    rows = [{0: 2.0, 1: 1.0}, {0: 4.0, 1: 2.0}, {2: 3.0}]
    solution, spans = solve_sparse([dict(r) for r in rows], [3.0, 6.0, 9.0], 3, 1e-12)
    assert 2.0 * solution[0] + solution[1] == pytest.approx(3.0)
    assert solution[2] == pytest.approx(3.0)
    (span,) = spans
    assert 2.0 * span[0] + span[1] == pytest.approx(0.0)
    with pytest.raises(Contradiction):
        solve_sparse(rows, [3.0, 7.0, 9.0], 3, 1e-12)
