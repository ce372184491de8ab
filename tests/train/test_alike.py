"""A train built from that of an earlier case is bit for bit the one built from scratch."""

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.train import build_train
from loadshare.train.alike import train_alike
from loadshare.train.geometry import geometry_of
from loadshare.train.shape import shape_of
from loadshare.train.situations import VARYING, situations_of

CHANGES = [
    ("fgfbstts/limit_ring", {"rings.4.float": "7 um", "operating.power": "1500 kW"}),
    ("fgfbstts/limit_ring", {"rings.5.float": "0 um"}),
    ("fgfbstts/all_elements", {"splines.4.clearance": "80 um", "rings.5.float.up": "3 um"}),
    ("fgfbstts/all_elements", {'meshes."6-10".backlash': "40 um"}),
    ("fgfbstts/both_errors", {"errors.6.installation.amount": "12 um"}),
    ("fgfbstts/full_float", {"operating.power": "900 kW", "title": "another"}),
    ("planetary/four_planets", {"operating.torque": "700 N*m"}),
    ("star/floating_sun_3", {"operating.torque": "0.9 kN*m"}),
]


@pytest.mark.parametrize(("name", "changes"), CHANGES)
def test_what_is_taken_over_is_what_would_be_built(name, changes):
    base = shipped(name)
    changed = base.replace(changes)
    geometry, train = geometry_of(base), build_train(base)
    found, alone = train_alike(changed, (base, geometry, train)), build_train(changed)
    assert found is not None
    assert shape_of(found) == shape_of(alone)
    every = range(1, alone.count + 1)
    one, other = situations_of(found, tuple(every)), situations_of(alone, tuple(every))
    for field in VARYING:
        assert np.array_equal(getattr(one, field), getattr(other, field), equal_nan=True), field


def test_a_case_that_is_written_anew_shares_the_elements_that_say_the_same():
    base = shipped("fgfbstts/limit_ring")
    train = build_train(base)
    written = ls.Case(base.replace({"errors.6.installation": ["1 um", "0 um"]}).to_dict())
    found = train_alike(written, (base, geometry_of(base), train))
    assert found is not None
    same = [name for name in train.offsets if found.offsets[name] is train.offsets[name]]
    assert same == [name for name in train.offsets if name != "6"]
    assert all(found.meshes[name] is mesh for name, mesh in train.meshes.items())


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("limit_ring", {"operating.power": "-2000 kW"}),
        ("limit_ring", {"rings.4": None}),
        ("limit_ring", {"rings.4.stiffness": "1e9 N/m"}),
        ("full_float", {"operating.positions": 3}),
        ("full_float", {"shafts.2-4.stiffness": "rigid"}),
    ],
)
def test_what_changes_the_machine_is_built_anew(name, changes):
    base = shipped(f"fgfbstts/{name}")
    changed = base.replace(changes)
    assert train_alike(changed, (base, geometry_of(base), build_train(base))) is None


def test_a_replaced_case_shares_what_it_does_not_change_and_changes_nothing_else():
    base = shipped("fgfbstts/limit_ring")
    before = base.to_dict()
    changed = base.replace({"rings.5.float": "3 um", "errors.6.installation": ["1 um", "0 um"]})
    assert base.to_dict() == before
    assert changed.gears["4"] is base.gears["4"]
    assert changed.rings["5"] is not base.rings["5"]
    assert list(changed.differences(base)) == [
        (("rings", "5", "float"), before["rings"]["5"]["float"], "3 um"),
        (("errors", "6", "installation", 0), "0 um", "1 um"),
        (("errors", "6", "installation", 1), "100 um", "0 um"),
    ]
    again = ls.Case(changed.to_dict(), name=base.name)
    assert again == changed
    assert again.hash == changed.hash


def test_a_new_gear_changes_what_a_name_joins():
    """With gears a, b, a-b and c, the name a-b-c may join two pairs; before, it joined one."""
    text = {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]}
    gears = {name: {**text, "centre": [f"{100 * k} mm", "0 mm"]} for k, name in enumerate("abc")}
    case = shipped("fgfbstts/base")
    changes = {f"gears.{name}": gear for name, gear in gears.items()}
    with pytest.raises(ls.CaseError) as known:
        ls.Case({**case.to_dict(), "gears": {**case.to_dict()["gears"], **gears}})
    with pytest.raises(ls.CaseError) as found:
        case.replace(changes)
    assert [p.message for p in found.value.problems] == [p.message for p in known.value.problems]
