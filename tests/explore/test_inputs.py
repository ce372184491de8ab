"""What a page may change, and what it may not."""

from __future__ import annotations

import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.case.keys import dotted
from loadshare.errors import CaseError
from loadshare.explore.inputs import PageInputs, _step
from loadshare.study.parameter import read_value
from loadshare.study.sensitivity.inputs import inputs_of

NAMES = ("fgfbstts/all_elements", "nrel_5mw/gearbox", "planetary/four_planets", "two_path/nasa")


@pytest.mark.parametrize("name", NAMES)
def test_every_number_of_a_case_is_an_input(name):
    case = shipped(name)
    inputs = PageInputs(case).every
    wanted = [i.key for i in inputs_of(case, None) if not i.key.startswith(("errors", "study"))]
    assert set(wanted) <= set(inputs)
    for gear in case.gears:
        assert f"{dotted(('errors', gear, 'installation'))}.amount" in inputs


@pytest.mark.parametrize("name", NAMES)
def test_sliders_hold_their_value_and_have_round_steps(name):
    for one in PageInputs(shipped(name)).every.values():
        assert one.low <= one.number <= one.high, one
        assert one.low < one.high
        assert one.whole or 900 <= (one.high - one.low) / one.step <= 3000, one
        assert one.about


def test_a_gear_named_like_a_key_is_described_as_a_gear():
    inputs = PageInputs(shipped("planetary/four_planets")).every
    assert inputs["gears.carrier.centre[0]"].about == inputs["gears.sun.centre[0]"].about


def test_round_steps():
    assert [_step(w) for w in (1.0, 3.0, 7.0, 17.0)] == [0.001, 0.002, 0.005, 0.01]


def test_what_makes_no_case_is_never_at_the_end_of_a_slider_of_a_size():
    """If zero is not allowed, the slider does not reach it."""
    inputs = PageInputs(shipped("fgfbstts/all_elements"))
    for key in ("rings.5.stiffness", "splines.4.bending_stiffness", "operating.speed"):
        one = inputs.every[key]
        inputs.case.replace({key: f"{one.low!r} {one.unit}"})
        inputs.case.replace({key: f"{one.high!r} {one.unit}"})


def test_a_part_of_an_error_keeps_the_others():
    inputs = PageInputs(shipped("fgfbstts/limit_ring"))
    changes = inputs.changes({"errors.6.installation.amount": "50 um"})
    assert changes == {
        "errors.6.installation": {"amount": "50 um", "direction": "90.0 deg"},
    }
    inputs = PageInputs(shipped("fgfbstts/all_elements"))
    both = {"errors.7.eccentricity.amount": "9 um", "errors.7.eccentricity.phase": "3 deg"}
    (table,) = inputs.changes(both).values()
    assert table == {"amount": "9 um", "direction": "0 deg", "phase": "3 deg"}
    inputs.case.replace(inputs.changes(both))


def test_an_error_that_the_case_cannot_have_is_not_offered():
    """Nothing determines how far gears of this case turn, so an eccentricity is not possible."""
    assert not [
        key for key in PageInputs(shipped("fgfbstts/limit_ring")).every if "eccentric" in key
    ]


def test_size_and_direction_say_what_the_components_say():
    case = shipped("fgfbstts/limit_ring")
    inputs = PageInputs(case)
    turned = case.replace(inputs.changes({"errors.9.installation.direction": "-90 deg"}))
    torque = [ls.solve(c, positions=[1]).positions[0].torque for c in (case, turned)]
    assert torque[1] == pytest.approx(torque[0], rel=1e-9)


def test_errors_of_three_components_stay_numbers():
    case = shipped("fgfbstts/limit_ring").replace(
        {"errors.6.installation": ["1 um", "2 um", "3 um"]}
    )
    keys = PageInputs(case).every
    assert "errors.6.installation[2]" in keys
    assert "errors.6.installation.amount" not in keys


@pytest.mark.parametrize(
    "key",
    [
        'meshes."4-6".law_file',
        'meshes."4-6".geometry',
        "extends",
        "title",
        "gears",
        "gears.4.support",
        "rings.4",
        "study.x.samples",
        "rings.4.neighbours[0]",
        "__class__",
        "",
    ],
)
def test_no_key_but_those_of_the_list(key):
    with pytest.raises(CaseError, match="is not an input"):
        PageInputs(shipped("fgfbstts/limit_ring")).changes({key: "/etc/passwd"})


@pytest.mark.parametrize("value", [None, True, [], {}, ["1 um"], {"a": 1}, "9" * 300])
def test_a_value_is_a_text_or_a_number(value):
    with pytest.raises(CaseError):
        PageInputs(shipped("fgfbstts/limit_ring")).changes({"rings.4.float": value})


def test_names_with_a_star_and_joined_keys():
    inputs = PageInputs(shipped("fgfbstts/limit_ring"))
    assert inputs.keys("rings.*.float") == ("rings.4.float", "rings.5.float")
    assert inputs.keys("rings.5.float = rings.4.clearance") == (
        "rings.5.float",
        "rings.4.clearance",
    )
    for wrong, why in (
        ("rings.*.flaot", "is not a number"),
        ("gaers.*.centre", "matches no key"),
        ("gears.*.support", "is not a number"),
        ("rings.4.float=operating.power", "different kinds"),
        ('a"b', "is not a key path|is not a number"),
    ):
        with pytest.raises(CaseError, match=why):
            inputs.keys(wrong)


def test_units_of_inputs_are_those_of_the_case():
    for one in PageInputs(shipped("fgfbstts/all_elements")).every.values():
        value = read_value(one.text)
        assert (value.number, value.unit) == (one.number, one.unit)


@pytest.mark.parametrize(("axis", "matters"), [([0.0, 0.0, -1.0], True), ("y", False)])
def test_directions_count_against_the_axis_of_the_gear(axis, matters):
    """The components of an error that a page shows are those of the error itself."""
    places = {"s": (30, 0), "i1": (60, 96), "i2": (60, -96), "o": (150, 0)}
    gears = {
        name: {"base_radius": f"{radius} mm", "centre": [f"{x} mm", "0 mm"], "axis": axis}
        for name, (radius, x) in places.items()
    }
    gears["o"]["type"] = "internal"
    for idler in ("i1", "i2"):
        gears[idler]["support"] = "1e8 N/m"
    case = ls.Case(
        {
            "operating": {"input": "s", "output": "o", "torque": "100 N*m"},
            "gears": gears,
            "meshes": {
                name: {"stiffness": "1e6 N*m/rad"} for name in ("s-i1", "s-i2", "i1-o", "i2-o")
            },
            "errors": {"i1": {"installation": ["30 um", "40 um"]}},
            "stages": {"I": {"meshes": ["s-i1", "s-i2"]}},
        }
    )
    key, inputs = "errors.i1.installation.amount", PageInputs(case)
    same = case.replace(inputs.changes({key: inputs.every[key].text}))
    share, again = (ls.solve(c).positions[0].share["s-i1"] for c in (case, same))
    assert (abs(share - 1.0) > 0.1) is matters
    assert again == pytest.approx(share, rel=1e-9)
