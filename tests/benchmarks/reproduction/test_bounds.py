"""Requirements on the seed paper's figures, checked on the figures of the page."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmarks.reproduction import loads, printed, splines
from benchmarks.reproduction.both_errors import (
    CONDITIONAL,
    alternatives,
    share_entries,
    torque_entries,
)
from benchmarks.reproduction.rings import fig13_entries, fig14_entries
from benchmarks.reproduction.seed import PINIONS, first, pair_omega, push_on
from benchmarks.reproduction.single_errors import order
from loadshare.job import solve

# --- Figs. 13 and 14: within 3 % ---


@pytest.mark.slow
def test_figs_13_and_14_within_three_percent(limited):
    entries = [*fig13_entries(limited), *fig14_entries(limited)]
    assert len(entries) == 10
    assert {e.quantity: e.relative for e in entries if abs(e.relative) > 0.03} == {}


@pytest.mark.slow
def test_both_pinions_press_on_rings_of_the_printed_size(limited):
    assert {p: limited.resting.floats[p].state for p in PINIONS} == dict.fromkeys(
        PINIONS, "on boundary"
    )


@pytest.mark.slow
def test_the_threshold_is_the_float_in_an_ample_ring(limited):
    """Two ways to the same figure: the event along the clearance, and the free balance point.

    In an ample ring the pinion may move along an arc; its sagitta at 10 µm is below a nanometre.
    """
    for pinion, threshold in limited.thresholds.items():
        free = math.hypot(*limited.as_printed.point(pinion))
        assert threshold == pytest.approx(free, abs=1e-3)


@pytest.mark.slow
def test_no_sign_of_the_error_of_gear_9_gives_branch_and_balance_point(limited):
    assert limited.as_printed.branch == "9-10"
    assert limited.mirrored.branch == "8-10"
    here, there = (np.array(v.point("5")) for v in (limited.as_printed, limited.mirrored))
    # The sagitta of the arcs is less than a nanometre.
    assert there == pytest.approx(-here, abs=1e-3)
    assert here @ printed.POINTS["5"] > 0.0 > there @ printed.POINTS["5"]


@pytest.mark.slow
def test_the_stiffness_fit_knows_what_it_cannot_tell_apart(limited):
    assert not np.isfinite(limited.stiffness.covariance).any()
    four, five = (d.computed for d in limited.stiffness.comparison.deviations)
    assert four == pytest.approx(1.047, abs=0.005)
    assert five == pytest.approx(1.019, abs=0.005)


# --- Figs. 8 and 9: order of influence ---


@pytest.mark.slow
def test_fig_8_in_order_of_influence(displaced):
    """Gear 1 has most influence in stage I, gear 6 in stage II, twice that of the others."""
    assert order(displaced.omega("I"))[0] == ["1"]
    two = displaced.omega("II")
    assert order(two)[0] == ["6"]
    assert all(two["6"] - 1 > 2 * (two[g] - 1) for g in ("7", "8", "9", "10"))
    assert max(displaced.omega("I").values()) < max(two.values())


@pytest.mark.slow
def test_the_printed_sizes_of_fig_8_lie_within_what_the_direction_leaves_open(displaced):
    for stage, gear in (("I", "1"), ("II", "6")):
        low, high = displaced.extremes[stage][gear]
        assert low < printed.OMEGA_INSTALLATION[stage] < high


@pytest.mark.slow
def test_fig_8_is_linear_in_the_error(displaced):
    """No contact is lost, so torques are linear in the error: Ω I to round-off. Ω II is relative to
    the torque of a pinion, which the error changes by up to 5.3 % (gear 10: Ω I of 1.0528).
    """
    for stage, tolerance in (("I", 1e-9), ("II", 0.053)):
        for curve in displaced.curves[stage].values():
            rise = np.array(curve[1:]) - 1
            assert rise / rise[-1] == pytest.approx(np.arange(1, 6) / 5, rel=tolerance)


@pytest.mark.slow
def test_gears_2_and_3_are_alike_in_every_direction(displaced):
    """The layout is symmetric, so they agree to round-off."""
    two, three = (displaced.turned["I"][gear] for gear in "23")
    assert two == pytest.approx(three, abs=1e-9)


@pytest.mark.slow
def test_a_common_direction_gives_the_printed_picture_of_fig_8(displaced):
    """Gear 6 is as printed; if it has most influence, 7 to 10 are far below, within a factor 2."""
    led = [omega for omega in displaced.matching.values() if order(omega)[0] == ["6"]]
    assert len(displaced.matching) == 4
    assert len(led) == 2
    for omega in displaced.matching.values():
        assert omega["6"] == pytest.approx(printed.OMEGA_INSTALLATION["II"], abs=1e-8)
    for omega in led:
        rest = [omega[g] - 1 for g in ("7", "8", "9", "10")]
        assert max(rest) < 2 * min(rest)
        assert omega["6"] - 1 > 1.5 * max(rest)


@pytest.mark.slow
def test_mirrored_gears_reach_the_same_largest_coefficient(displaced):
    """This holds over a whole turn. Steps of 5° miss the largest Ω − 1 by 1 − cos 2.5°, 0.1 %."""
    for here, there in (("6", "8"), ("7", "9")):
        highest = [displaced.extremes["II"][gear][1] - 1 for gear in (here, there)]
        assert highest[0] == pytest.approx(highest[1], rel=2e-3)


def test_an_eccentric_gear_comes_round_once_per_revolution(seed):
    """The torque over the mean has one period per revolution, and its two halves are mirrored.

    With a period of half a revolution, both halves would be equal.
    """
    case = seed.case("eccentricity").replace(
        {"march": {"gear": "8", "revolutions": 2.0, "steps": 24}}
    )
    torque = np.array([p.torque["8-10"] for p in solve(case).positions])
    first_turn, second_turn = torque[:12], torque[12:]
    assert second_turn == pytest.approx(first_turn, rel=1e-9)
    swing = first_turn - first_turn.mean()
    assert swing[6:] == pytest.approx(-swing[:6], abs=1e-9 * abs(torque).max())
    assert np.ptp(swing) > 0.1 * abs(torque).max()


def test_fig_9_in_order_of_influence(turning):
    """Gear 1 has most influence in stage I; in stage II, gear 8 and its mirror image 6."""
    assert order(turning.omega("I"))[0] == ["1"]
    assert "8" in order(turning.omega("II"))[0]
    assert order(turning.omega("II"))[0] == ["6", "8"]
    assert max(turning.omega("I").values()) < max(turning.omega("II").values())


def test_the_printed_sizes_of_fig_9_lie_below_the_largest_of_a_revolution(turning):
    for stage, value in printed.OMEGA_ECCENTRICITY.items():
        assert value < max(turning.omega(stage).values())


# --- Fig. 10: fitted within 0.005 ---


@pytest.mark.slow
def test_the_shares_of_fig_10_are_fitted_within_0_005(both):
    entries = share_entries(both)
    assert len(entries) == 6
    assert all(abs(e.difference) <= 0.005 for e in entries)
    assert both.fitted.chi_square < 1e-6


@pytest.mark.slow
def test_the_fit_of_fig_10_determines_three_combinations(both):
    sizes = both.fitted.singular_values
    assert (sizes > 1e-6 * sizes.max()).sum() == 3
    assert not np.isfinite(both.fitted.covariance).any()
    assert len(CONDITIONAL) == 3
    assert np.isfinite(both.conditional.covariance).all()


@pytest.mark.slow
def test_the_conditional_fit_agrees_with_finite_differences(both):
    """The covariance is from differences of shares over 0.01°: curvature adds a relative 1e-3."""
    keys = [f"errors.{g}.eccentricity.direction" for g in CONDITIONAL]
    values = [u.value for u in both.conditional.unknowns]

    def figures(changed):
        at = first(both.case, {k: f"{float(v)!r} deg" for k, v in zip(keys, changed, strict=True)})
        return np.array([at.share["1-2"], *(at.pair_share[m] for m in printed.SHARES_II)])

    step = 0.01
    slopes = [
        (figures(np.add(values, step * row)) - figures(np.add(values, -step * row))) / (2 * step)
        for row in np.eye(3)
    ]
    jacobian = np.array(slopes).T / 0.0005
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    assert both.conditional.covariance == pytest.approx(covariance, rel=1e-3)


@pytest.mark.slow
def test_balanced_torques_cannot_meet_the_printed_ones(both):
    """They agree within 2 %, but not to the printed digits, which do not balance."""
    entries = torque_entries(both)
    assert all(abs(e.relative) < 0.02 for e in entries)
    assert sum(printed.TORQUES.values()) - printed.TORQUE == pytest.approx(1.0, abs=0.01)
    stage_one = [both.position.torque[m] for m in printed.TORQUES]
    # The input torque is that of 2000 kW at 8780 r/min, printed to 0.1 N·m.
    assert sum(stage_one) == pytest.approx(printed.TORQUE, abs=0.06)


# --- Figs. 11, 12, 18, Table 2: trend and order ---


@pytest.mark.slow
def test_full_float_shares_better_and_pinion_4_floats_further(both, full):
    for pinion in PINIONS:
        assert pair_omega(full.position, pinion) - 1 < 0.1 * (pair_omega(both.position, pinion) - 1)
        assert full.position.floats[pinion].spline == "slip"
    assert full.float_of("4") > full.float_of("5")


@pytest.mark.slow
def test_in_full_float_the_pairs_lie_on_one_another(full):
    """They agree within the width of the picture's lines, 2 N·m. Both splines have one friction."""
    torque = full.position.torque
    for here, there in (("6-10", "8-10"), ("7-10", "9-10"), ("1-2", "1-3")):
        assert torque[here] == pytest.approx(torque[there], abs=2.0)


