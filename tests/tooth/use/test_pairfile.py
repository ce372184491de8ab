"""Pair files: their results, and the reports on their mistakes."""

import math
import re

import numpy as np
import pytest
from tests.tooth.use.pairs import FACE, PAIRS, SPUR, written

from loadshare.case.described import schema_of
from loadshare.errors import CaseError, Refused
from loadshare.tooth.cylindrical.pair import Misalignment
from loadshare.tooth.face.pair import FaceGearPair
from loadshare.tooth.law.file import law_of
from loadshare.tooth.pair.file import load_pair
from loadshare.tooth.pair.model import CONTENTS
from loadshare.tooth.unloaded.positions import transmission_error


def problems_in(path):
    with pytest.raises(CaseError) as caught:
        load_pair(path)
    assert all(problem.file == str(path) for problem in caught.value.problems)
    return {problem.key: problem for problem in caught.value.problems}


def test_the_driven_gear_takes_what_it_leaves_out_from_the_driver(tmp_path):
    text = SPUR.replace("[driven]", 'helix_angle = "12 deg"\n[driven]')
    pair = load_pair(written(tmp_path, text)).geometry
    driven = pair.driven_gear
    assert driven.module == pytest.approx(3e-3, rel=1e-15)
    assert driven.pressure_angle == pytest.approx(math.radians(20), rel=1e-15)
    assert driven.helix_angle == pytest.approx(-math.radians(12), rel=1e-15)
    # a = m (z1 + z2)/(2 cos β): no profile shift, no backlash.
    assert pair.centre_distance == pytest.approx(0.1125 / math.cos(math.radians(12)), rel=1e-12)


def test_an_internal_gear_has_the_same_hand_as_its_pinion(tmp_path):
    text = SPUR.replace(
        "[driven]\nteeth = 50", "[driven]\ninternal = true\naddendum = 0.8\nteeth = 80"
    )
    text = text.replace("[driven]", 'helix_angle = "12 deg"\n[driven]')
    pair = load_pair(written(tmp_path, text)).geometry
    assert pair.driven_gear.internal
    assert pair.driven_gear.helix_angle == pair.driver_gear.helix_angle > 0.0


def test_every_value_reaches_its_gear(tmp_path):
    text = SPUR.replace(
        "[driven]",
        """rim = "20 mm"
youngs_modulus = "210 GPa"
poisson = 0.28
profile_shift = 0.1
[driver.modification]
tip_relief = "20 um"
tip_relief_length = "2 mm"
tip_relief_exponent = 2
lead_crowning = "5 um"
[misalignment]
centre_distance = "0.1 mm"
deviation = "1 mrad"
[driven]""",
    )
    pair = load_pair(written(tmp_path, "helices = 1\n" + text)).geometry
    gear = pair.driver_gear
    assert (gear.rim, gear.youngs_modulus, gear.poisson) == (0.02, 2.1e11, 0.28)
    assert gear.modification.tip_relief == pytest.approx(20e-6, rel=1e-15)
    assert gear.modification.tip_relief_length == pytest.approx(2e-3, rel=1e-15)
    assert gear.modification.lead_crowning == pytest.approx(5e-6, rel=1e-15)
    assert pair.misalignment == Misalignment(centre_distance=1e-4, deviation=1e-3)


def test_a_face_gear_is_cut_by_a_shaper_of_its_pinion(tmp_path):
    text = FACE.replace('face_width = "20 mm"', 'face_width = "20 mm"\nprofile_shift = 0.05')
    pair = load_pair(written(tmp_path, text)).geometry
    assert isinstance(pair, FaceGearPair)
    shaper = pair.gear.shaper
    assert (shaper.module, shaper.teeth, shaper.profile_shift) == (4e-3, 27, 0.05)
    assert shaper.pressure_angle == pair.pinion.pressure_angle


def test_all_problems_are_reported_at_once(tmp_path):
    text = SPUR.replace('"3 mm"', '"3 kg"').replace("[driven]\nteeth = 50", "[driven]\nteth = 50")
    text = text.replace('"slices"', '"slice"').replace('"100 N*m"', '"-1 N*m"')
    problems = problems_in(written(tmp_path, text))
    assert set(problems) == {
        "driver.module",
        "driven.teeth",
        "driven.teth",
        "analysis.compliance",
        "torque",
    }
    assert problems["driver.module"].message == "is a mass, but a length is needed"
    assert problems["driven.teth"].hint == "Did you mean teeth?"
    assert problems["analysis.compliance"].hint == "Did you mean slices?"


