"""Samples as arrays: every key that becomes an array means the same as in a case file.

They are compared with the case itself: a sample's situations must be those of the train built from
the case with the sample's values.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import fields

import numpy as np
import pandas as pd
import pint
import pytest
from tests.support import loaded, round_ring, shipped

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.train import build_train
from loadshare.train.columns import columns_of
from loadshare.train.samples import samples_of
from loadshare.train.situations import Situations, situation_of

PINT = pint.UnitRegistry()
DIGITS = 1e-13
"""Relative: products are formed in another order, and π/180 is applied before or after."""
NONE = 1e-19
"""Absolute [SI]: cosines of right angles times lengths of some 10 µm."""

ARRAYS = tuple(f.name for f in fields(Situations) if f.name not in ("train", "count"))


def everything() -> ls.Case:
    """Return a case with every element, and a ring whose arcs follow errors and given floats."""
    return shipped("fgfbstts/all_elements").replace(
        {
            "rings.4.float": "5 um",
            "rings.4.measured": "nominal",
            "operating.external": {"1": "3 N*m", "6": "4 N*m"},
        }
    )


def plain() -> ls.Case:
    """Return the seed's transmission with errors, a torque, and a gap on a mesh."""
    return loaded(shipped("fgfbstts/both_errors"), "900 N*m").replace(
        {'meshes."4-6".gap': "3 urad", 'meshes."4-6".backlash': "30 um"}
    )


def splined() -> ls.Case:
    """Return splines with a fixed friction force, and a stick limit below the continuous one."""
    return shipped("fgfbstts/spline_clearance").replace(
        {
            "splines.4.friction": None,
            "splines.4.normal_force": None,
            "splines.4.friction_force": "50 N",
            "splines.4.stick_limit": "1 um",
        }
    )


def derived() -> ls.Case:
    """Return rings whose floats are derived from backlashes."""
    return shipped("fgfbstts/all_elements")


def seated() -> ls.Case:
    """Return a case with a load per position, a support of two stiffnesses and a bearing."""
    return plain().replace(
        {
            "operating.torque": [f"{torque} N*m" for torque in (700, 900, 800, 600, 750)],
            "gears.10.support": ["5e8 N/m", "3e8 N/m"],
            "bearings.4": {
                "clearance": "5 um",
                "stiffness": "500 N/um",
                "offset": ["0.5 um", "-1 um"],
            },
        }
    )


def stepped() -> ls.Case:
    """Return a case with a shaft of two sections, and one of one."""
    sections = {"diameter": ["40 mm", "44 mm"], "length": ["30 mm", "50 mm"], "bore": "20 mm"}
    simple = {"diameter": "40 mm", "length": "100 mm"}
    return shipped("two_path/nasa").replace(
        {'shafts."wheel1-pinion1"': sections, 'shafts."wheel2-pinion2"': simple}
    )


def rigid() -> ls.Case:
    """A rigid shaft, whose clocking shifts the flanks of the gears on it."""
    return everything().replace({'shafts."2-4".stiffness': "rigid"})


