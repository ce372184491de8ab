"""Sensitivities against closed forms and differences of certified solves."""

import math
import tomllib

import numpy as np
import pytest
from tests.support import EVERY_SHIPPED, mostly_slow, shipped

import loadshare as ls
from benchmarks.random_trains.draw import draw
from benchmarks.sensitivities import FINE, Verdict, judged, one, problem, text
from loadshare.case.starter import starter_case
from loadshare.errors import CaseError
from loadshare.job import ways
from loadshare.study.parameter import Value
from loadshare.study.positions import certified
from loadshare.study.sensitivity import SIDES, Sensitivity, sensitivity
from loadshare.study.sensitivity.differences import differentiate
from loadshare.study.sensitivity.view import good


def about_to_leave() -> ls.Case:
    """Return a case whose pinion 4 has a float range that just frees its stop, to the last digit.

    The idlers are slightly off the line through the pinion, so that an arc holds it as well.
    """
    off_line = {f"gears.{g}.centre.distance": "525.6314 mm" for g in "6789"}
    case = shipped("fgfbstts/limit_ring").replace(off_line)
    found = ls.critical(case, "rings.4.float", "8 um", "9 um", positions=[1])
    (event,) = [e for e in found.events if "stop" in e.element]
    return case.replace({"rings.4.float": f"{event.value!r} um"})


def torques(case: ls.Case, key: str, value: Value, number: float) -> np.ndarray:
    """Return the torques [N·m] of the first position with an input set to a number of its unit."""
    changed = case.replace({key: value.at(number).text})
    (position,) = ls.solve(changed, positions=[1]).positions
    return np.array(list(position.torque.values()))


def test_the_closed_form():
    """T12 = T1/2 + (E_b − E_a)/(2 C1) with E_a = I12 E46/2 (reconstruction): I12 = 4.641."""
    found = sensitivity(shipped("fgfbstts/rigid_closed_form"), 'meshes."4-6".gap', positions=[1])
    c4 = 1 / 4.275e6 + 3**2 / 6.425e6
    c1 = 1 / 8.365e5 + 4.641**2 * (1 / 5e5 + c4 / 2)
    for side in SIDES:
        rates = found.rates[1, 'meshes."4-6".gap', side]
        assert rates.torque["1-2"] == pytest.approx(-4.641 / 2 / (2 * c1), rel=1e-9)
        assert rates.torque["1-3"] == pytest.approx(4.641 / 2 / (2 * c1), rel=1e-9)
        # Ω46 = 1 − E46/(C4 T24) if T24 does not change; it does, by I12 dT12.
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


def verdicts(case: ls.Case, found: Sensitivity, position: int = 1) -> dict[str, Verdict]:
    """Compare every derivative with one-sided differences of certified solves."""
    return {
        f"{item.key} {side}": judged(case, found, item, position, side)
        for item in found.inputs
        for side in SIDES
    }


def disagreeing(verdicts_by_key: dict[str, Verdict]) -> dict[str, Verdict]:
    """Return those beyond the stated errors, without differences, or without a reason."""
    return {k: v for k, v in verdicts_by_key.items() if v.outcome not in ("agrees", "undefined")}


@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("fgfbstts/limit_ring", ["rings.4.float", "rings.5.float", "errors.6.installation[1]"]),
        pytest.param(
            "fgfbstts/both_errors",
            ["errors.4.*", "gears.6.centre.angle", 'shafts."2-4".stiffness'],
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "fgfbstts/full_float",
            ["splines.4.*", "errors.6.eccentricity.amount"],
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "fgfbstts/spline_clearance",
            ["splines.4.*", "operating.power"],
            marks=pytest.mark.slow,
        ),
        pytest.param(
            "fgfbstts/all_elements",
            ['meshes."4-6".law.c[0]', "splines.5.*", "rings.5.float.*", "errors.9"],
            marks=pytest.mark.slow,
        ),
        ("star/floating_sun_5", ['meshes."sun-planet1".*', "gears.sun.base_radius"]),
        pytest.param("two_path/clocking_error", None, marks=pytest.mark.slow),
    ],
)
@pytest.mark.quick(2)
def test_differences_of_full_solves(name, keys):
    case = shipped(name)
    found = sensitivity(case, keys, positions=[1])
    assert found.inputs
    compared = verdicts(case, found)
    assert not disagreeing(compared)
    # Where anything moves, the stated error and that of the differences are both small enough.
    moving = [v for v in compared.values() if math.isfinite(v.stated) and v.stated < 1.0]
    assert moving
    assert np.median([v.stated for v in moving]) < 1e-7
    assert np.median([v.known for v in moving]) < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("name", EVERY_SHIPPED)
