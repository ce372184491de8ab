import pickle

import numpy as np
import pint
import pytest

from loadshare.case import Case, Gear, Mesh, load_case
from loadshare.errors import CaseError


def test_toml_round_trip(drive, tmp_path):
    text = drive.to_toml(tmp_path / "copy.toml")
    assert (tmp_path / "copy.toml").read_text() == text
    again = load_case(tmp_path / "copy.toml")
    assert again == drive
    assert again.to_toml() == text
    assert again.name == "copy"


def test_every_shipped_case_survives_toml(case_files, tmp_path):
    for path in case_files:
        case = load_case(path)
        case.to_toml(tmp_path / "copy.toml")
        again = load_case(tmp_path / "copy.toml")
        assert again == case, path
        assert again.hash == case.hash, path


def test_pickle(drive):
    again = pickle.loads(pickle.dumps(drive))
    assert again == drive
    assert again.name == "drive"
    assert again.to_toml() == drive.to_toml()


def test_errors_survive_pickle(drive):
    with pytest.raises(CaseError) as caught:
        drive.replace({"gears.a.base_radius": "3 kg", "gears.x": None})
    again = pickle.loads(pickle.dumps(caught.value))
    assert again.problems == caught.value.problems
    assert str(again) == str(caught.value)


def test_a_case_built_in_python(drive):
    theirs = pint.UnitRegistry()
    load = theirs.Quantity(np.array([100.0, 120.0]), "N*m")
    case = Case(
        name="built",
        operating={"input": "1", "output": "2", "torque": load, "positions": 2},
        gears={
            1: Gear(centre=("0 mm", "0 mm"), base_radius="46.9846 mm"),
            2: {"centre": ["150 mm", "0 mm"], "base_radius": theirs.Quantity(93.9693, "mm")},
        },
        meshes={"1-2": Mesh(pressure_angle="20 deg", stiffness="1e6 N*m/rad")},
        march=None,
    )
    assert case.name == "built"
    assert case.operating.input_torque == (100.0, 120.0)
    assert case.gears["2"].base_radius.text == "93.9693 mm"
    assert (case.meshes["1-2"].driver, case.meshes["1-2"].driven) == ("1", "2")
    assert case.gears["2"].centre[0].si == 0.15
    assert case.problem("gears.1.base_radius", "is odd").file == "built"


def test_a_bad_case_built_in_python_is_reported_in_the_same_words():
    with pytest.raises(CaseError) as caught:
        Case(operating={"input": "1"}, gears={}, meshes={})
    lines = str(caught.value).splitlines()
    assert lines[0] == "case: operating.output: is missing. Gear at which the torque leaves."
    assert [line[: line.index(".")] for line in lines[1:]] == [
        "case: gears: is empty",
        "case: meshes: is empty",
    ]


def test_gears_may_have_dashes_in_their_names(drive):
    data = drive.to_dict()
    data["gears"]["a-1"] = data["gears"].pop("a")
    data["gears"]["b"]["centre"]["about"] = "a-1"
    data["meshes"]["a-1-b"] = data["meshes"].pop("a-b")
    data["stages"]["I"]["meshes"] = ["a-1-b"]
    data["operating"]["input"] = "a-1"
    case = Case(data)
    assert (case.meshes["a-1-b"].driver, case.meshes["a-1-b"].driven) == ("a-1", "b")


def test_power_and_speed_make_a_torque(drive):
    case = drive.replace(
        {"operating.torque": None, "operating.power": "2000 kW", "operating.speed": "8780 rpm"}
    )
    assert case.operating.input_torque == pytest.approx((2175.2,), abs=0.05)


def test_a_face_gears_acting_radius_is_the_mean_of_its_radii():
    gear = Gear(type="face", centre=["0 mm", "0 mm"], inner_radius="200 mm", outer_radius="240 mm")
    assert gear.acting_radius == pytest.approx(0.22)