FAST: dict[str, tuple] = {
    "operating.power [kW]": (everything, 300.0, 900.0),
    "operating.speed [rpm]": (everything, 5000.0, 15000.0),
    "operating.torque [N*m]": (plain, 100.0, 1500.0),
    "operating.external.6 [N*m]": (everything, -50.0, 80.0),
    "operating.external.1 [N*m]": (everything, -50.0, 80.0),
    "errors.1.installation.amount [um]": (everything, 0.0, 80.0),
    "errors.1.installation.direction [deg]": (everything, -170.0, 350.0),
    "errors.6.installation[0] [um]": (everything, -80.0, 80.0),
    "errors.6.installation[1] [mm]": (everything, -0.1, 0.1),
    "errors.4.eccentricity.amount [um]": (everything, 0.0, 50.0),
    "errors.4.eccentricity.direction [deg]": (everything, 0.0, 300.0),
    "errors.8.eccentricity.phase [rad]": (everything, 0.0, 6.0),
    "rings.5.float.up [um]": (everything, 0.0, 9.0),
    "rings.5.float.down [um]": (everything, 0.0, 9.0),
    "rings.4.float [um]": (everything, 0.0, 9.0),
    "rings.4.clearance [um]": (everything, 0.0, 90.0),
    "rings.4.clearance[1] [um]": (everything, 0.0, 90.0),
    "rings.4.stiffness [N/um]": (everything, 100.0, 900.0),
    "rings.sun.radius [um]": (round_ring, 0.0, 9.0),
    "rings.sun.stiffness [N/um]": (round_ring, 100.0, 900.0),
    "rings.sun.offset[0] [um]": (round_ring, -2.0, 2.0),
    "bearings.4.offset[1] [um]": (seated, -2.0, 2.0),
    "bearings.4.clearance [um]": (seated, 0.0, 9.0),
    "bearings.4.stiffness [N/um]": (seated, 100.0, 900.0),
    "operating.torque[1] [N*m]": (seated, 100.0, 1500.0),
    "gears.10.support[1] [N/m]": (seated, 1e8, 9e8),
    'shafts."wheel1-pinion1".diameter[1] [mm]': (stepped, 30.0, 60.0),
    'shafts."wheel1-pinion1".length[0] [mm]': (stepped, 20.0, 60.0),
    'shafts."wheel2-pinion2".diameter [mm]': (stepped, 30.0, 60.0),
    'shafts."wheel2-pinion2".shear_modulus [GPa]': (stepped, 70.0, 90.0),
    "splines.4.bending_stiffness [N/um]": (splined, 5.0, 50.0),
    "splines.4.stick_limit [um]": (splined, 0.0, 2.0),
    "splines.4.clearance [um]": (splined, 5.0, 90.0),
    "splines.4.friction_force [N]": (splined, 20.0, 900.0),
    "splines.4.friction": (everything, 0.0, 0.3),
    "splines.4.normal_force [N]": (everything, 0.0, 900.0),
    "splines.5.friction": (everything, 0.0, 0.3),
    "splines.5.radius [mm]": (everything, 20.0, 90.0),
    'meshes."1-2".stiffness [N*m/rad]': (everything, 5e5, 9e5),
    'meshes."4-6".law.a [urad]': (everything, 0.0, 30.0),
    'meshes."4-6".law.b [rad/(N*m)]': (everything, 1e-7, 3e-7),
    'meshes."6-10".law.c [rad/(N*m)^(2/3)]': (everything, 1e-7, 1e-6),
    'meshes."1-3".stiffness[0] [N*m/rad]': (everything, 5e5, 9e5),
    'meshes."4-7".law.a[1] [urad]': (everything, 0.0, 30.0),
    'meshes."5-8".law.b[1] [rad/(N*m)]': (everything, 1e-7, 3e-7),
    'meshes."8-10".law.c[1] [rad/(N*m)^(2/3)]': (everything, 1e-7, 1e-6),
    'meshes."4-6".gap [urad]': (plain, 0.0, 30.0),
    'meshes."4-6".backlash [um]': (plain, 5.0, 90.0),
    'meshes."4-7".normal_backlash [um]': (plain, 5.0, 90.0),
    'meshes."6-10".backlash [um]': (derived, 5.0, 90.0),
    'shafts."2-4".stiffness [N*m/rad]': (everything, 1e5, 9e5),
    'shafts."3-5".clocking [mrad]': (everything, -1.0, 1.0),
    'shafts."2-4".clocking [mrad]': (rigid, -1.0, 1.0),
    "gears.6.support [N/m]": (everything, 1e8, 9e8),
}
PREPARED = {
    'meshes."4-7".normal_backlash [um]': {'meshes."4-7".normal_backlash': "1 um"},
    "rings.4.stiffness [N/um]": {"rings.4.stiffness": "500 N/um"},
    "rings.sun.stiffness [N/um]": {"rings.sun.stiffness": "500 N/um"},
}
"""Changes that a key needs in the case before it can be an array."""


def drawn(key: str, count: int, seed: int = 0) -> np.ndarray:
    _, low, high = FAST[key]
    values = np.random.default_rng(seed).uniform(low, high, count)
    values[0] = low
    return values