def test_differences_on_every_shipped_case(name):
    case = shipped(name)
    known = [i.key for i in sensitivity(case, positions=[1]).inputs]
    chosen = np.random.default_rng(5).permutation(known)[:40]
    found = sensitivity(case, [str(key) for key in chosen], positions=[1])
    assert not disagreeing(verdicts(case, found))


def outcomes(rows: list[dict]) -> list[str]:
    return [v["outcome"] for row in rows for v in row["verdicts"]]


@pytest.mark.parametrize(
    ("number", "key"),
    [
        # A mesh 7,000 times as stiff as the others, whose two gears move as one.
        (53, "gears.c21.base_radius"),
        (117, "splines.w2.bending_stiffness"),
        # The input is at its bound: there is one side only, and the usual step is too long for it.
        (128, 'meshes."i1a-q1".backlash'),
    ],
)
def test_stated_errors_do_not_drown_derivatives(number, key):
    _, case, position = problem(1, number)
    found = sensitivity(case, key, positions=[position])
    assert judged(case, found, found.inputs[0], position, "rising").outcome == "agrees"


def test_a_difference_goes_on_to_steps_before_an_event_that_is_near():
    """Less than 1e-5 deg below the value pinion 5 meets another arc, and the slopes change."""
    case = shipped("fgfbstts/tolerance").replace(
        {"errors.9.eccentricity.amount": "20.651960977181545 um"}
    )
    key = 'meshes."5-9".pressure_angle'
    rates = sensitivity(case, key, positions=[1]).rates[1, key, "falling"]
    digits = 11157.707  # differences of equilibria in 50 digits, known to 8
    assert abs(rates.torque["8-10"] - digits) <= rates.error.torque["8-10"] + 8.0
    assert rates.error.torque["8-10"] < 0.01 * digits


def test_a_gear_that_comes_to_float_has_no_displacement_to_that_side():
    """At the event, pinion 5 is on stop and arc; with more eccentricity it floats between arcs."""
    key = "errors.8.eccentricity.amount"
    put = shipped("fgfbstts/tolerance").replace({key: "0.8570800282942369 um"})
    found = sensitivity(put, key, positions=[1])
    assert np.isnan(found.rates[1, key, "rising"].displacement["5"]).all()


@pytest.mark.slow
def test_inputs_on_the_verge_are_differentiated_without_solves(monkeypatch):
    """Once it is found, the set of one side gives for every input what moves and what floats."""
    key = "errors.8.eccentricity.amount"
    put = shipped("fgfbstts/tolerance").replace({key: "0.8570800282942369 um"})
    asked = []
    monkeypatch.setattr(
        "loadshare.study.sensitivity.variation.certified",
        lambda *a: asked.append(a) or certified(*a),
    )
    counts = []
    for keys in ([key], [key, "errors.*.eccentricity.amount", "meshes.*.stiffness"]):
        asked.clear()
        found = sensitivity(put, keys, positions=[1])
        counts.append(len(asked))
    assert found.kinks
    assert len(found.inputs) > 10
    assert counts[1] <= counts[0] + 1