@pytest.mark.slow
def test_the_printed_floats_are_the_unrelieved_estimate(full):
    """Pinion 5 is within 2 % of F/K_w. For pinion 4, 356 µm correspond to 1.047, the share of Fig.
    13, to its last digit. Both are more than 20 times the float with relief.
    """
    assert full.unrelieved("5") == pytest.approx(printed.FLOATS["5"], rel=0.02)
    omega = splines.share_of_push(full, printed.SHARES_II["7-10"], printed.FLOATS["4"])
    assert omega == pytest.approx(printed.RIGID_RINGS["4"], abs=0.0005)
    for pinion in PINIONS:
        assert printed.FLOATS[pinion] > 20 * full.float_of(pinion)


@pytest.mark.slow
def test_the_force_on_a_pinion_is_what_a_stiff_bearing_carries(both):
    """A bearing of 1e12 N/m yields a little, which reduces the force by some per mille: mesh
    stiffnesses are near 2e9 N/m.
    """
    for pinion in PINIONS:
        soft = first(both.case, {f"gears.{pinion}.support": "1e12 N/m"})
        carried = 1e12 * math.hypot(*soft.displacement[pinion])
        assert push_on(both.case, both.position, pinion) == pytest.approx(carried, rel=5e-3)


@pytest.mark.slow
def test_the_curve_of_fig_12_falls_and_pinion_5_is_free_first(full, loosened):
    found = loosened
    assert found.free["5"] < found.free["4"]
    # Paper: 300 µm, less than the float of 356 µm of pinion 4, frees pinion 5 but not pinion 4.
    part = printed.HALF_FREE / printed.FLOATS["4"]
    assert found.free["5"] < part * found.free["4"] < found.free["4"]
    for pinion, curve in found.curves.items():
        # Level parts are level to round-off.
        assert (np.diff(curve) < 1e-9).all()
        assert curve[-1] < curve[0]
        assert found.free[pinion] == pytest.approx(full.float_of(pinion), rel=1e-6)
        held = [c for c in splines.CLEARANCES if c < found.free[pinion]]
        assert curve[len(held) - 1] > curve[-1] + 1e-6
        assert np.ptp(curve[len(held) :]) < 1e-9
    assert all(event.confirmed for event in found.events)