def means_what_the_case_means(case: ls.Case, samples: Mapping[str, Sequence]) -> None:
    ((rows, group),) = samples_of(case, samples)
    count = len(rows)
    assert rows.tolist() == list(range(count))
    for sample in range(count):
        train = build_train(group.one(sample))
        for index in sorted({1, min(3, train.count), train.count}):
            many, alone = group.situations(index), situation_of(train, index)
            assert many.count == count
            for name in ARRAYS:
                here, there = getattr(many, name), getattr(alone, name)
                here = here[sample if len(here) > 1 else 0]
                np.testing.assert_allclose(
                    here, there[0], rtol=DIGITS, atol=NONE, err_msg=f"{name} {index}"
                )


@pytest.mark.parametrize("key", FAST)
@pytest.mark.quick(9)
def test_a_key_that_becomes_an_array(key):
    """Its values enter the arrays as they enter a train built from the case."""
    case = FAST[key][0]().replace(PREPARED.get(key, {}))
    means_what_the_case_means(case, {key: drawn(key, 4)})
    ((_, group),) = samples_of(case, {key: drawn(key, 4)})
    assert len(group.values) == 1, "the key must not rebuild the train"


@pytest.mark.parametrize("key", FAST)
def test_it_makes_a_difference(key):
    """Two values give two situations, so no key is read and then ignored."""
    make, low, high = FAST[key]
    case = make().replace(PREPARED.get(key, {}))
    ((_, group),) = samples_of(case, {key: [low, high]})
    some = group.situations(min(2, group.train.count))
    varying = [n for n in ARRAYS if len(getattr(some, n)) > 1]
    assert any(not np.array_equal(getattr(some, n)[0], getattr(some, n)[1]) for n in varying)


@pytest.mark.parametrize(
    "make", [everything, plain, splined, seated, stepped], ids=lambda make: make.__name__
)
def test_all_keys_together(make):
    keys = [k for k, (case, *_) in FAST.items() if case is make and "clearance[1]" not in k]
    samples = {key: drawn(key, 3, seed) for seed, key in enumerate(keys)}
    changes = {k: v for key in keys for k, v in PREPARED.get(key, {}).items()}
    means_what_the_case_means(make().replace(changes), samples)


@pytest.mark.parametrize("torque", [800.0, -800.0])
def test_a_batch_after_another_is_what_it_would_be_alone(torque):
    """The geometry is shared with the batch before only if the load presses the same flanks."""
    case = loaded(shipped("fgfbstts/both_errors"), "900 N*m")
    samples = {"operating.torque [N*m]": [torque, 0.9 * torque]}
    ((_, before),) = samples_of(case, {"operating.torque [N*m]": [900.0]})
    ((_, after),), ((_, alone),) = (
        samples_of(case, samples),
        samples_of(ls.Case(case.to_dict()), samples),
    )
    assert (after.geometry is before.geometry) == (torque > 0.0)
    for name in ARRAYS:
        one, other = (getattr(group.situations(2), name) for group in (after, alone))
        assert np.array_equal(one, other, equal_nan=True), name
    turned = [
        [mesh.named_backwards for mesh in g.train.meshes.values()] for g in (before, after, alone)
    ]
    assert turned[1] == turned[2]
    assert (turned[0] == turned[1]) == (torque > 0.0)


def test_texts_with_units_mean_what_numbers_mean():
    case = everything()
    ((_, texts),) = samples_of(case, {"rings.4.float": ["1 um", "0.002 mm", "3e-6 m"]})
    ((_, numbers),) = samples_of(case, {"rings.4.float [um]": [1.0, 2.0, 3.0]})
    one, other = texts.situations(1).stop, numbers.situations(1).stop
    np.testing.assert_allclose(one, other, rtol=1e-15)


def test_a_single_value_is_a_sample():
    ((rows, group),) = samples_of(everything(), {"rings.4.float [um]": 4.0})
    assert (rows.tolist(), group.count) == ([0], 1)


def test_some_samples_can_be_taken():
    key = "errors.1.installation.amount [um]"
    ((_, group),) = samples_of(everything(), {key: [0.0, 10.0, 20.0, 30.0]})
    part = group.take(slice(1, 3))
    assert part.count == 2
    np.testing.assert_array_equal(part.situations(2).offset, group.situations(2).offset[1:3])
    assert part.one(0).hash == group.one(1).hash