def test_drawn_and_critical_cases():
    rows = [{"number": k, **one(7, k)} for k in range(2, 3)]
    found_outcomes = outcomes(rows)
    assert set(found_outcomes) <= set(FINE)
    assert found_outcomes.count("agrees") >= 4
    assert f"| one-sided derivatives | {len(found_outcomes)} |" in text(rows)
    rows[0]["verdicts"][0]["outcome"] = "outside"
    assert "\n- 2: " in text(rows)


@pytest.mark.slow
def test_many_drawn_and_critical_cases():
    assert set(outcomes([one(8, k) for k in range(25)])) <= set(FINE)


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
        # Differences over 2 nm of shares that are accurate to 1e-13.
        assert rates.pair_share[mesh] == pytest.approx(slope, abs=1e-4 * abs(slope) + 1e-3)
    slope = (np.array(at[1].displacement["4"]) - at[0].displacement["4"]) / 2e-9
    assert rates.displacement["4"] == pytest.approx(slope, abs=1e-6)
    # Nothing holds the floating input pinion along its teeth, so it has no derivative.
    assert np.isnan(rates.displacement["1"]).any()
    assert (rates.displacement["10"] == 0.0).all()


@pytest.mark.parametrize("key", ["rings.4.float", "errors.6.installation[1]"])
@pytest.mark.quick(1)
def test_a_kink_has_a_derivative_to_each_side_and_says_so(key):
    """At the critical float the stop is about to open: nothing changes on one side."""
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
        # Differences over 0.1 nm (the load passes to the other arc 0.6 nm away) of torques accurate
        # to 1e-8 N·m.
        assert rates == pytest.approx(slope, rel=1e-5, abs=200.0)
        sizes.append(np.abs(rates).max())
    assert min(sizes) < 1e-3 * max(sizes)
    assert max(sizes) > 1e6