@pytest.mark.parametrize(
    ("change", "key", "message"),
    [
        (('kind = "helicoid"', ""), "kind", "is missing"),
        (('"helicoid"', '"helicoids"'), "kind", "is not a kind of pair"),
        (('module = "3 mm"', ""), "driver.module", "is missing"),
        (('"slices"', '"slices"\nteeth = 3'), "analysis.teeth", "applies to finite elements"),
        (
            ('compliance = "slices"', 'compliance = "finite elements"\nteeth = 4'),
            "analysis.teeth",
            "is even",
        ),
        (
            ('title = "', 'helix_gap = "6 mm"\ntitle = "'),
            "helix_gap",
            "applies only to herringbone pairs",
        ),
        (('title = "', 'assumed = ["driver.modul"]\ntitle = "'), "assumed[0]", "matches no key"),
    ],
)
def test_a_wrong_file_is_reported(tmp_path, change, key, message):
    problems = problems_in(written(tmp_path, SPUR.replace(*change)))
    assert message in problems[key].message


def test_problems_of_the_geometry_stand_where_they_were_written(tmp_path):
    text = SPUR.replace("teeth = 25", "teeth = 12\nprofile_shift = -0.1")
    problem = problems_in(written(tmp_path, text))["driver.profile_shift"]
    assert problem.given == "-0.1"
    assert "undercuts" in problem.message


@pytest.mark.parametrize(
    ("text", "key", "line"),
    [
        *((SPUR.replace("teeth = 25", f"teeth = {z}"), "driver.profile_shift", "[driven]")
          for z in range(7, 17)),
        *((SPUR.replace("teeth = 25", f"teeth = {z}\naddendum = 1.75"), "driver.addendum", None)
          for z in range(18, 26)),
        *((FACE.replace("teeth = 120", f"teeth = {z}"), "driven.inner", None)
          for z in (130, 131, 132)),
        *((FACE.replace("teeth = 120", f"teeth = {z}"), "driven.outer", None)
          for z in (100, 101, 102)),
        *((FACE.replace("outer =", f"addendum = {a}\nouter =").replace("25 deg", "20 deg"),
           "driven.addendum", None) for a in (1.25, 1.24)),
    ],
)  # fmt: skip
def test_a_limit_that_is_told_may_be_written(text, key, line, tmp_path):
    """A limit of six digits is rounded towards the side on which the value is allowed."""
    gear, name = key.split(".")
    problem = problems_in(written(tmp_path, text))[key]
    limit = re.search(r"(-?\d[\d.]*( mm)?)( |$)", problem.allowed.removeprefix("at least L1 = "))
    told = f'"{limit[1]}"' if limit[2] else limit[1]
    if line:
        again = text.replace(line, f"{name} = {told}\n{line}")
    else:
        again = re.sub(rf"(\[{gear}\](\n.*)*?\n{name} = ).*", rf"\g<1>{told}", text)
    assert again != text
    left = []
    try:
        load_pair(written(tmp_path, again))
    except CaseError as error:
        left = [found.message for found in error.problems]
    assert problem.message not in left


RING = "internal = true\naddendum = 0.8\nteeth = 80"


@pytest.mark.parametrize(
    ("driven", "near", "told", "fits"),
    [
        ("teeth = 50", "112.4 mm", "0.0681738 mm", "at least 112.5 mm"),
        (RING, "82.6 mm", "0.0687156 mm", "at most 82.5 mm"),
    ],
)
def test_teeth_have_room_for_one_another_as_in_a_case(tmp_path, driven, near, told, fits):
    text = SPUR.replace("[driven]\nteeth = 50", f"[driven]\n{driven}")
    text = text.replace("title", f'centre_distance = "{near}"\ntitle')
    problem = problems_in(written(tmp_path, text))["centre_distance"]
    assert problem.message == f"at this centre distance the teeth overlap by {told}"
    assert problem.allowed == fits
    for there in (fits[-8:], "112.498 mm" if fits[3] == "l" else "82.502 mm"):
        load_pair(written(tmp_path, text.replace(near, there)))
    # Thinner teeth, as the hint says.
    thin = text.replace("[driven]", "profile_shift = -0.04\naddendum = 1.04\n[driven]")
    load_pair(written(tmp_path, thin))