def test_hash_is_of_the_mechanics(drive):
    reworded = drive.replace(
        {
            "title": "Another",
            "source": "x",
            "notes": "y",
            "assumed": ["gears"],
            "gears.a.base_radius": "0.0469846 m",
            "gears.a.type": "external",
        }
    )
    assert reworded != drive
    assert reworded.hash == drive.hash
    assert drive.replace({'meshes."a-b".stiffness': "1.1e6 N*m/rad"}).hash != drive.hash
    assert len(drive.hash) == 64


def test_replace_leaves_the_case_as_it_is(drive):
    before = drive.to_dict()
    changed = drive.replace(
        {
            'meshes."c-d".stiffness[1]': "5e6 N*m/rad",
            "errors.a": {"installation": ["1 um", "2 um"]},
            'meshes."a-b".backlash': None,
            "rings.c": {"neighbours": ["a", "d"], "float": {"up": "1 um", "down": "2 um"}},
        }
    )
    assert drive.to_dict() == before
    assert changed.meshes["c-d"].stiffness[1].si == 5e6
    assert changed.errors["a"].installation[1].si == 2e-6
    assert changed.meshes["a-b"].backlash is None
    assert changed.rings["c"].float_.down.si == 2e-6
    assert changed.name == "drive"


def test_numbers_and_arrays_of_numpy_are_plain_data(drive):
    """So do generators: whatever is given, the case contains what a file would."""
    plain = {
        "operating.positions": 3,
        'meshes."a-b".backlash': "20 um",
        "errors.a": {"installation": ["1 um", "2 um"]},
        "study.one": {"kind": "sweep", "over": {"meshes.a-b.stiffness": ["1e6 N*m/rad"]}},
    }
    changed = drive.replace(
        {
            "operating.positions": np.int64(3),
            'meshes."a-b".backlash': np.str_("20 um"),
            "errors.a": {"installation": np.array(["1 um", "2 um"])},
            "study.one": {
                "kind": "sweep",
                "over": {"meshes.a-b.stiffness": (text for text in ["1e6 N*m/rad"])},
            },
        }
    )
    assert changed.to_dict() == drive.replace(plain).to_dict()
    assert Case(changed.to_dict() | {"title": np.str_("T")}).to_toml()
    for number in (np.float32(4.0), np.float64(4.0), np.array(4.0)):
        with pytest.raises(CaseError, match=r"4\.0 has no unit"):
            drive.replace({'meshes."a-b".backlash': number})


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("gears.aa.support", "does not exist. Did you mean gears.a?"),
        ("gear.a.support", "does not exist. Did you mean gears?"),
        ("march.steps.x", "does not exist. There is no march.steps."),
        (
            "operating.input.x",
            'does not exist. operating.input = "a" has no parts: change operating.input itself.',
        ),
        ('meshes."c-d".stiffness[7]', 'does not exist. There is no meshes."c-d".stiffness[7].'),
        ("a..b", "is not a key path."),
    ],
)
def test_replace_of_what_is_not_there(drive, key, message):
    with pytest.raises(CaseError) as caught:
        drive.replace({key: 3})
    assert str(caught.value) == f"changes: {key} = 3: {message}"


def test_what_is_no_change_by_key_path_is_told(drive):
    for changes in (None, [("title", "x")], "title"):
        with pytest.raises(TypeError, match="changes by key path are expected, as in"):
            drive.replace(changes)
    for key in (1, ("operating", "torque"), ""):
        with pytest.raises(CaseError, match="is not a key path"):
            drive.replace({key: "1 N*m"})


def test_a_name_that_only_looks_like_another_is_told_apart(drive):
    composed, apart = "\u00e9", "e\u0301"
    renamed = {"gears.a": None, f"gears.{composed}": drive.to_dict()["gears"]["a"]}
    with pytest.raises(CaseError) as caught:
        drive.replace(renamed | {"operating.input": apart})
    hint = next(p.hint for p in caught.value.problems if p.key == "operating.input")
    assert hint == f"{composed} looks alike, but is written in other characters: copy it."