def test_a_pinion_that_floats_free_is_caught_by_its_arcs():
    """Nothing presses on it. An input that does has the slope of the arc that it is pressed onto,
    different on each side, and the kink is reported. The rest position remains undetermined.
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
        # First order in a step of 2e-6 rad, for torques accurate to 1e-9 N·m.
        assert list(rates.torque.values()) == pytest.approx(slope, rel=1e-3, abs=1e-2)
        assert np.isnan(rates.displacement["4"]).any()
        slopes.append(rates.torque["4-6"])
    assert slopes[0] != pytest.approx(slopes[1], rel=1e-5)
    # Room in a direction without force has no effect.
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
    """Without errors all branches are the largest, so Ω rises on either side."""
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
    named = {arrays[name].attrs["long_name"] for name in arrays.data_vars}
    assert len(named) == len(arrays.data_vars)
    mesh = next(iter(found.rates[1, keys[0], "rising"].torque))
    one = arrays["torque"].sel(position=1, input=keys[0], side="rising", mesh=mesh)
    assert float(one) == found.rates[1, keys[0], "rising"].torque[mesh]


def test_an_axis_that_cannot_be_turned_alone_is_left_out_or_refused():
    case = shipped("branches/split_torque_2")
    key = "gears.face1.axis[2]"
    assert key in [k for k, _ in ls.sensitivity(case, "gears.face1.*", positions=[1]).skipped]
    with pytest.raises(ls.CaseError, match="not at right angles"):
        ls.sensitivity(case, key)


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("gears.planet.support", "is not in the case.*Each copy has its own name: .*planet1"),
        ("errors.planet1.pin.radial", "There is no errors.planet1"),
        ("gears.*.teeth", "is a count: it has no derivatives"),
        ("gears.sun.teeth", "= 18: is a count: it has no derivatives"),
    ],
)
def test_what_was_meant_by_an_input_that_is_none_is_told(key, message):
    with pytest.raises(ls.CaseError, match=message):
        ls.sensitivity(shipped("planetary/four_planets"), key)


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("rings.4.flot", "is not in the case"),
        ("gears.1.support", "is not a number"),
        ("rings.*.flot", "is not in the case"),
        ("rings.4.float=rings.5.float", "is not one key"),
        ([("rings.4.float", "rings.5.float")], "is not one key"),
        ("title", "describes the case"),
    ],
)
def test_what_is_no_input_is_reported(key, message):
    case = shipped("fgfbstts/limit_ring").replace({"title": "5 GPa"})
    with pytest.raises(ls.CaseError, match=message):
        ls.sensitivity(case, key)


LAW = {"a": "0 rad", "b": "1e-6 rad/(N*m)", "c": "3e-6 rad/(N*m)^(2/3)"}


@pytest.mark.parametrize("law", [None, LAW], ids=["springs", "soft at first"])
def test_a_free_body_is_caught_where_it_falls(law):
    """A free input pinion is between two wheels. An angle that loads it across its teeth makes it
    move through the backlash onto a coast flank. The stiffness of that flank does not matter.
    """
    changes: dict[str, object] = {"gears.1.support": "free"}
    for mesh in ("1-2", "1-3"):
        changes[f'meshes."{mesh}".backlash'] = "150 um"
        if law:
            changes |= {f'meshes."{mesh}".law': law, f'meshes."{mesh}".stiffness': None}
    case = shipped("fgfbstts/base").replace(changes)
    key = 'meshes."1-3".pressure_angle'
    found = sensitivity(case, key, positions=[1])
    assert not disagreeing(verdicts(case, found))
    for side in SIDES:
        assert found.rates[1, key, side].torque["1-2"] == pytest.approx(-197.93, abs=0.005)
    assert set(found.kinks[0].elements) == {"1-2 coast", "1-3 coast"}


@pytest.mark.parametrize(
    ("key", "torque"),
    mostly_slow(
        [("march.revolutions", -2511.0), ("gears.10.base_radius", -6556.0)],
        ("gears.10.base_radius",),
    ),
)
def test_the_mesh_cycle_stands_still(key, torque):
    """A change that moves a mesh to its next position is not part of the derivative."""
    case = shipped("fgfbstts/all_elements")
    found = sensitivity(case, key, positions=[5, 16])
    for position in (5, 16):
        assert not disagreeing(verdicts(case, found, position))
    for side in SIDES:
        assert found.rates[5, key, side].torque["6-10"] == pytest.approx(torque, abs=0.5)


def test_elements_that_change_together_make_a_kink():
    """The pinion leaves its stop and its arc at one float: below they carry, above nothing does."""
    value = "2.976574096813504 um"
    case = shipped("fgfbstts/limit_ring").replace({"rings.4.float": value, "rings.5.float": value})
    found = sensitivity(case, "rings.5.float", positions=[1])
    falling, rising = (found.rates[1, "rings.5.float", s].torque["8-10"] for s in SIDES)
    assert falling == pytest.approx(4.2742e7, rel=1e-4)
    assert rising == 0.0
    assert set(found.kinks[0].elements) == {"ring 5: arc 8", "ring 5: upper stop"}
    assert not disagreeing(verdicts(case, found))


def test_an_error_covers_both_states_of_what_an_input_hardly_moves():
    """The float is 1e-15 m off its critical value: its arc carries 3e-7 N, or might be open.

    Differences of the reference in 50 digits over 1e-8 rad: -1.11e-3 N·m/rad; over 1e-4 rad the arc
    has opened, and nothing changes.
    """
    case = shipped("fgfbstts/limit_ring").replace({"rings.5.float": "2.9765740955634916 um"})
    found = sensitivity(case, "gears.5.centre.angle", positions=[1])
    for side in SIDES:
        rates = found.rates[1, "gears.5.centre.angle", side]
        for true in (-1.11e-3, 0.0):
            assert abs(rates.torque["8-10"] - true) <= rates.error.torque["8-10"]


def test_what_has_no_derivative_says_why():
    """Without backlash nothing stops the free pinion: there is no equilibrium on either side."""
    case = shipped("fgfbstts/base").replace({"gears.1.support": "free"})
    key = 'meshes."1-3".pressure_angle'
    found = sensitivity(case, key, positions=[1])
    for side in SIDES:
        assert np.isnan(list(found.rates[1, key, side].torque.values())).all()
        (remark,) = [r for r in found.remarks if r.side == side]
        assert "gear 1" in remark.message


def test_a_missing_derivative_is_shown_as_none_and_explained_once():
    """Its row used to show zeros, and its reason came once for every position."""
    case = shipped("fgfbstts/base").replace({"gears.1.support": "free"})
    key = 'meshes."1-3".pressure_angle'
    (made,) = sensitivity(case, key, positions=[1, 2])._view().tables
    assert made.texts == [[key, "20 deg", "–", "–"]]
    ways = [note for note in made.notes if note.startswith(key)]
    assert [note.split(": ")[1] for note in ways] == [
        f"has no derivative when it is {way}" for way in ("lowered", "raised")
    ]
    assert not any("position" in note for note in ways)


def test_the_change_over_a_whole_value_has_the_sign_of_the_slope():
    """The picture's bars have it."""
    key = 'meshes."9-10".pressure_angle'
    found = sensitivity(shipped("fgfbstts/limit_ring"), key, positions=[1])
    row = dict(
        zip(("input", "value", "slope", "whole"), found._view().tables[0].texts[0], strict=True)
    )
    (bar,) = found.plot().begin().spec["datasets"].values()
    assert row["slope"].startswith("-")
    assert float(row["whole"]) == pytest.approx(bar[0]["change"], rel=1e-3)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.23456, 1e-9, "+1.235"),
        (1.23456, 0.004, "+1.23"),
        (-1234.56, 20.0, "-1.2e+03"),
        (1.23456, 0.06, "+1"),
        (1.23456, 0.7, "0 ± 2"),
        (0.0, 0.0, "0"),
        (0.0, 3.2e-7, "0 ± 4e-07"),
        (math.nan, math.nan, "–"),
    ],
)
def test_printed_digits_are_covered_by_the_error(value, error, text):
    assert good(value, error) == text