SHARP = """helix_angle = "20 deg"
profile_shift = 0.8
tip_radius = 0.2
addendum = {}
[driven]
tip_radius = 0.2"""
"""Makes tips pointed at an addendum of 1.21484, on a pinion that would carry there."""


@pytest.mark.parametrize(
    ("addendum", "torque", "model", "positions", "what"),
    [
        (1.20984, "100 N*m", "slices", 3, "did not converge"),
        (1.20484, "10 kN*m", "slices", 5, "yield less under more load"),
        (1.214839, "100 N*m", "finite elements", 3, "did not converge"),
    ],
)
def test_thin_tips_are_named_where_contact_is_refused(
    tmp_path, addendum, torque, model, positions, what
):
    """The law used to have a negative stiffness, elements gave a traceback, and the remedy named
    was more points.
    """
    text = SPUR.replace("20 deg", "25 deg").replace("100 N*m", torque).replace("slices", model)
    text = text.replace("positions = 2\npoints = 8", f"positions = {positions}\npoints = 16")
    pair = load_pair(written(tmp_path, text.replace("[driven]", SHARP.format(addendum))))
    with pytest.raises(Refused, match=rf"{what}.*; driver\.addendum: the tip land is"):
        pair.analyse()


def test_a_misaligned_centre_distance_is_named_where_it_is_written(tmp_path):
    text = SPUR + '[misalignment]\ncentre_distance = "-8 mm"\n'
    problem = problems_in(written(tmp_path, text))["misalignment.centre_distance"]
    # 112.5 (cos 20° − 1) = −6.78458
    assert problem.allowed == "more than -6.78458 mm"
    text = SPUR.replace("title", 'centre_distance = "100 mm"\ntitle')
    text += '[misalignment]\ncentre_distance = "1 mm"\n'
    problem = problems_in(written(tmp_path, text))["centre_distance"]
    assert (problem.given, problem.allowed) == ('"100 mm"', "more than 104.716 mm")


def test_a_default_that_does_not_fit_is_reported_with_its_value(tmp_path):
    problem = problems_in(written(tmp_path, SPUR.replace('"20 deg"', '"28 deg"')))
    assert problem["driver.tip_radius"].given == "0.38"


def test_what_is_missing_is_told_with_what_else_is_wrong(tmp_path):
    text = SPUR.replace('module = "3 mm"\n', "").replace("teeth = 50", "").replace("= 8", "= 5000")
    found = problems_in(written(tmp_path, text))
    assert found.keys() == {"driver.module", "driven.teeth", "analysis.points"}
    assert found["analysis.points"].allowed == "a number of at most 500"


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(CaseError, match="no such file"):
        load_pair(tmp_path / "none.toml")


def test_the_hash_is_of_the_values_and_not_of_how_they_are_written(tmp_path):
    first = load_pair(written(tmp_path, SPUR)).hash
    same = SPUR.replace('"3 mm"', '"0.003 m"').replace("A spur pair", "Another title")
    assert load_pair(written(tmp_path, same)).hash == first
    for change in (
        ("teeth = 25", "teeth = 26"),
        ("100 N*m", "101 N*m"),
        ("points = 8", "points = 9"),
    ):
        assert load_pair(written(tmp_path, SPUR.replace(*change))).hash != first


def test_a_revised_pair_is_the_one_that_a_file_would_give(tmp_path):
    pair = load_pair(written(tmp_path, SPUR))
    text = SPUR.replace("positions = 2", "positions = 3").replace("100 N*m", "250 N*m")
    assert pair.revised(torque=250.0, positions=3).hash == load_pair(written(tmp_path, text)).hash
    exact = SPUR.replace("slices", "finite elements").replace(
        "points = 8", "points = 8\nlayers = 5"
    )
    fast = load_pair(written(tmp_path, exact)).revised(compliance="slices")
    assert fast.hash == pair.hash


