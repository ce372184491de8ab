"""Looks: a gear looks the same everywhere, and differs from others in colour and in grey."""

from __future__ import annotations

from itertools import pairwise

import pytest
from tests.support import SHIPPED, shipped

import loadshare as ls
from loadshare.report.figures.marks import distinct
from loadshare.report.palette import COLOURS, Palette, ends_from_names, look, palette_of

BRANCHES = {
    "1-2": "2",
    "1-3": "3",
    "4-6": "6",
    "4-7": "7",
    "6-10": "6",
    "9-10": "9",
}


def luminance(colour: str) -> float:
    """Return the relative luminance of a colour by WCAG 2."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [v / 12.92 if v <= 0.03928 else ((v + 0.055) / 1.055) ** 2.4 for v in parts]
    return sum(w * v for w, v in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def test_seventy_looks_differ_and_neighbours_differ_in_everything():
    looks = [look(k) for k in range(70)]
    assert len(set(looks)) == 70
    for one, other in pairwise(looks):
        assert one.colour != other.colour
        assert one.dash != other.dash
        assert one.shape != other.shape


def test_colours_are_dark_enough_on_white():
    # A line of 1.5 px needs 2.2:1 to be followed by eye; text never has these colours.
    assert all(1.05 / (luminance(c) + 0.05) > 2.2 for c in COLOURS)


def test_a_branch_is_named_by_the_gear_that_tells_it_apart(limit_ring):
    palette = palette_of(limit_ring)
    for mesh, gear in BRANCHES.items():
        assert palette.branch(mesh) == gear
        assert palette.mesh(mesh) == palette.gear(gear)


def test_planets_of_a_star_keep_their_colour_in_both_stages():
    result = ls.solve(shipped("star/floating_sun_4"))
    palette = palette_of(result)
    for k in range(1, 5):
        assert palette.mesh(f"sun-planet{k}") == palette.mesh(f"planet{k}-ring")
        assert palette.mesh(f"sun-planet{k}") == palette.gear(f"planet{k}")


@pytest.mark.parametrize("name", [n for n in SHIPPED if "all_elements" not in n])
def test_names_tell_the_same_as_the_case(name):
    case = shipped(name)
    known = {n: (m.driver, m.driven) for n, m in case.meshes.items()}
    assert ends_from_names(case.meshes, case.gears) == known


def test_a_name_that_tells_no_gears_still_has_a_look():
    palette = Palette(["a", "b"], ends_from_names(["upper", "a-b-a"], ["a", "b"]))
    assert palette.branch("upper") is None
    assert palette.mesh("upper").colour in COLOURS


def test_equal_looks_in_one_panel_are_distinguished():
    same = {"a-b": look(3), "b-a": look(3), "c": look(3)}
    found = distinct(same)
    assert len(set(found)) == 3
    assert {one.colour for one in found} == {look(3).colour}


def test_pictures_agree_on_a_gears_colour(limit_ring, picture, drawing, read):
    wanted = palette_of(limit_ring).gear("4").colour
    points = read(picture("limit_ring", "floats").spec).marks("point")
    drawn = [p["mark"]["color"] for p in points]
    assert drawn == [palette_of(limit_ring).gear(g).colour for g in ("1", "4", "5")]
    circles = read(drawing("fgfbstts/limit_ring").spec).marks("line")
    found = {
        r["colour"]
        for u in circles
        for r in u["rows"]
        if "circle" in r and r["circle"].startswith("gear 4,")
    }
    assert found == {wanted}