def in_groups(of):
    """Return a function of groups of numbers that applies a function of one number."""

    def group(numbers):
        try:
            return [of(number) for number in numbers]
        except CaseError as error:
            return error

    return lambda groups: [group(numbers) for numbers in groups]


@pytest.mark.parametrize("number", [0.0, 1.7, -3.2e4])
def test_differences_state_an_error_that_covers(number):
    """For a sine, and on each side of a kink; the errors are also small enough to be useful."""
    value = Value(number, "")
    rate = 1.0 / max(abs(number), 1.0)

    def smooth(at: float) -> np.ndarray:
        return np.array([math.sin(rate * at + 1.0), 3.0])

    found = differentiate(in_groups(smooth), value, np.array([2e-16, 0.0]))
    exact = rate * math.cos(rate * number + 1.0)
    assert not found.kinked
    assert abs(found.rising.value[0] - exact) <= found.rising.error[0] < 1e-8 * rate
    assert found.rising.value[1] == found.rising.error[1] == 0.0

    def bent(at: float) -> np.ndarray:
        return np.array([max(at - number, 0.0) + rate * at])

    found = differentiate(in_groups(bent), value, np.array([2e-16]))
    assert found.kinked
    for side, slope in ((found.falling, rate), (found.rising, 1.0 + rate)):
        assert abs(side.value[0] - slope) <= side.error[0] + 1e-9

    def bounded(at: float) -> np.ndarray:
        if at > number:
            raise CaseError([])
        return smooth(at)

    found = differentiate(in_groups(bounded), value, np.array([2e-16, 0.0]))
    assert isinstance(found.rising, CaseError)
    assert abs(found.falling.value[0] - exact) <= found.falling.error[0]


def test_the_judge_sees_a_matrix_as_results_do() -> None:
    """Displacements are in the gear's plane, and off-diagonal entries are one input."""
    case = on_a_matrix(2e8, 1e8, 3e8)
    found = sensitivity(case, "gears.a.support[0][1]")
    assert judged(case, found, found.inputs[0], 1, "rising").outcome == "agrees"


