"""Sensitivities: against closed forms and finite differences of full solves."""

import math

import numpy as np
import pytest
from tests.support import SHIPPED, shipped

import loadshare as ls
from loadshare.study.differences import LEAST
from loadshare.study.parameter import Value
from loadshare.study.sensitivity import SIDES, Sensitivity, sensitivity


def about_to_leave() -> ls.Case:
    """Pinion 4 with a float range at which its stop is just free, to the last digit.

    The idlers stand a little off the line through the pinion, so that an arc holds it as well.
    """
    off_line = {f"gears.{g}.centre.distance": "525.6314 mm" for g in "6789"}
    case = shipped("fgfbstts/limit_ring").replace(off_line)
    found = ls.critical(case, "rings.4.float", "8 um", "9 um", positions=[1])
    (event,) = [e for e in found.events if "stop" in e.element]
    return case.replace({"rings.4.float": f"{event.value!r} um"})


def torques(case: ls.Case, key: str, value: Value, number: float) -> np.ndarray:
    """Torques [N·m] of the first position with an input at a number of its unit."""
    changed = case.replace({key: value.at(number).text})
    (position,) = ls.solve(changed, positions=[1]).positions
    return np.array(list(position.torque.values()))


def torques_or_none(case: ls.Case, key: str, value: Value, number: float) -> np.ndarray | None:
    """Torques as above; None where there is no certified equilibrium."""
    try:
        return torques(case, key, value, number)
    except ls.Refused:
        return None


def test_the_closed_form():
    """T12 = T1/2 + (E_b − E_a)/(2 C1) with E_a = I12 E46/2 (reconstruction): I12 = 4.641."""
    found = sensitivity(shipped("fgfbstts/rigid_closed_form"), 'meshes."4-6".gap', positions=[1])
    c4 = 1 / 4.275e6 + 3**2 / 6.425e6
    c1 = 1 / 8.365e5 + 4.641**2 * (1 / 5e5 + c4 / 2)
    for side in SIDES:
        rates = found.rates[1, 'meshes."4-6".gap', side]
        assert rates.torque["1-2"] == pytest.approx(-4.641 / 2 / (2 * c1), rel=1e-9)
        assert rates.torque["1-3"] == pytest.approx(4.641 / 2 / (2 * c1), rel=1e-9)
        # Ω46 = 1 − E46/(C4 T24) where T24 does not change; it does, by I12 dT12.
        t12, dt12 = 1081.975, rates.torque["1-2"]
        t24 = 4.641 * t12
        explicit = -1 / (c4 * t24) - 3e-4 * -1 / (c4 * t24**2) * 4.641 * dt12
        (group,) = [rates.torque["4-6"] + rates.torque["4-7"]]
        assert group == pytest.approx(4.641 * dt12, rel=1e-9)
        share = (rates.torque["4-6"] - 0.963454 * group / 2) / (t24 / 2)
        # The printed T12 and Ω46 have six digits.
        assert share == pytest.approx(explicit, rel=2e-6)


def test_torque_alone_changes_no_share_without_errors():
    found = sensitivity(shipped("fgfbstts/base"), "operating.power", positions=[1])
    rates = found.rates[1, "operating.power", "rising"]
    assert rates.torque["1-2"] + rates.torque["1-3"] == pytest.approx(60 / (2 * math.pi * 8780))
    assert all(abs(v) * 2e6 < 1e-12 for v in rates.share.values() if not math.isnan(v))


