"""Copies of gears give the same case as when each of them is written out."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from loadshare.case import Case, load_case
from loadshare.case.writer import toml_text
from loadshare.errors import CaseError

SET: dict[str, Any] = {
    "assumed": ["gears.planet.support", "meshes.sun-planet"],
    "operating": {"input": "sun", "output": "carrier", "torque": "100 N*m"},
    "gears": {
        "sun": {"teeth": 18, "module": "5 mm", "centre": ["0 mm", "0 mm"]},
        "planet": {
            "copies": 3,
            "teeth": 36,
            "module": "5 mm",
            "carrier": "carrier",
            "support": "1e9 N/m",
            "centre": {"distance": "135 mm", "angle": "10 deg"},
        },
        "ring": {"type": "internal", "teeth": 90, "module": "5 mm", "held": True}
        | {"centre": ["0 mm", "0 mm"]},
        "carrier": {"type": "carrier", "centre": ["0 mm", "0 mm"]},
    },
    "meshes": {
        "sun-planet": {"stiffness": "2e7 N*m/rad"},
        "outer": {"driver": "planet", "driven": "ring", "stiffness": "9e7 N*m/rad"},
        "sun-planet2": {"gap": "1e-5 rad"},
    },
    "errors": {
        "planet2": {"pin": {"radial": "5 um"}},
        "planet": {"pin": {"tangential": "1 um"}},
    },
    "stages": {"I": {"meshes": ["sun-planet"], "groups": [["sun-planet"]]}},
}


def changed(**sections: Any) -> dict[str, Any]:
    return copy.deepcopy(SET) | sections


def test_copies_are_written_out() -> None:
    case = Case(SET)
    assert list(case.gears) == ["sun", "planet1", "planet2", "planet3", "ring", "carrier"]
    angles = [case.gears[f"planet{k}"].centre.angle.text for k in (1, 2, 3)]
    assert angles == ["10 deg", "130 deg", "250 deg"]
    assert list(case.meshes) == [
        *(f"sun-planet{k}" for k in (1, 2, 3)),
        "outer1",
        "outer2",
        "outer3",
    ]
    assert case.meshes["outer2"].ends == ("planet2", "ring")
    assert case.meshes["sun-planet2"].gap is not None
    assert case.meshes["sun-planet1"].gap is None
    pins = [case.errors[f"planet{k}"].pin for k in (1, 2, 3)]
    assert [pin.tangential.text for pin in pins] == ["1 um"] * 3
    assert [pin.radial.si for pin in pins] == pytest.approx([0.0, 5e-6, 0.0])
    assert case.stages["I"].groups == (("sun-planet1", "sun-planet2", "sun-planet3"),)
    assert case.is_assumed("gears.planet3.support")
    assert case.is_assumed("meshes.sun-planet1.stiffness")
    assert Case(case.to_dict()) == case


def test_directions_of_copies_are_those_of_the_case() -> None:
    """Places are rotated about the pole; a support that is stiffer along x is so for every copy."""
    gears = copy.deepcopy(SET["gears"])
    gears["planet"]["support"] = ["1e9 N/m", "2e8 N/m"]
    bearings = {"planet": {"clearance": "5 um", "stiffness": "rigid", "offset": ["9 um", "0 um"]}}
    case = Case(changed(gears=gears, bearings=bearings))
    for k in (1, 2, 3):
        assert [value.si for value in case.gears[f"planet{k}"].support] == [1e9, 2e8]
        assert [value.si for value in case.bearings[f"planet{k}"].offset] == [9e-6, 0.0]


def test_the_name_of_all_copies_is_none_of_them() -> None:
    with pytest.raises(CaseError, match=r"Give one: planet1, planet2, planet3\."):
        Case(changed()).replace({"operating.output": "planet"})


def test_a_change_of_all_copies_is_told_their_names() -> None:
    case = Case(changed())
    for key, name in (("gears.planet.teeth", "gears.planet1"), ("gears.planet.copies", "planet2")):
        with pytest.raises(CaseError, match=rf"has its own name: .*{name}.*\."):
            case.replace({key: 4})


def test_angles_may_be_given_one_by_one() -> None:
    data = changed()
    data["gears"]["planet"]["copies"] = ["0 deg", "1.7 rad", "240 deg"]
    case = Case(data)
    assert case.gears["planet2"].centre.angle.si == pytest.approx(1.7 + 0.17453292519943295)


def test_gears_on_one_pin_are_copied_together() -> None:
    data = changed(errors={}, stages={}, assumed=[])
    wheel = data["gears"]["planet"]
    data["gears"]["pinion"] = wheel | {"centre": {"about": "planet", "distance": "0 mm"}}
    data["gears"]["pinion"]["centre"] |= {"angle": "0 deg", "height": "60 mm"}
    data["shafts"] = {"planet-pinion": {"stiffness": "rigid"}}
    data["meshes"] = {
        "sun-planet": {"stiffness": "2e7 N*m/rad"},
        "pinion-ring": {"stiffness": "9e7 N*m/rad"},
    }
    case = Case(data)
    assert list(case.shafts) == [f"planet{k}-pinion{k}" for k in (1, 2, 3)]
    assert case.gears["pinion3"].centre.about == "planet3"


def test_pairs_of_unequal_numbers_are_told_so() -> None:
    """No single copy is named if the copies of two gears cannot be paired."""
    data = changed()
    data["gears"]["outer"] = data["gears"]["planet"] | {"copies": 4}
    data["meshes"]["planet-outer"] = {"stiffness": "2e7 N*m/rad"}
    with pytest.raises(CaseError) as caught:
        Case(data)
    unequal = "planet has 3 copies, outer has 4, but copies are joined in pairs."
    assert unequal in str(caught.value)
    assert "Give one: planet1" not in str(caught.value)


def test_a_gear_with_the_name_of_a_copy_is_told_apart_from_what_is_said_of_the_copy() -> None:
    """Such a gear used to replace the copy, so that one branch was lost without a message."""
    data = changed()
    for own in (
        data["gears"]["sun"],
        {"base_radius": "80 mm", "centre": {"about": "sun", "angle": "40 deg"}},
        {"copies": 2},
    ):
        data["gears"]["planet2"] = own
        with pytest.raises(CaseError) as caught:
            Case(data)
        message = "is a separate gear with the name of copy 2 of planet"
        assert [(p.key, p.message) for p in caught.value.problems] == [("gears.planet2", message)]
    data["gears"]["planet2"] = {"teeth": 36, "centre": {"angle": "131 deg", "height": "1 mm"}}
    gears = Case(data).gears
    assert gears["planet2"].centre.angle.text == "131 deg"


def test_no_two_copies_are_in_one_place() -> None:
    data = changed()
    planet = data["gears"]["planet"]
    planet["copies"], planet["base_radius"] = ["0 deg", "120 deg", "360 deg"], "84.5723 mm"
    del planet["module"], planet["teeth"]
    with pytest.raises(CaseError) as caught:
        Case(data)
    message = "copies 1 and 3 are in the same place"
    assert [(p.key, p.message) for p in caught.value.problems] == [("gears.planet.copies", message)]
    data["gears"]["planet3"] = {"centre": {"angle": "240 deg"}}
    assert Case(data).gears["planet3"].centre.angle.text == "240 deg"


def test_what_is_wrong_with_copies_is_reported_once() -> None:
    for given, key in ((1, "copies"), ("three", "copies"), (["0 mm", "5 mm"], "copies")):
        data = changed()
        data["gears"]["planet"]["copies"] = given
        with pytest.raises(CaseError) as caught:
            Case(data)
        assert f"gears.planet.{key}" in str(caught.value)
    data = changed()
    data["gears"]["sun"]["copies"] = 3
    with pytest.raises(CaseError, match="needs a centre given by distance and angle"):
        Case(data)


def test_a_problem_names_the_file_in_which_all_copies_stand(tmp_path) -> None:
    Case(SET).to_toml(tmp_path / "whole.toml")
    base, own = tmp_path / "base.toml", tmp_path / "own.toml"

    base.write_text(
        toml_text(changed(meshes={**SET["meshes"], "sun-planet": {"stiffness": "2 kg"}}))
    )
    own.write_text('extends = "base.toml"\n[gears.planet]\ncopies = 4\n')
    with pytest.raises(CaseError) as caught:
        load_case(own)
    lines = str(caught.value).splitlines()
    assert len(lines) == 4
    assert all("base.toml" in line and "sun-planet" in line for line in lines)


def test_a_pin_without_an_error_can_be_given_one() -> None:
    data = changed()
    del data["errors"]
    case = Case(data).replace({"errors.planet3.pin.angular": "0.1 mrad"})
    assert case.errors["planet3"].pin.angular.si == pytest.approx(1e-4)
    assert list(case.errors) == ["planet3"]


@pytest.mark.parametrize("first", [True, False], ids=["copy first", "all first"])
def test_another_way_of_saying_it_counts_for_a_copy_too(first: bool) -> None:
    data = changed(
        bearings={
            "planet": {"clearance": "20 um", "stiffness": "1e9 N/m"},
            "planet2": {"ball_stiffness": "1e10 N/m^1.5"},
        }
    )
    single = {"law": {"b": "2e-8 rad/(N*m)"}, "normal_backlash": "30 um"}
    every = {"stiffness": "2e7 N*m/rad", "backlash": "50 um", "gap": "1e-5 rad"}
    meshes = [("sun-planet2", single), ("sun-planet", every)]
    data["meshes"] |= dict(meshes if first else meshes[::-1])
    case = Case(data)
    one, other = case.meshes["sun-planet2"], case.meshes["sun-planet3"]
    assert one.given("stiffness", "law", "backlash", "normal_backlash", "gap") == [
        "law",
        "normal_backlash",
        "gap",
    ]
    assert other.given("stiffness", "law", "backlash", "normal_backlash") == [
        "stiffness",
        "backlash",
    ]
    assert case.bearings["planet2"].given("clearance", "stiffness", "ball_stiffness") == [
        "clearance",
        "ball_stiffness",
    ]


def test_what_names_copies_that_could_not_be_made_is_no_problem_of_its_own() -> None:
    gears = changed()["gears"]
    gears["planet"]["copies"] = 1
    data = changed(gears=gears, stages={"I": {"meshes": ["sun-planet1", "sun-planet2"]}})
    del data["meshes"]["sun-planet2"]
    with pytest.raises(CaseError) as caught:
        Case(data)
    assert [problem.key for problem in caught.value.problems] == ["gears.planet.copies"]


def test_an_assumed_number_of_copies_assumes_their_angles() -> None:
    case = Case(changed(assumed=["gears.planet.copies"]))
    assert case.is_assumed("gears.planet3.centre.angle")
    assert not case.is_assumed("gears.planet3.centre.distance")
