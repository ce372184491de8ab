"""Laws from the contact analysis of a case's own teeth, and what results state about them."""

import json

import pytest
from tests.tooth.use.pairs import written

import loadshare as ls
from loadshare.case import load_case
from loadshare.errors import CaseError
from loadshare.results.files import load_result
from loadshare.tooth import resolve
from loadshare.tooth.law.inline import inline_pair
from loadshare.tooth.pair.file import PairFile

PAIR = """
kind = "helicoid"
torque = "112.5 N*m"
centre_distance = "113 mm"

[driver]
module = "3 mm"
teeth = 25
pressure_angle = "20 deg"
helix_angle = "8 deg"
profile_shift = 0.2
face_width = "20 mm"
rim = "20 mm"

[driven]
teeth = 49
profile_shift = -0.1
addendum = 0.95
tip_radius = 0.3
face_width = "25 mm"
rim = "60 mm"

[analysis]
compliance = "slices"
sampling = "means"
positions = 2
"""
CASE = """
[operating]
input = "a"
output = "b"
torque = "100 N*m"
positions = 2

[gears.a]
centre = ["0 mm", "0 mm"]
module = "3 mm"
teeth = 25
helix_angle = "8 deg"
profile_shift = 0.2
face_width = "20 mm"
bore = "40 mm"

[gears.b]
centre = ["0 mm", "113 mm"]
module = "3 mm"
teeth = 49
helix_angle = "-8 deg"
profile_shift = -0.1
tip_alteration = "-0.15 mm"
tip_radius = 0.3
face_width = "25 mm"
bore = "120 mm"

[meshes."a-b"]
"""
SET = """
[operating]
input = "s"
output = "c"
torque = "300 N*m"
positions = 3

[gears.s]
centre = ["0 mm", "0 mm"]
module = "3 mm"
teeth = 24
face_width = "30 mm"

[gears.c]
type = "carrier"
centre = ["0 mm", "0 mm"]

[gears.p]
copies = 3
carrier = "c"
centre = { distance = "72 mm", angle = "0 deg" }
module = "3 mm"
teeth = 24
face_width = "30 mm"

[gears.r]
type = "internal"
held = true
centre = ["0 mm", "0 mm"]
module = "3 mm"
teeth = 72
face_width = "30 mm"
addendum = 0.8
outside_diameter = "250 mm"

[meshes."s-p"]
law = "ltca"

[meshes."p-r"]
law = "ltca"
"""


pytestmark = pytest.mark.usefixtures("shared_cache")


@pytest.fixture
def case(tmp_path):
    text = CASE + 'law = "ltca"\nrated_torque = "112.5 N*m"\n'
    return load_case(written(tmp_path, text, "case.toml"))


@pytest.fixture
def planetary(tmp_path):
    return load_case(written(tmp_path, SET, "set.toml"))


def coefficients(case, name="a-b"):
    law = resolve(case).meshes[name].law
    return [[value.si for value in getattr(law, key)] for key in "abc"]


@pytest.mark.parametrize(
    ("word", "model"),
    [
        ("ltca", "slices"),
        pytest.param("ltca elements", "finite elements", marks=pytest.mark.slow),
    ],
)
def test_it_is_the_law_of_a_pair_file_bit_for_bit(case, tmp_path, word, model):
    written(tmp_path, PAIR.replace('"slices"', f'"{model}"'), "pair.toml")
    text = CASE + 'geometry = "pair.toml"\n'
    by_file = load_case(written(tmp_path, text, "by_file.toml"))
    own = case.replace({'meshes."a-b".law': word})
    assert coefficients(own) == coefficients(by_file)
    stated = [resolve(one).meshes["a-b"].law.basis.partition(";")[0] for one in (own, by_file)]
    assert stated == [f"LTCA, {model}, means over the cycle"] * 2


def test_it_is_computed_once_for_all_planets(empty_cache, planetary, monkeypatch):
    reported = []
    found = resolve(planetary, lambda *now: reported.append(now))
    assert reported[-1] == (6, 6)  # sun and planet, planet and ring, three positions each
    laws = [found.meshes[f"s-p{k}"].law for k in (1, 2, 3)]
    assert laws[0] == laws[1] == laws[2] != found.meshes["p1-r"].law

    def fail(*_):
        raise AssertionError("computed again")

    monkeypatch.setattr(PairFile, "analyse", fail)
    assert resolve(planetary) == found


def test_a_planetary_set_is_solved_with_it(planetary):
    result = ls.solve(planetary)
    assert result.passed
    for position in result.positions:
        assert [position.torque[f"s-p{k}"] for k in (1, 2, 3)] == pytest.approx([100.0] * 3)


