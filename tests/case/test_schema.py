import tomllib

import jsonschema
import pytest

from benchmarks.families import SHIPPED, shipped_text, split_torque, star
from loadshare import solve
from loadshare.case import case_schema, load_case, starter_case
from loadshare.case.starter import KINDS


@pytest.fixture(scope="module")
def validator():
    schema = case_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_every_shipped_case_fits_the_schema(case_files, validator):
    """This holds for the file as written, without what it inherits, and for the complete case."""
    assert case_files
    for path in case_files:
        validator.validate(tomllib.loads(path.read_text(encoding="utf-8")))
        validator.validate(load_case(path).to_dict())


@pytest.mark.parametrize(
    ("section", "lacking"),
    [
        ("operating", {"input": "a"}),
        ("gears", {"a": {"base_radius": "30 mm"}}),
        ("gears", {"a": {"centre": {"distance": "60 mm"}}}),
        ("splines", {"b": {"clearance": "5 um"}}),
        ("errors", {"b": {"installation": {"amount": "5 um"}}}),
        ("rings", {"b": {"float": {"up": "5 um"}}}),
        ("rings", {"b": {"float": {"upward": ["a-b"]}}}),
    ],
)
def test_only_a_file_that_inherits_may_leave_out_keys(drive, validator, section, lacking):
    """Such a file extends another; also a single copy of an element may leave out keys."""
    case = drive.to_dict()
    given = {**case, section: {**case.get(section, {}), **lacking}}
    if section == "operating":
        given[section] = lacking
    assert validator.is_valid({"extends": "base.toml", section: lacking})
    assert not validator.is_valid(given)
    gear = {"centre": ["0 mm", "0 mm"], "copies": 3}
    assert validator.is_valid({**given, "gears": {**given["gears"], "z": gear}})
    # An item of a list is given completely.
    study = {"kind": "tolerance", "groups": [{"correlation": 0.5}]}
    assert not validator.is_valid({"extends": "base.toml", "study": {"one": study}})


@pytest.mark.parametrize(
    "wrong",
    [
        {"gears": {"a": {"centre": ["0 mm", "0 mm"], "base_radius": 3}}},
        {"gears": {"a": {"centre": ["0 mm", "0 mm"], "base_radius": "3"}}},
        {"gears": {"a": {"centre": ["0 mm", "0 mm"], "bas_radius": "3 mm"}}},
        {"rings": {"a": {"float": {"up": "1 mm", "upward": ["a-b"]}}}},
        {"tittle": "x"},
    ],
)
def test_the_schema_refuses_what_the_reader_refuses(drive, validator, wrong):
    assert validator.is_valid({"extends": "base.toml"})
    assert not validator.is_valid({"extends": "base.toml", **wrong})
    assert not validator.is_valid({"title": "lacks everything"})


def test_every_key_is_described(validator):
    schema = validator.schema
    tables = [schema, *(table for table in schema["$defs"].values() if "properties" in table)]
    for table in tables:
        for key, about in table["properties"].items():
            assert about.get("description"), key
            assert about.get("default", "") is not None


def test_the_starter_runs_as_it_stands(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(starter_case('My "drive"'))
    case = load_case(path)
    assert case.title == 'My "drive"'


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_runs_as_it_stands(tmp_path, kind):
    path = tmp_path / "mine.toml"
    path.write_text(starter_case("mine", kind))
    result = solve(path)
    assert result.passed
    assert set(result.positions[0].share.values()) != {None}


def test_what_the_starter_comments_out_can_be_used(tmp_path):
    lines = starter_case("x").splitlines()
    keys = ("# support =", "# gap =", "# backlash =", "# eccentricity =", "# [march]", "# gear =")
    keys += ("# revolutions =", "# steps =", "# [splines.4]", "# bending_stiffness =")
    keys += ("# clearance =", "# friction_force =", "# [rings.1]", "# radius =")
    used = [line[2:] if line.startswith(keys) else line for line in lines]
    path = tmp_path / "all.toml"
    path.write_text("\n".join(used))
    case = load_case(path)
    assert (case.march, case.splines, case.rings) != (None, {}, {})
    law = {"b": "4e-6 rad/(N*m)", "c": "2e-6 rad/(N*m)^(2/3)"}
    assert any("law = {" in line and law["c"] in line for line in lines)
    case.replace({'meshes."1-3".stiffness': None, 'meshes."1-3".law': law})


@pytest.mark.parametrize("key", SHIPPED)
def test_shipped_files_are_what_the_generator_writes(cases, key):
    assert (cases / f"{key}.toml").read_text(encoding="utf-8") == shipped_text(key)


@pytest.mark.parametrize("branches", [2, 4, 6, 8, 10, 12, 16, 32, 64])
def test_split_torque_has_as_many_branches(branches):
    case = split_torque(branches)
    assert len(case.stages["II"].meshes) == branches
    assert len(case.gears) == 2 + 2 * branches


def test_the_four_branch_train_has_the_radii_of_the_seeds_case(cases):
    base = load_case(cases / "fgfbstts" / "base.toml")
    case = split_torque(4)
    assert case.gears["out"].base_radius.si == pytest.approx(base.gears["10"].base_radius.si)
    for ours, theirs in (("pinion1", "4"), ("idler1a", "6")):
        centre, known = case.gears[ours].centre, base.gears[theirs].centre
        assert centre.distance.si == pytest.approx(known.distance.si, rel=1e-6)


@pytest.mark.parametrize(
    "build", [lambda: split_torque(3), lambda: split_torque(0), lambda: star(7)]
)
def test_trains_that_cannot_be_generated(build):
    with pytest.raises(ValueError, match=r"needed|fit around the sun"):
        build()


def test_a_star_with_a_fixed_sun():
    assert star(4, floating=False).gears["sun"].support == "rigid"