SLOW = {
    "rings.4.stiffness": ["rigid", "1e9 N/m", "rigid"],
    "gears.1.support": ["free", "rigid", "free"],
    'shafts."2-4".stiffness': ["rigid", "5e5 N*m/rad", "rigid"],
    'meshes."4-6".pressure_angle [deg]': [18.75, 18.751, 18.75],
    "operating.running": ["clockwise", "counter-clockwise", "clockwise"],
    'meshes."6-10".law.c [rad/(N*m)^(2/3)]': [0.0, 1e-7, 0.0],
}


@pytest.mark.parametrize("key", SLOW)
def test_a_key_that_changes_the_machine_groups_the_samples(key):
    """Samples with the same value share a train; fast keys next to it remain arrays."""
    case = everything()
    floats = [1.0, 2.0, 3.0]
    groups = samples_of(case, {key: SLOW[key], "rings.5.float [um]": floats})
    assert sorted(rows.tolist() for rows, _ in groups) == [[0, 2], [1]]
    for rows, group in groups:
        many = group.situations(2)
        for k, sample in enumerate(rows.tolist()):
            text = f"{SLOW[key][sample]} {key.split('[')[1][:-1]}" if "[" in key else None
            changes = {key.split(" [")[0]: text or SLOW[key][sample]}
            train = build_train(case.replace({**changes, "rings.5.float": f"{floats[sample]} um"}))
            alone = situation_of(train, 2)
            np.testing.assert_allclose(many.stop[k], alone.stop[0], rtol=1e-15)
            assert many.bending[0] == pytest.approx(alone.bending[0], rel=1e-15)
            assert group.train.gears.keys() == train.gears.keys()
            assert [g.moves for g in group.train.gears.values()] == [
                g.moves for g in train.gears.values()
            ]


def test_loads_of_a_list_that_press_both_flanks_in_turn_are_refused():
    """The smallest and the largest loads of all positions press one flank each."""
    samples = {f"operating.torque[{k}] [N*m]": [700.0, -700.0, 700.0] for k in range(4)}
    samples["operating.torque[4] [N*m]"] = [700.0, -700.0, -700.0]
    case = loaded(shipped("fgfbstts/both_errors"), "700 N*m").replace(
        {"operating.torque": ["700 N*m"] * 5}
    )
    with pytest.raises(CaseError, match="backlash"):
        samples_of(case, samples)
    some = {key: values[:2] for key, values in samples.items()}
    assert sorted(rows.tolist() for rows, _ in samples_of(case, some)) == [[0], [1]]


def test_a_backlash_changes_the_float_that_is_derived_from_it():
    ((_, group),) = samples_of(derived(), {'meshes."6-10".backlash [um]': [20.0, 30.0]})
    floats = group.situations(1).stop[:, 0]
    assert floats[0][0] < floats[1][0]
    assert floats[0][1] == floats[1][1]