def test_the_rim_follows_from_real_dimensions(case, planetary):
    pair = inline_pair(case, "a-b").geometry
    assert (pair.driver.rim, pair.driven.rim) == (0.02, 0.06)
    ring = inline_pair(planetary, "p1-r").geometry.driven_gear
    assert ring.rim_radius == 0.125
    # A rim on a web takes precedence over the bore; it counts from the root: 37.86 − 1.05·3 mm.
    on_web = case.replace({"gears.a.rim": "5 mm"})
    gear = inline_pair(on_web, "a-b").geometry.driver_gear
    assert gear.root - gear.rim_radius == pytest.approx(5e-3, rel=1e-12)
    web = planetary.replace({"gears.r.rim": "9 mm", "gears.r.web": "8 mm"})
    ring = inline_pair(web, "p1-r").geometry.driven_gear
    assert ring.rim_radius - ring.root == pytest.approx(9e-3, rel=1e-12)
    bare = inline_pair(case.replace({"gears.a.bore": None}), "a-b").geometry.driver_gear
    assert bare.root - bare.rim_radius == pytest.approx(1.5 * (bare.tip - bare.root), rel=1e-12)


def test_a_thicker_body_yields_more(case):
    """For a bore of 40 mm instead of 60 mm, the mean law at the rated torque is softer."""
    angles = []
    for bore in ("40 mm", "60 mm"):
        a, b, c = coefficients(case.replace({"gears.a.bore": bore}))
        angles.append(sum(a) + sum(b) * 112.5 + sum(c) * 112.5 ** (2 / 3))
    assert angles[0] > 1.01 * angles[1]


def test_the_rated_torque_does_not_hang_on_the_load(case):
    """If left out, it is 50 N/mm² · 20 mm · 3 mm · r, so a sweep of the load keeps one law."""
    case = case.replace({'meshes."a-b".rated_torque': None})
    pair = inline_pair(case, "a-b")
    assert pair.torque == pytest.approx(50e6 * 20e-3 * 3e-3 * pair.geometry.driver_gear.radius)
    other = case.replace({"operating.torque": "7 N*m"})
    assert coefficients(other) == coefficients(case)


def test_what_is_assumed_of_a_pinion_of_few_teeth_is_reported(tmp_path):
    text = CASE.replace("bore =", "# bore =").replace("teeth = 25", "teeth = 9")
    text = text.replace("profile_shift = 0.2", "profile_shift = 0.6\ntip_alteration = '-0.3 mm'")
    text = text.replace("113 mm", "90.5 mm").replace(
        '[meshes."a-b"]', '[meshes."a-b"]\nlaw = "ltca"'
    )
    basis = resolve(load_case(written(tmp_path, text, "case.toml"))).meshes["a-b"].law.basis
    assert "rim of driver half the root radius, rim of driven gear 1.5 tooth heights" in basis


def test_what_is_assumed_is_reported(case):
    basis = resolve(case).meshes["a-b"].law.basis
    assert basis.endswith("assumed: tip radius of the rack 0.38, steel, unmodified flanks")
    bare = case.replace({'meshes."a-b".rated_torque': None, "gears.b.bore": None})
    found = resolve(bare)
    assert "rim of driven gear 1.5 tooth heights, rated for 50 N per mm" in (
        found.meshes["a-b"].law.basis
    )
    assert found.is_assumed('meshes."a-b".law')
    assert found.meshes["a-b"].rated_torque is None


def test_problems_stand_with_the_keys_of_the_case(case):
    with pytest.raises(CaseError, match=r"gears\.a\.bore.*leaves no body below the teeth"):
        case.replace({"gears.a.bore": "90 mm"})
    with pytest.raises(CaseError) as caught:
        resolve(case.replace({"gears.a.rim": "60 mm"}))
    (problem,) = caught.value.problems
    assert problem.key == "gears.a.rim"
    assert problem.allowed == "less than the root radius, 34.7185 mm"
    wrong = case.replace({"gears.b.tip_radius": 0.6, "gears.b.teeth": 49})
    with pytest.raises(CaseError) as caught:
        resolve(wrong)
    found = {problem.key: problem for problem in caught.value.problems}
    assert set(found) == {"gears.b.tip_radius"}
    upright = {f"gears.{name}.helix_angle": None for name in "ab"}
    short = case.replace(upright | {"gears.a.addendum": 0.2, "gears.b.addendum": 0.2})
    with pytest.raises(CaseError, match="contact ratio"):
        resolve(short)


def test_a_tip_that_cuts_counts_its_alteration(case):
    """An addendum of 1.2 used to be refused with "at most 1.26971"."""
    few = {"teeth": 16, "profile_shift": 0.1}
    many = {"teeth": 60, "profile_shift": 0.0, "addendum": 1.2, "tip_alteration": "0.4 mm"}
    gears = {f"gears.{g}.{key}": v for g, of in (("a", few), ("b", many)) for key, v in of.items()}
    with pytest.raises(CaseError) as caught:
        resolve(case.replace(gears | {"gears.b.centre": ["0 mm", "115.8 mm"]}))
    (problem,) = caught.value.problems
    assert problem.key == "gears.b.addendum"
    assert problem.given == "1.33333 with its tip_alteration"
    assert problem.allowed == "at most 1.26971"
    assert problem.message == "the tip of this gear cuts into the root fillet of gear a"