@pytest.mark.slow
def test_omega_falls_with_the_load_and_differences_of_torque_stay(loaded):
    found = loaded
    assert [row.torque for row in found.rows] == sorted([*loads.TORQUES, printed.LIGHT])
    for name in ("one", "two", "reduced", "floating"):
        assert (np.diff([getattr(row, name) for row in found.rows]) < 0).all()
    first_row = found.rows[0]
    for row in found.rows:
        # Linear springs in contact: exact up to round-off of the torques.
        assert row.apart == pytest.approx(first_row.apart, rel=1e-9)
        product = (first_row.one - 1) * first_row.torque
        assert (row.one - 1) * row.torque == pytest.approx(product, rel=1e-9)
    assert found.light.reduced == pytest.approx(printed.LIGHT_THEORY, abs=1e-9)
    assert 0.0 < found.scale < 1.0


@pytest.mark.slow
def test_other_directions_that_give_fig_10_give_the_same_floats(seed, full):
    """The floats even out the differences that the shares show. They agree within 3 %, because the
    case file's set misses the shares by 0.001 of 0.067.
    """
    for case in alternatives(seed).values():
        other = splines.full_float(seed, case)
        for pinion in PINIONS:
            assert other.float_of(pinion) == pytest.approx(full.float_of(pinion), rel=0.03)
            assert other.unrelieved(pinion) == pytest.approx(full.unrelieved(pinion), rel=0.03)