def test_a_ring_that_gains_play() -> None:
    """Its gear moves as far as the new play allows, in the direction of the load; all else is
    two-sided.
    """
    matrix = on_a_matrix(2e8, 1e8, 3e8).to_dict()
    del matrix["gears"]["a"]["support"]
    case = ls.Case({**matrix, "rings": {"a": {"radius": "0 m"}}})
    found = sensitivity(case)
    assert not found.kinks
    assert not [r for r in found.remarks if "differenced" in r.message]
    moved = found.rates[1, "rings.a.radius", "rising"].displacement["a"]
    assert np.linalg.norm(moved) == pytest.approx(1.0, rel=1e-9)
    played = case.replace({"rings.a.radius": "1 um"})
    there = np.array(ls.solve(played).positions[0].displacement["a"])
    assert moved == pytest.approx(there / 1e-6, abs=1e-6)


def test_a_bearing_without_clearance_is_on_no_verge() -> None:
    matrix = on_a_matrix(2e8, 1e8, 3e8).to_dict()
    del matrix["gears"]["a"]["support"]
    bearing = {"clearance": "0 m", "stiffness": "3e8 N/m"}
    case = ls.Case({**matrix, "bearings": {"a": bearing}})
    assert not sensitivity(case, "operating.torque").kinks


def test_differences_are_as_fine_as_what_they_difference():
    """A zero input suggests no step; a law δ^(3/2) near its start, at a thousandth of the usual
    step, does.
    """
    before = 1e-7
    value = Value(0.0, "rad")

    def soft(at: float) -> np.ndarray:
        return np.array([math.copysign(abs(before + at) ** 1.5, before + at)])

    found = differentiate(in_groups(soft), value, np.array([2e-16 * before**1.5]))
    exact = 1.5 * math.sqrt(before)
    assert abs(found.rising.value[0] - exact) <= found.rising.error[0] < 1e-6 * exact


def test_friction_of_a_torque_that_is_round_off_has_no_sign():
    """No shaft and no load turns gear r1; the friction of its spline follows a torque of zero."""
    case = draw(2, 22)
    assert case.splines["r1"].friction
    found = sensitivity(case, "gears.r1.base_radius", positions=[1])
    assert not disagreeing(verdicts(case, found))
    rates = [found.rates[1, "gears.r1.base_radius", side] for side in SIDES]
    assert rates[0].torque == pytest.approx(rates[1].torque, rel=1e-6, abs=1e-3)


def test_a_body_that_nothing_holds_is_reported_at_once(monkeypatch):
    """Two flanks hold pinion 1; it drifts as soon as the push of one changes direction."""
    monkeypatch.setattr(ways, "search", lambda *_: pytest.fail("a search was made"))
    key = 'meshes."1-2".pressure_angle'
    found = sensitivity(shipped("fgfbstts/limit_ring"), key, positions=[1])
    messages = {remark.side: remark.message for remark in found.remarks}
    assert set(messages) == set(SIDES)
    assert all("nothing balances the load on gear 1 x" in message for message in messages.values())
    assert all(math.isnan(v) for side in SIDES for v in found.rates[1, key, side].torque.values())


def on_a_matrix(xx: float, xy: float, yy: float) -> ls.Case:
    """Return a pair whose driver yields in its bearing under a force known from statics."""
    rows = [[f"{k!r} N/m" for k in row] for row in ([xx, xy], [xy, yy])]
    return ls.Case(
        {
            "operating": {"input": "a", "output": "b", "torque": "1000 N*m"},
            "gears": {
                "a": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"], "support": rows},
                "b": {"base_radius": "100 mm", "centre": ["160 mm", "0 mm"]},
            },
            "meshes": {"a-b": {"stiffness": "5e5 N*m/rad"}},
        }
    )