def test_a_result_says_what_its_laws_are_from(case, tmp_path):
    given = case.replace(
        {
            'meshes."a-b".law': None,
            'meshes."a-b".rated_torque': None,
            'meshes."a-b".stiffness': "1e6 N*m/rad",
        }
    )
    plain = ls.solve(given)
    assert plain.laws["a-b"].basis == "given"
    assert "laws" not in plain.to_dict()
    result = ls.solve(case)
    use = result.laws["a-b"]
    assert use.basis.startswith("LTCA, slices")
    assert use.note == ""
    # F_t/b = T/(r b) at the reference circle r = z m/(2 cos β).
    radius = 25 * 3e-3 / (2 * 0.9902680687415704)
    assert use.line_load == pytest.approx(100.0 / (radius * 20e-3), rel=1e-12)
    result.to_json(tmp_path / "result.json")
    document = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert document["laws"]["a-b"]["basis"] == use.basis
    assert load_result(tmp_path / "result.json") == result


@pytest.mark.parametrize(
    ("word", "torque", "start"),
    [
        ("iso", "70 N*m", "70 N·m lies below the 75.74 N·m from which the law holds; it"),
        ("iso", "80 N*m", ""),
        ("ltca", "11 N*m", "11 N·m lies below the 11.25 N·m"),
        ("ltca", "12 N*m", ""),
        ("ltca", "120 N*m", "120 N·m lies above the 112.5 N·m up to which the law holds"),
    ],
)  # fmt: skip
def test_loads_outside_the_range_of_a_law_are_reported(case, word, torque, start):
    """ISO 6336-1 holds from F_t/b = 100 N/mm on: 75.74 N·m on 37.87 mm and 20 mm."""
    changes = {"operating.torque": torque, 'meshes."a-b".law': word}
    if word == "iso":
        changes['meshes."a-b".rated_torque'] = None
    note = ls.solve(case.replace(changes)).laws["a-b"].note
    assert note.startswith(start) if start else note == ""


def test_iso_says_its_factors(case):
    changes = {'meshes."a-b".rated_torque': None, 'meshes."a-b".law': "iso solid"}
    found = resolve(case.replace(changes)).meshes["a-b"].law
    assert found.basis == "ISO 6336-1 method B, without C_M, solid bodies"
    thin = changes | {"gears.b.web": "8 mm", "gears.b.rim": "9 mm", 'meshes."a-b".law': "iso"}
    found = resolve(case.replace(thin)).meshes["a-b"].law
    assert found.basis == "ISO 6336-1 method B, with C_M, C_R 0.95 for thin webs"


def test_the_basis_is_no_part_of_the_mechanics(case):
    by_law = resolve(case)
    measured = by_law.replace({'meshes."a-b".law.basis': "measured in 1999"})
    assert measured.hash == by_law.hash
    assert ls.solve(measured).laws["a-b"].basis == "measured in 1999"


def test_it_does_not_matter_which_gear_a_mesh_names_first(case):
    """The analysis of the one pair goes through the cycle of the other backwards."""
    case = case.replace({"operating.positions": 5, 'meshes."a-b".rated_torque': "130 N*m"})
    rated = f"{130.0 * 49 / 25!r} N*m"
    named = {'meshes."a-b"': None, 'meshes."b-a"': {"law": "ltca", "rated_torque": rated}}
    one, other = ls.solve(case), ls.solve(case.replace(named))
    for here, there in zip(one.positions, other.positions, strict=True):
        assert there.rotation["a"] == pytest.approx(here.rotation["a"], rel=1e-6)
    assert len({round(1e9 * p.rotation["a"]) for p in one.positions}) == 5
    assert [p.mesh_position["b-a"] for p in other.positions] == [1, 5, 4, 3, 2]


def test_the_table_and_the_report_tell_it(case, tmp_path):
    from typer.testing import CliRunner

    from loadshare.cli.main import app

    file = tmp_path / "case.toml"
    done = CliRunner(env={"COLUMNS": "200"}).invoke(app, ["run", str(file)])
    assert "Law of mesh a-b: LTCA, slices, means over the cycle; assumed: tip" in done.stdout
    for word in ("check", "draw"):
        out = ["-o", str(tmp_path / "train.svg")] if word == "draw" else []
        assert CliRunner().invoke(app, [word, str(file), *out]).exit_code == 0
    from loadshare.report.tables import torque_table

    assert any("LTCA, slices" in note for note in torque_table(ls.solve(case)).notes)