def test_points_follow_the_model_where_the_file_does_not_tell_them(tmp_path):
    text = SPUR.replace("points = 8\n", "")
    fast = load_pair(written(tmp_path, text))
    exact = load_pair(written(tmp_path, text.replace("slices", "finite elements")))
    assert (fast.analysis.points, exact.analysis.points) == (16, 32)
    there = fast.revised(compliance="finite elements", positions=1)
    assert there.analysis.points == 32
    assert there.revised(compliance="slices").analysis.points == 16
    assert exact.revised(compliance="slices").hash == fast.hash
    found = there.revised(compliance="slices").analyse()
    assert len(found.positions[0].lines[0].length) == 16
    revised = load_pair(written(tmp_path, SPUR)).revised(compliance="finite elements")
    assert revised.analysis.points == 8


FEW = """
kind = "helicoid"
torque = "20 N*m"

[driver]
module = "2 mm"
teeth = 8
profile_shift = 0.6
addendum = 0.8
tip_radius = 0.25
pressure_angle = "20 deg"
helix_angle = "30 deg"
face_width = "50 mm"

[driven]
teeth = 40
addendum = 0.8
face_width = "50 mm"

[analysis]
positions = 1
"""


def test_a_pinion_of_few_teeth_has_room_in_its_elements(tmp_path):
    """Its contact ratio of 4.9 would need a model of nine teeth, more than it has."""
    text = FEW + "points = 4\nlayers = 2\n"
    found = [
        load_pair(written(tmp_path, text + more)).analyse().elastic[0, -1]
        for more in ("", "teeth = 7\n")
    ]
    # Without that key, the driven gear has nine.
    assert found[0] == pytest.approx(found[1], rel=1e-2)


@pytest.mark.parametrize(("text", "few"), [(SPUR, 25), (FACE, 25), (FEW, 8)])
def test_a_model_has_fewer_teeth_than_its_gears(text, few, tmp_path):
    text = text.replace('"slices"', '"finite elements"')
    asked = few + 1 - few % 2
    problem = problems_in(written(tmp_path, f"{text}teeth = {asked}\n"))["analysis.teeth"]
    assert problem.message == f"is too many for a gear of {few} teeth"
    assert problem.allowed == f"odd numbers below {few}, or left out"
    load_pair(written(tmp_path, f"{text}teeth = {asked - 2}\n"))


def test_a_pinion_of_few_teeth_keeps_a_body(tmp_path):
    """1.5 tooth heights would leave a bore too small to hold the body that winds up about it."""
    pair = load_pair(written(tmp_path, FEW)).revised(compliance="slices")
    gear = pair.geometry.driver_gear
    assert gear.root - 1.5 * (gear.tip - gear.root) < 0.25 * gear.root
    assert gear.rim_radius == 0.5 * gear.root
    lines = law_of(pair, pair.analyse()).findings
    assert "(assumed, half the root radius)" in next(one for one in lines if "driver" in one)
    assert "(assumed, 1.5 tooth heights)" in next(one for one in lines if "driven" in one)
    said = load_pair(written(tmp_path, FEW.replace("[driven]", 'rim = "1 mm"\n[driven]')))
    assert said.geometry.driver_gear.rim_radius == 1e-3


def test_options_of_the_finite_elements_reach_them(tmp_path):
    text = SPUR.replace('"slices"', '"finite elements"\nteeth = 1\nlayers = 2')
    coarse = load_pair(written(tmp_path, text)).revised(positions=1).analyse()
    finer = text.replace("layers = 2", "layers = 5")
    fine = load_pair(written(tmp_path, finer)).revised(positions=1).analyse()
    change = float(coarse.secant()[0] / fine.secant()[0]) - 1.0
    # Fewer elements are stiffer, and quadratic ones are already close.
    assert 0.0 < change < 0.05


def test_a_misaligned_pair_as_a_whole_is_turned_and_its_law_is_not(tmp_path):
    aligned = load_pair(written(tmp_path, FACE))
    text = FACE + '[misalignment]\ngear_shift = "20 um"\n'
    shifted = load_pair(written(tmp_path, text))
    # If it is shifted towards the pinion by s, the flank is met earlier by s sin α along the line
    # of action.
    lead = -20e-6 * math.sin(math.radians(25)) / aligned.geometry.arm
    assert aligned.offset == 0.0
    assert shifted.offset == pytest.approx(lead, rel=0.02)
    found = shifted.analyse()
    assert np.mean(found.unloaded_error - shifted.offset) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("key", ["deviation", "inclination"])
