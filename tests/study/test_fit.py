"""Comparison with measurements, and inputs fitted to them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls

SHARES = ("6-10", "7-10", "8-10", "9-10")


def measured(case: ls.Case, uncertainty: float = 0.01, **changes: object) -> dict[str, object]:
    """Return the pair shares that a changed case would show, as a measurement."""
    found = ls.solve(case.replace(changes) if changes else case, positions=[1]).positions[0]
    shares = {m: found.pair_share[m] for m in SHARES}
    return {"position": 1, "pair_share": shares, "uncertainty": uncertainty}


def both_errors(**measurements: object) -> ls.Case:
    return shipped("fgfbstts/both_errors").replace(
        {f"measured.{name}": m for name, m in measurements.items()}
    )


def test_every_kind_of_figure_is_compared():
    case = both_errors(
        torque={"position": 2, "torque": {"1-2": "1107.7 N*m"}, "torque_uncertainty": "5 N*m"},
        mean={"share": {"6-10": 0.9}, "pair_share": {"6-10": 0.95}, "uncertainty": 0.1},
        largest={"omega": {"II": 1.0, "system": 1.1}, "pair_omega": {"I": 1.0}, "uncertainty": 0.5},
    )
    found = ls.compare(case)
    result = ls.solve(case)
    computed = {d.target.key: d.computed for d in found.deviations}
    assert computed == {
        'measured.torque.torque."1-2"': result.positions[1].torque["1-2"],
        'measured.mean.share."6-10"': pytest.approx(float(result.share.sel(mesh="6-10").mean())),
        'measured.mean.pair_share."6-10"': pytest.approx(
            float(result.pair_share.sel(mesh="6-10").mean())
        ),
        "measured.largest.omega.II": result.omega["II"],
        "measured.largest.omega.system": result.omega["system"],
        "measured.largest.pair_omega.I": result.pair_omega["I"],
    }
    first = found.deviations[0]
    assert first.difference == pytest.approx(first.computed - 1107.7)
    assert first.deviations == pytest.approx(first.difference / 5.0)
    assert found.chi_square == pytest.approx(sum(d.deviations**2 for d in found.deviations))
    assert found.to_frame()["computed"].tolist() == [d.computed for d in found.deviations]


def test_a_single_position_is_solved_where_only_one_is_measured():
    found = ls.compare(both_errors(one=measured(shipped("fgfbstts/both_errors"))))
    assert [p.position for p in found.result.positions] == [1]
    assert found.chi_square == 0.0


def test_inputs_are_found_again():
    """The shares of a case with known errors lead back to these errors."""
    truth = {"errors.6.installation.direction": "330 deg", "errors.8.installation.amount": "80 um"}
    base = shipped("fgfbstts/both_errors")
    case = base.replace({"measured.bench": measured(base, **truth)})
    bounds = {
        "errors.6.installation.direction": ("300 deg", "380 deg"),
        "errors.8.installation.amount": ("0 mm", "0.2 mm"),
    }
    found = ls.fit(case, bounds)
    direction, amount = found.unknowns
    assert direction.value == pytest.approx(330.0, abs=1e-6)
    assert amount.value == pytest.approx(0.08, abs=1e-9)
    assert amount.start == pytest.approx(0.05)
    assert found.chi_square < 1e-15
    assert found.freedom == 2
    assert found.warnings == ()
    assert ls.compare(found.case).chi_square < 1e-15
    assert found.values["errors.8.installation.amount"].endswith(" mm")


def test_fits_can_be_compared():
    """Comparing their arrays is ambiguous, so a fit could not be found in a list."""
    case = shipped("fgfbstts/installation_error").replace(
        {"measured.bench": {"position": 1, "pair_share": {"6-10": 0.8}, "uncertainty": 0.01}}
    )
    bounds = {f"errors.6.installation[{k}]": ("-90 um", "100 um") for k in (0, 1)}
    one, again = ls.fit(case, bounds), ls.fit(case, bounds)
    other = replace(one, singular_values=2.0 * one.singular_values)
    assert [other, again].index(one) == 1
    assert {one, again, other} == {one, other}


def test_the_covariance_is_that_of_the_linear_problem():
    """For one input and four shares, σ² = 1/Σ(slope/uncertainty)², with slopes from full solves."""
    base = shipped("fgfbstts/installation_error")
    key = "errors.6.installation[0]"
    case = base.replace({"measured.bench": measured(base, 0.01, **{key: "40 um"})})
    (unknown,) = ls.fit(case, {key: ("0 um", "100 um")}).unknowns
    at = [
        ls.solve(base.replace({key: f"{v} um"}), positions=[1]).positions[0] for v in (39.9, 40.1)
    ]
    slopes = [(at[1].pair_share[m] - at[0].pair_share[m]) / 0.2 for m in SHARES]
    assert unknown.value == pytest.approx(40.0, abs=1e-7)
    # The shares are slightly curved over 0.2 µm.
    assert unknown.deviation == pytest.approx(0.01 / math.hypot(*slopes), rel=1e-5)


def test_inputs_that_the_data_cannot_tell_apart_are_named():
    base = shipped("fgfbstts/installation_error").replace({'meshes."5-8".backlash': "1 mm"})
    case = base.replace({"measured.bench": measured(base)})
    keys = ("errors.6.installation[0]", "errors.6.installation[1]", 'meshes."5-8".backlash')
    bounds = {
        keys[0]: ("0 um", "100 um"),
        keys[1]: ("-90 um", "110 um"),
        keys[2]: ("0.9 mm", "1.2 mm"),
    }
    found = ls.fit(case, bounds)
    assert f"The data cannot tell {keys[0]}, {keys[1]} apart." in found.warnings
    assert [math.isinf(u.deviation) for u in found.unknowns[:2]] == [True, True]
    assert np.isnan(found.correlation[0, 1])
    # A coast flank that stays open contains no information.
    assert f"The data do not determine {keys[2]}." in found.warnings
    assert found.singular_values[-1] < 1e-6 * found.singular_values[0]


def test_more_inputs_than_figures_leave_no_freedom():
    case = shipped("fgfbstts/installation_error").replace(
        {"measured.bench": {"position": 1, "pair_share": {"6-10": 0.8}, "uncertainty": 0.01}}
    )
    found = ls.fit(case, {f"errors.6.installation[{k}]": ("-90 um", "100 um") for k in (0, 1)})
    assert found.freedom == -1
    assert ", 0 degrees of freedom" in str(found)


def test_an_input_that_moves_nothing_is_not_determined():
    """This holds even alone: there is no other input to compare its effect with."""
    measured = {"position": 1, "pair_share": {"8-10": 1.02}, "uncertainty": 0.01}
    case = shipped("fgfbstts/installation_error").replace({"measured.bench": measured})
    found = ls.fit(case, {"errors.6.installation[0]": ("0 um", "100 um")})
    assert math.isinf(found.unknowns[0].deviation)
    assert found.warnings == ("The data do not determine errors.6.installation[0].",)


def test_an_input_that_a_weak_one_can_move_is_not_determined():
    """With one share and two unknowns, the first can compensate any value of the second.

    The second affects the share about a tenth as much as the first. With the second at either end,
    the first is fitted to values many standard deviations apart, so it must not be given a finite
    deviation.
    """
    base = shipped("fgfbstts/installation_error")
    one = {"position": 1, "pair_share": {"6-10": 0.8}, "uncertainty": 0.01}
    case = base.replace({"measured.bench": one})
    keys = [f"errors.6.installation[{k}]" for k in (0, 1)]
    bounds = ("-90 um", "100 um")
    found = ls.fit(case, dict.fromkeys(keys, bounds))
    assert found.warnings == (f"The data cannot tell {keys[0]}, {keys[1]} apart.",)
    assert [math.isinf(u.deviation) for u in found.unknowns] == [True, True]
    held = [ls.fit(case.replace({keys[1]: end}), {keys[0]: bounds}).unknowns[0] for end in bounds]
    apart = abs(held[0].value - held[1].value)
    assert apart > 5.0 * max(unknown.deviation for unknown in held)


def test_tied_keys_are_one_unknown():
    base = shipped("fgfbstts/limit_ring")
    truth = {"rings.4.float": "2 um", "rings.5.float": "2 um"}
    case = base.replace({"measured.bench": measured(base, **truth)})
    found = ls.fit(case, {"rings.*.float": ("0 um", "5 um")})
    (unknown,) = found.unknowns
    assert unknown.parameter.keys == ("rings.4.float", "rings.5.float")
    assert unknown.value == pytest.approx(2.0, abs=1e-7)


def test_a_fit_beyond_its_bounds_stands_at_one_and_says_so():
    base = shipped("fgfbstts/installation_error")
    key = "errors.6.installation[0]"
    case = base.replace({"measured.bench": measured(base, **{key: "150 um"})})
    found = ls.fit(case, {key: ("0 um", "100 um")})
    assert found.unknowns[0].at_bound
    assert found.unknowns[0].value == 100.0
    assert f"{key} is at its bound." in found.warnings


@pytest.mark.slow
def test_several_starts_find_what_one_misses():
    """A distant direction leads into another valley; the best of several starts is taken."""
    base = shipped("fgfbstts/both_errors")
    key = "errors.9.installation.direction"
    shares = measured(base)
    one = {**shares, "pair_share": {"9-10": shares["pair_share"]["9-10"]}}
    case = base.replace({"measured.bench": one, key: "80 deg"})
    found = ls.fit(case, {key: ("0 deg", "360 deg")}, starts=4, seed=1)
    again = ls.fit(case, {key: ("0 deg", "360 deg")}, starts=4, seed=1)
    assert len(found.starts) == 4
    assert found.chi_square == pytest.approx(min(found.starts), abs=1e-12)
    assert found.chi_square < 1e-10
    assert again.unknowns == found.unknowns


@pytest.mark.parametrize(
    ("unknowns", "message"),
    [
        ({}, "has no unknown"),
        ({"rings.4.float": ("3 um", "3 um")}, "is not a range"),
        ({"gears.1.teeth": (20, 30)}, "is a count"),
        ({"rings.4.float": ("1 um", "2 um", "3 um")}, "is not a range"),
        ({"rings.4.float": ("1 um", "2 N")}, "cannot be expressed"),
        ({"rings.4.flot": ("1 um", "2 um")}, "Did you mean float"),
        ({"rings.*.float": ("1 um", "2 um"), "rings.4.float": ("1 um", "3 um")}, "is set by"),
    ],
)
def test_what_cannot_be_fitted_is_reported(unknowns, message):
    base = shipped("fgfbstts/limit_ring")
    case = base.replace({"measured.bench": measured(base)})
    with pytest.raises(ls.CaseError, match=message):
        ls.fit(case, unknowns)


@pytest.mark.parametrize("starts", [0, -1, 1.5, None])
def test_a_fit_starts_at_least_once(starts):
    base = shipped("fgfbstts/limit_ring")
    case = base.replace({"measured.bench": measured(base)})
    with pytest.raises(ValueError, match=f"starts {starts}; allowed: a whole number from 1 on"):
        ls.fit(case, {"rings.4.float": ("1 um", "2 um")}, starts=starts)


def test_a_measurement_changes_no_mechanics():
    base = shipped("fgfbstts/both_errors")
    study = {"study.one": {"kind": "compare"}}
    case = base.replace({"measured.bench": measured(base), **study})
    assert case.hash == base.hash
    assert case != base


def test_nothing_measured_is_reported():
    with pytest.raises(ls.CaseError, match="contains no measurement"):
        ls.compare(shipped("fgfbstts/limit_ring"))


def test_the_entries_off_a_support_s_diagonal_are_one_unknown() -> None:
    """If they are tied, the fit recovers them from torques, although neither can vary alone."""
    matrix = [["2e8 N/m", "0.6e8 N/m"], ["0.6e8 N/m", "3e8 N/m"]]
    tied = ("gears.s.support[0][1]", "gears.s.support[1][0]")
    case = ls.Case(
        {
            "operating": {"input": "s", "output": "o", "torque": "300 N*m"},
            "gears": {
                "s": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"], "support": matrix},
                "i1": {"base_radius": "80 mm", "centre": ["0 mm", "140 mm"]},
                "i2": {"base_radius": "80 mm", "centre": ["0 mm", "-140 mm"]},
                "o": {"base_radius": "160 mm", "centre": ["215 mm", "0 mm"]},
            },
            "meshes": {
                "s-i1": {"stiffness": "5e5 N*m/rad"},
                "s-i2": {"stiffness": "4e5 N*m/rad", "gap": "0.1 mrad"},
                "i1-o": {"stiffness": "5e5 N*m/rad"},
                "i2-o": {"stiffness": "6e5 N*m/rad"},
            },
        }
    )
    torque = ls.solve(case).positions[0].torque
    measured = {mesh: f"{value!r} N*m" for mesh, value in torque.items()}
    data = {"position": 1, "torque": measured, "torque_uncertainty": "0.01 N*m"}
    start = dict.fromkeys(tied, "0.4e8 N/m") | {"measured.rig": data}
    found = ls.fit(case.replace(start), {tied: ("0.2e8 N/m", "0.9e8 N/m")})
    assert found.chi_square < 1e-12
    assert found.unknowns[0].value == pytest.approx(0.6e8, rel=1e-6)


def test_a_fit_starts_where_the_case_is_or_in_the_middle():
    case = both_errors(bench=measured(shipped("fgfbstts/both_errors")))
    key = "errors.6.installation.amount"
    (within,) = ls.fit(case, {key: ("45 um", "59 um")}).unknowns
    (beyond,) = ls.fit(case, {key: ("55 um", "59 um")}).unknowns
    assert (within.start, beyond.start) == (50.0, 57.0)


def test_a_figure_of_what_carries_no_load_is_reported():
    """A stage without load at any of its positions has no share."""
    case = shipped("fgfbstts/installation_error").replace(
        {
            "operating.power": None,
            "operating.torque": ["0 N*m", "500 N*m", "500 N*m", "500 N*m", "500 N*m"],
            "measured.mean": {"pair_share": {"6-10": 0.8}, "uncertainty": 0.01},
        }
    )
    unknown = {"errors.6.installation[0]": ("0 um", "100 um")}
    for ask in (ls.compare, lambda case: ls.fit(case, unknown)):
        with pytest.raises(ls.CaseError, match=r'mean\.pair_share\."6-10".*carries no load'):
            ask(case)
    there = {"measured.mean.position": 2}
    assert ls.compare(case.replace(there)).deviations


def one_share(*values: float) -> ls.Case:
    """Return a case with one share that was measured several times."""
    shares = {
        f"m{k}": {"position": 1, "pair_share": {"6-10": v}, "uncertainty": 0.01}
        for k, v in enumerate(values)
    }
    return both_errors(**shares)


AMOUNT = "errors.6.installation.amount"


@pytest.mark.parametrize(
    ("values", "chi", "contradict"),
    [
        # Equal weights meet in the middle: χ² = 2 (0.1/0.01)² and 2 (0.02/0.01)².
        ((0.8, 1.0), 200.0, True),
        ((0.88, 0.92), 8.0, False),
        # No value between the bounds is close; there is no degree of freedom.
        ((7.0,), None, True),
    ],
)
def test_figures_that_contradict_one_another_are_reported(values, chi, contradict):
    """For one degree of freedom, χ² exceeds 10.83 once in a thousand."""
    found = ls.fit(one_share(*values), {AMOUNT: ("0 mm", "0.2 mm")})
    if chi is not None:
        assert found.chi_square == pytest.approx(chi, rel=1e-6)
    assert any("contradict" in line and "10.8" in line for line in found.warnings) is contradict


def test_bounds_may_be_a_text():
    """The command gives them so; each letter of the text used to be taken for a bound."""
    case = one_share(0.9)
    (by_text,) = ls.fit(case, {AMOUNT: "0 mm:0.2 mm"}).unknowns
    (by_pair,) = ls.fit(case, {AMOUNT: ("0 mm", "0.2 mm")}).unknowns
    assert by_text == by_pair


@pytest.mark.parametrize("bounds", [5, None, "0.1 mm", ()])
def test_what_is_no_range_is_reported(bounds):
    with pytest.raises(ls.CaseError, match=r"installation\.amount.*Allowed: lowest and highest"):
        ls.fit(one_share(0.9), {AMOUNT: bounds})


def test_a_bound_that_makes_no_case_is_named():
    """The best value is at zero; the message used to name a trial beyond it, "-0.00945... mm"."""
    with pytest.raises(ls.CaseError, match=r'"-0\.2 mm": is negative.*The bound -0\.2 mm'):
        ls.fit(one_share(1.3), {AMOUNT: ("-0.2 mm", "0.2 mm")})


def test_a_start_in_a_flat_place_does_not_blame_the_data():
    """From 11 µm on, floats touch nothing and change no share; the data are those of 4 µm."""
    base = shipped("fgfbstts/limit_ring")
    floats = ("rings.4.float", "rings.5.float")
    data = measured(base, 0.001, **dict.fromkeys(floats, "4 um"))
    case = base.replace({**dict.fromkeys(floats, "11 um"), "measured.bench": data})
    bounds = {"rings.*.float": ("0 um", "12 um")}
    flat, better = (ls.fit(case, bounds, starts=starts) for starts in (1, 4))
    idle, far = flat.warnings
    assert idle == "Where the search ended, the figures do not depend on rings.*.float."
    assert "more starting points are needed" in far
    assert better.unknowns[0].value == pytest.approx(4.0, abs=1e-6)
    assert better.warnings == ()


def test_an_input_that_the_data_bound_to_one_side_only_is_not_determined():
    """Beyond 8.35 µm float 4 touches nothing; 8.35 µm used to be found, to within 0.25 µm."""
    base, key = shipped("fgfbstts/limit_ring"), "rings.4.float"
    case = base.replace({key: "4 um", "measured.bench": measured(base, 0.001, **{key: "10 um"})})
    found = ls.fit(case, {key: ("0 um", "12 um")})
    assert found.unknowns[0].value == pytest.approx(8.34992, abs=1e-4)
    assert found.unknowns[0].deviation == math.inf
    assert found.warnings == (f"The data do not determine {key} to one side of its value.",)


def test_one_figure_is_one_in_words():
    case = shipped("fgfbstts/limit_ring").replace(
        {"measured.a": {"omega": {"II": 1.0}, "uncertainty": 0.01}}
    )
    assert "over 1 figure'" in str(ls.compare(case).plot().begin().spec)