@pytest.mark.parametrize(
    "matrix",
    [
        (2e8, 1e8, 3e8),
        (2e8, 0.0, 2e8),
        (2e8, 0.5e8, 2e8),
        (1e8, 0.0, 3e8),
        (3e8, 0.0, 1e8),
        (2e8, -0.1e8, 2e8),
    ],
    ids=str,
)
@pytest.mark.quick(2)
def test_entries_of_a_support_s_matrix(matrix) -> None:
    """K x = p, so dx = −K⁻¹ dK x, even if the principal directions jump or are arbitrary."""
    case, k = on_a_matrix(*matrix), np.array([matrix[:2], matrix[1:]])
    x = np.array(ls.solve(case).positions[0].displacement["a"])
    assert np.linalg.norm(k @ x) == pytest.approx(1000.0 / 0.05, rel=1e-12)
    found = sensitivity(case, "gears.a.support")
    entries = {"[0][0]": (0, 0), "[0][1]": (0, 1), "[1][1]": (1, 1)}
    assert [i.key for i in found.inputs] == [f"gears.a.support{at}" for at in entries]
    for at, (row, column) in entries.items():
        change = np.zeros((2, 2))
        change[row, column] = change[column, row] = 1.0
        exact = -np.linalg.solve(k, change @ x)
        for side in SIDES:
            rates = found.rates[1, f"gears.a.support{at}", side]
            off = np.abs(rates.displacement["a"] - exact)
            assert (off <= rates.error.displacement["a"]).all()
            assert off.max() <= 1e-6 * np.abs(exact).max()
            assert abs(rates.torque["a-b"]) <= rates.error.torque["a-b"]
    # The set is the same in all directions, so no differences between solves are needed.
    assert not found.remarks


def test_a_set_that_cannot_act_is_tried_without_a_warning() -> None:
    found = ls.sensitivity(
        ls.Case(tomllib.loads(starter_case("star", "star"))).replace(
            {
                **{f"gears.planet{k}.support": None for k in (2, 3, 4, 5)},
                "gears.planet3.temperature": "8 K",
                "gears.ring.ovalisation": "rim",
                "gears.ring.rim": "30 mm",
                "errors": {"planet5": {"installation": ["8.4 um", "2 um"]}},
                "bearings": {
                    "ring": {"clearance": "26.5 um", "stiffness": "rigid"},
                    "planet3": {
                        "clearance": "0.3 um",
                        "offset": ["19.5 um", "0 um"],
                        "stiffness": "rigid",
                    },
                },
                "gears.sun.support": None,
                "rings.sun": {"radius": "18 um"},
                "splines.planet5": {
                    "bending_stiffness": "1e8 N/m",
                    "clearance": "70 um",
                    "friction": 0.1,
                    "radius": "30 mm",
                },
            }
        ),
        "splines.planet5.bending_stiffness",
    )
    assert len(found.inputs) == 1


@pytest.mark.parametrize("key", ['meshes."in-wheelA".table.deflection[2]', "rings.4.float"])
def test_a_value_below_all_steps_of_its_kind_has_both_sides(key):
    """Steps in proportion to 1e-4 rad or 1 um would pass the next value of a table, or zero."""
    if key == "rings.4.float":
        case, value, unit = shipped("fgfbstts/limit_ring").replace({key: "1e-9 m"}), 1e-9, "m"
    else:
        table = {
            "torque": [f"{t} N*m" for t in (50, 100, 300, 400)],
            "deflection": [f"{d}e-8 rad" for d in (1, 3, 6, 8)],
        }
        case = shipped("two_path/clocking_error").replace(
            {'meshes."in-wheelA"': {"pressure_angle": "20 deg", "table": table}}
        )
        value, unit = 6e-8, "rad"
    found = ls.sensitivity(case, [key], positions=[1])
    low, high = (
        ls.solve(case.replace({key: f"{value * by!r} {unit}"})).positions[0].torque
        for by in (0.8, 1.2)
    )
    for side in SIDES:
        rates = found.rates[1, key, side]
        slopes = {mesh: (high[mesh] - low[mesh]) / (0.4 * value) for mesh in low}
        assert rates.torque == pytest.approx(slopes, rel=1e-2, abs=1e-3 * max(slopes.values()))