@pytest.mark.quick(1)
def test_a_tilt_about_the_middle_of_the_face_leaves_the_loaded_angle(tmp_path, key):
    """A case cannot state it, so the law keeps it: with the whole face in contact, both halves of
    the tilt cancel, and the lead at one end must not be subtracted from the law.
    """
    heavy = SPUR.replace("100 N*m", "300 N*m").replace("points = 8", "points = 16")
    tilt = f'[misalignment]\n{key} = "0.5 mrad"\n'
    pairs = [load_pair(written(tmp_path, text)) for text in (heavy, heavy + tilt)]
    laws = [law_of(pair, pair.analyse()) for pair in pairs]
    aligned, tilted = (
        [a.si + b.si * 300.0 + c.si * 300.0 ** (2 / 3) for a, b, c in zip(*abc, strict=True)]
        for abc in ((law.a, law.b, law.c) for law in laws)
    )
    # In the direction of the normal, an end of the face moves by 0.5 mrad · 10 mm times this.
    share = {"deviation": math.cos, "inclination": math.sin}[key](math.radians(20.0))
    lead = 0.5e-3 * 10e-3 * share / pairs[0].geometry.arm
    first = transmission_error(pairs[1].geometry, 0.0)
    assert first == pytest.approx(-lead, rel=0.02)
    assert tilted == pytest.approx(aligned, abs=0.02 * lead)


def test_a_tilt_of_a_face_gear_stays_in_its_law(tmp_path):
    """The same pair also has a shift, which the law leaves out as without a tilt."""
    tilt = '[misalignment]\nshaft_angle = "0.1 mrad"\n'
    shift = 'gear_shift = "20 um"\n'
    texts = FACE + tilt, FACE + tilt + shift, FACE + "[misalignment]\n" + shift
    tilted, both, shifted = (load_pair(written(tmp_path, text)) for text in texts)
    assert tilted.offset == 0.0
    # A tilt about the point where the axes cross moves the middle of the teeth, at 244.5 mm, like a
    # shift.
    lead = transmission_error(tilted.geometry, 0.0)
    assert lead == pytest.approx(shifted.offset * 0.1e-3 * 244.5e-3 / 20e-6, rel=0.1)
    assert both.offset == pytest.approx(shifted.offset, rel=0.05)


@pytest.mark.parametrize("name", ["p12", "p46", "p610"])
def test_shipped_pairs_are_sound(name):
    pair = load_pair(PAIRS / f"{name}.toml")
    assert "driver" in pair.content.assumed
    assert "driven" in pair.content.assumed
    assert pair.geometry.contact_ratio > 1.2


def test_shipped_teeth_have_the_papers_ratio():
    """I12·I46 is between 13.9230 and 13.9244 for any teeth that the paper may have used."""
    first, second, third = (load_pair(PAIRS / f"{n}.toml").content for n in ("p12", "p46", "p610"))
    ratio = first.driven.teeth / first.driver.teeth * second.driven.teeth / second.driver.teeth
    assert 13.9230 < ratio < 13.9244
    # Idler 6 is the driven gear of one pair and the driver of the other.
    idler, again = second.driven, third.driver
    for key in ("teeth", "profile_shift", "addendum", "dedendum", "tip_radius", "modification"):
        assert getattr(idler, key) == getattr(again, key)
    assert second.driver.module == third.driver.module
    assert second.driver.helix_angle.si == -third.driver.helix_angle.si


def test_every_key_of_a_pair_file_is_described():
    for model in CONTENTS.values():
        schema = schema_of(model)
        for table in (schema, *schema["$defs"].values()):
            for key, about in table.get("properties", {}).items():
                assert about.get("description") or "$ref" in about, key


@pytest.mark.parametrize(
    ("angle", "allowed"),
    [
        ("44 deg", "0, with a dedendum of at most 0.813303"),
        ("25 deg", "at most 0.317882 with this dedendum"),
    ],
)
def test_a_rack_without_room_for_a_tip_is_told_what_has(tmp_path, angle, allowed):
    """A quarter of the pitch, π/4, over tan 44° is 0.813."""
    found = problems_in(written(tmp_path, SPUR.replace("20 deg", angle)))
    assert found["driver.tip_radius"].allowed == allowed