def agree(case: ls.Case, key: str, found: Sensitivity) -> None:
    """Compare with central differences of full solves: at a kink, the mean of both sides."""
    (item,) = [i for i in found.inputs if i.key == key]
    value = item.value
    h = max(2e-6 * abs(value.number), LEAST[value.si_unit] / value.factor)
    sides = [np.array(list(found.rates[1, key, side].torque.values())) for side in SIDES]
    rates = 0.5 * (sides[0] + sides[1])
    try:
        found_at = {s: torques_or_none(case, key, value, value.number + s * h) for s in (1, -1)}
    except ls.CaseError:
        return
    above, below = found_at[1], found_at[-1]
    if above is None and below is None:
        # A free gear whose loads balance for one value of the input only: there is no derivative.
        assert np.isnan(rates).all()
        return
    if above is None or below is None:
        # What is solved to one side only is compared to that side: first order in the step.
        (sign, there), *_ = [(s, t) for s, t in found_at.items() if t is not None]
        here = torques(case, key, value, value.number)
        slope = (there - here) / (sign * h * value.factor)
        one_sided = sides[sign > 0]
        assert one_sided == pytest.approx(slope, rel=1e-3, abs=1e-3 * np.abs(rates).max())
        return
    differences = (above - below) / (2.0 * h * value.factor)
    # Second order in a step of up to 1e-5, at a kink first order; and what two certified solves
    # leave open: 1e-11 of the torque.
    near = 1e-5 if np.array_equal(*sides) else 1e-4
    open_ = 1e-11 * np.abs(above).max() / (h * value.factor)
    assert rates == pytest.approx(differences, rel=near, abs=near * np.abs(rates).max() + open_)


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("fgfbstts/limit_ring", ["rings.4.float", "rings.5.float", "errors.6.installation[1]"]),
        ("fgfbstts/both_errors", ["errors.4.*", "gears.6.centre.angle", 'shafts."2-4".stiffness']),
        ("fgfbstts/full_float", ["splines.4.*", "errors.6.eccentricity.amount"]),
        ("fgfbstts/spline_clearance", ["splines.4.*", "operating.power"]),
        (
            "fgfbstts/all_elements",
            ['meshes."4-6".law.c[0]', "splines.5.*", "rings.5.float.*", "errors.9"],
        ),
        ("star/floating_sun_5", ['meshes."sun-planet1".*', "gears.sun.base_radius"]),
        ("two_path/clocking_error", None),
    ],
)
def test_finite_differences_of_full_solves(name, keys):
    case = shipped(name)
    found = sensitivity(case, keys, positions=[1])
    assert found.inputs
    assert max(found.error.values()) < 1e-5
    for item in found.inputs:
        agree(case, item.key, found)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_finite_differences_on_every_shipped_case(name):
    case = shipped(name)
    found = sensitivity(case, positions=[1])
    chosen = np.random.default_rng(5).permutation([i.key for i in found.inputs])[:40]
    for key in chosen:
        agree(case, str(key), found)


def test_displacements_and_shares_follow():
    case = shipped("fgfbstts/limit_ring")
    key = "errors.6.installation[1]"
    found = sensitivity(case, key, positions=[1])
    at = [
        ls.solve(case.replace({key: f"{v!r} um"}), positions=[1]).positions[0]
        for v in (99.999, 100.001)
    ]
    rates = found.rates[1, key, "rising"]
    for mesh in ("6-10", "7-10", "8-10"):
        slope = (at[1].pair_share[mesh] - at[0].pair_share[mesh]) / 2e-9
        # Differences over 2 nm of shares that are good to 1e-13.
        assert rates.pair_share[mesh] == pytest.approx(slope, abs=1e-4 * abs(slope) + 1e-3)
    slope = (np.array(at[1].displacement["4"]) - at[0].displacement["4"]) / 2e-9
    assert rates.displacement["4"] == pytest.approx(slope, abs=1e-6)
    # The input pinion floats with nothing to hold it along its teeth: it has no derivative.
    assert np.isnan(rates.displacement["1"]).any()
    assert (rates.displacement["10"] == 0.0).all()


@pytest.mark.parametrize("key", ["rings.4.float", "errors.6.installation[1]"])
def test_a_kink_has_a_derivative_to_each_side_and_says_so(key):
    """At the critical float the stop is about to let go: nothing changes on one side."""
    case = about_to_leave()
    found = sensitivity(case, key, positions=[1])
    assert [(k.position, k.elements) for k in found.kinks] == [(1, ("ring 4: upper stop",))]
    (item,) = found.inputs
    here = torques(case, key, item.value, item.value.number)
    sizes = []
    for side, sign in (("falling", -1.0), ("rising", 1.0)):
        there = torques(case, key, item.value, item.value.number + sign * 1e-4)
        slope = (there - here) / (sign * 1e-10)
        rates = np.array(list(found.rates[1, key, side].torque.values()))
        # Differences over 0.1 nm (the arcs hand over 0.6 nm away) of torques good to 1e-8 N·m.
        assert rates == pytest.approx(slope, rel=1e-5, abs=200.0)
        sizes.append(np.abs(rates).max())
    assert min(sizes) < 1e-3 * max(sizes)
    assert max(sizes) > 1e6