WRONG = {
    "unknown key": ({"rings.4.flaot [um]": [1.0]}, "Did you mean float?"),
    "no such gear": ({"errors.44.eccentricity.amount [um]": [1.0]}, "44"),
    "no unit": ({"rings.4.float": [1.0, 2.0]}, "unit"),
    "wrong unit": ({"rings.4.float [N]": [1.0, 2.0]}, "rings.4.float"),
    "unequal lengths": (
        {"rings.4.float [um]": [1.0, 2.0], "rings.5.float [um]": [1.0]},
        "has 1 value, but the keys before it have 2",
    ),
    "not finite": ({"rings.4.float [um]": [1.0, np.nan]}, "not finite"),
    "infinite": ({"rings.4.float [um]": [1.0, np.inf]}, "not finite"),
    "negative": ({"rings.4.clearance [um]": [1.0, -2.0, 1.0]}, "rings.4.clearance"),
    "negative text": ({"rings.4.clearance": ["1 um", "-2 um", "1 um"]}, "rings.4.clearance"),
    "text without a unit": ({"rings.4.clearance": ["1 um", "2", "1 um"]}, "rings.4.clearance"),
    "empty": ({}, "there is no key"),
    "no values": ({"rings.4.float [um]": []}, "contains no value"),
    "lists in place of numbers": (
        {"rings.4.offset": [["1 um", "2 um"], ["3 um", "4 um"]]},
        "is not a list of values; in a list, each number has its own key, as in rings.4.offset[0]",
    ),
    "a table of values": ({"rings.4.float [um]": [[1.0, 2.0]]}, "not a list of values"),
    "lists of several lengths": ({"rings.4.float [um]": [[1.0], [1.0, 2.0]]}, "not a list of"),
    "twice": ({"rings.4.float [um]": [1.0], "rings.4.float [mm]": [1.0]}, "is given twice"),
    "nothing": ({"rings.4.float [um]": [1.0, None]}, "neither a number nor a text"),
    "masked": ({"rings.4.float [um]": np.ma.array([1.0], mask=[True])}, "neither a number"),
    "complex": ({"rings.4.float [um]": [1.0j]}, "neither a number nor a text"),
    "texts with a unit": ({"rings.4.float [um]": ["1", "2"]}, "values are not numbers"),
    "no key path": ({"rings..4 [um]": [1.0]}, "is not a key path"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_cannot_be_used_is_reported(what):
    samples, message = WRONG[what]
    with pytest.raises(CaseError) as error:
        samples_of(everything(), samples)
    assert message in str(error.value)
    ring = "rings" if samples else ""
    assert any(ring in problem.key or "44" in problem.key for problem in error.value.problems)


@pytest.mark.parametrize(
    "samples",
    [
        pd.DataFrame({"rings.4.float [um]": [1, 2], "rings.5.float": ["1 um", "2 um"]}),
        pd.DataFrame({"rings.4.float [um]": [1, 2], "rings.5.float": ["1 um", "2 um"]}, dtype="O"),
        {"rings.4.float [um]": iter([1, 2]), "rings.5.float": (f"{k} um" for k in (1, 2))},
        {"rings.4.float [um]": range(1, 3), "rings.5.float": np.array([1.0, 2.0]) * PINT.um},
        {"rings.4.float [um]": (1, 2), "rings.5.float": [1.0 * PINT.um, 2e-3 * PINT.mm]},
        {"rings.4.float [um]": [1, np.int64(2)], "rings.5.float": ["1 um", 2.0 * PINT.um]},
    ],
    ids=["frame", "frame of objects", "generators", "quantities", "a list of them", "mixed"],
)
def test_whatever_has_columns_is_read_alike(samples):
    read = columns_of(samples)
    assert [column.key for column in read] == ["rings.4.float [um]", "rings.5.float"]
    for column in read:
        np.testing.assert_allclose(column.in_si("m"), [1e-6, 2e-6], rtol=1e-15)


def test_what_has_no_columns_is_reported():
    for samples in (None, [[1.0, 2.0]], np.ones((2, 2))):
        with pytest.raises(CaseError, match="is not a table of values by key"):
            columns_of(samples)
    with pytest.raises(CaseError, match="unknown key"):
        samples_of(everything(), {4: [1.0]})


def test_all_problems_are_reported_at_once():
    samples = {"rings..4": [1.0], "rings.4.float [um]": [np.nan], "rings.5.float [um]": [1.0, 2.0]}
    with pytest.raises(CaseError) as error:
        columns_of(samples)
    assert [problem.key for problem in error.value.problems] == list(samples)[:2]


def test_a_value_that_cannot_be_read_is_named():
    """The message contains the value and what is allowed, as for a file."""
    key = "rings.5.float"
    for value, told in {
        "3 foo": f'{key} = "3 foo": the unit foo is not known. Allowed: a value in m such as',
        "3 kg": f'{key} = "3 kg": is a mass, but a value in m is needed.',
        "3": f'{key} = "3": 3 has no unit.',
    }.items():
        with pytest.raises(ls.CaseError, match=re.escape(told)):
            samples_of(everything(), {key: ["1 um", value]})
    with pytest.raises(ls.CaseError, match=re.escape(f"{key} = 1e+300: 1e+300 has no unit")):
        samples_of(everything(), {key: [1e300, 2e300]})