def test_a_pinion_that_floats_free_is_caught_by_its_arcs():
    """Nothing presses on it: an input that does so has the slope of the arc that is then in the
    way, another one on each side, and the kink is told. Where it rests remains open.
    """
    case = shipped("fgfbstts/tolerance")
    key = 'meshes."4-6".pressure_angle'
    found = sensitivity(case, [key, "rings.4.clearance", "errors.6.installation[1]"], positions=[1])
    (kink,) = found.kinks
    assert set(kink.elements) == {"ring 4: arc 6", "ring 4: arc 7"}
    value = next(i.value for i in found.inputs if i.key == key)
    here = torques(case, key, value, value.number)
    slopes = []
    for side, sign in (("falling", -1.0), ("rising", 1.0)):
        there = torques(case, key, value, value.number + sign * 1e-4)
        slope = (there - here) / (sign * 1e-4 * value.factor)
        rates = found.rates[1, key, side]
        # First order in a step of 2e-6 of a radian, of torques good to 1e-9 N·m.
        assert list(rates.torque.values()) == pytest.approx(slope, rel=1e-3, abs=1e-2)
        assert np.isnan(rates.displacement["4"]).any()
        slopes.append(rates.torque["4-6"])
    assert slopes[0] != pytest.approx(slopes[1], rel=1e-5)
    # Room that nothing presses on does nothing.
    idle = found.rates[1, "rings.4.clearance", "rising"].torque
    assert max(map(abs, idle.values())) * 1e-6 < 1e-9


def test_an_input_at_its_bound_has_one_side():
    case = shipped("fgfbstts/limit_ring").replace({"rings.4.float": "0 um"})
    found = sensitivity(case, "rings.4.float", positions=[1])
    falling, rising = (found.rates[1, "rings.4.float", s].torque["7-10"] for s in SIDES)
    assert math.isnan(falling)
    item = found.inputs[0].value
    here, there = (torques(case, "rings.4.float", item, v) for v in (0.0, 1e-3))
    slope = (there - here)[list(case.meshes).index("7-10")] / 1e-9
    assert rising == pytest.approx(slope, rel=1e-5)


def test_the_largest_of_equal_branches():
    """Without errors all branches are the largest: Ω rises to either side."""
    case = shipped("fgfbstts/base").replace({"errors.6.installation": ["0 um", "0 um"]})
    found = sensitivity(case, "errors.6.installation[1]", positions=[1])
    slopes = {s: found.pair_omega["errors.6.installation[1]", s]["II"] for s in SIDES}
    shares = found.rates[1, "errors.6.installation[1]", "rising"].pair_share
    assert slopes["rising"] == pytest.approx(max(shares[m] for m in ("6-10", "7-10")))
    assert slopes["falling"] == pytest.approx(-slopes["rising"])


def test_arrays_and_defaults():
    found = ls.sensitivity(shipped("two_path/clocking_error"), positions=[1])
    keys = [item.key for item in found.inputs]
    assert "operating.torque" in keys
    assert not any("teeth" in key or "positions" in key for key in keys)
    arrays = found.dataset
    assert arrays["torque"].dims == ("position", "input", "side", "mesh")
    assert arrays["displacement"].sizes["component"] == 2
    mesh = next(iter(found.rates[1, keys[0], "rising"].torque))
    one = arrays["torque"].sel(position=1, input=keys[0], side="rising", mesh=mesh)
    assert float(one) == found.rates[1, keys[0], "rising"].torque[mesh]


def test_an_axis_that_cannot_be_turned_alone_is_left_out_or_refused():
    case = shipped("branches/split_torque_2")
    key = "gears.face1.axis[2]"
    assert key in [k for k, _ in ls.sensitivity(case, positions=[1]).skipped]
    with pytest.raises(ls.CaseError, match="not square"):
        ls.sensitivity(case, key)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("rings.4.flot", "is not in the case"),
        ("gears.1.support", "is no number"),
        ("rings.*.flot", "is not in the case"),
    ],
)
def test_what_is_no_input_is_told(key, said):
    with pytest.raises(ls.CaseError, match=said):
        ls.sensitivity(shipped("fgfbstts/limit_ring"), key)
