"""The picture of the floats shows the content of the result."""

from __future__ import annotations

import math
from collections import Counter

import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.report.words import direction_name, places_text


def panels(figure, read):
    return [
        read({**panel, "datasets": figure.spec.get("datasets", {})})
        for panel in figure.spec["concat"]
    ]


@pytest.mark.parametrize("name", ["limit_ring", "all_elements", "full_float", "pressed_sun"])
def test_points_are_the_displacements(request, picture, read, name):
    result = request.getfixturevalue(name)
    figure = picture(name, "floats")
    for gear, panel in zip(result.positions[0].floats, panels(figure, read), strict=True):
        (points,) = panel.marks("point")
        assert [r["position"] for r in points["rows"]] == [p.position for p in result.positions]
        for row, p in zip(points["rows"], result.positions, strict=True):
            x, y = p.displacement[gear]
            assert (row["x"], row["y"]) == pytest.approx((1e6 * x, 1e6 * y), rel=1e-12)


@pytest.mark.parametrize("name", ["limit_ring", "all_elements", "full_float", "pressed_sun"])
def test_scales_are_equal_and_everything_is_in_the_picture(picture, read, name):
    figure = picture(name, "floats")
    for panel in panels(figure, read):
        assert panel.spec["width"] == panel.spec["height"]
        domains = {
            c: tuple(u["encoding"][c]["scale"]["domain"])
            for u in panel.marks("point")
            for c in "xy"
        }
        widths = [high - low for low, high in domains.values()]
        assert widths[0] == pytest.approx(widths[1], rel=1e-9)
        for row in panel.rows("point", "x"):
            for c in "xy":
                assert domains[c][0] < row[c] < domains[c][1]


def test_the_enlargement_is_the_one_drawn(picture, read):
    figure = picture("limit_ring", "floats")
    for panel in panels(figure, read):
        low, high = panel.marks("point")[0]["encoding"]["x"]["scale"]["domain"]
        enlarged = next(line for line in panel.words().splitlines() if line.startswith("enlarged"))
        factor = float(enlarged.split()[2].replace(",", ""))
        # The factor is given with two digits.
        assert factor == pytest.approx(75e-3 / ((high - low) * 1e-6), rel=0.05)
        # 75 mm at 96 px per inch.
        assert panel.spec["width"] == pytest.approx(75.0 / 25.4 * 96.0, abs=1.0)


def test_the_seeds_balance_points_are_reported(limit_ring, picture, read):
    words = read(picture("limit_ring", "floats").spec).words()
    assert "on boundary: upper stop + arc 6" in words
    assert "on boundary: upper stop + arc 8" in words
    assert "undetermined: no force determines it" in words
    for gear in ("4", "5"):
        force = math.hypot(*limit_ring.positions[0].floats[gear].reaction)
        assert f"{force:.4g} N" in words.splitlines()
    assert "1–5" in words


def test_the_arrow_is_the_reaction(limit_ring, picture, read):
    _, panel, _ = panels(picture("limit_ring", "floats"), read)
    arrow = next(u["rows"] for u in panel.marks("line") if u["mark"].get("color") == "#b3261e")
    start, tip = ((r["x"], r["y"]) for r in arrow[:2])
    rest = limit_ring.positions[0].floats["4"]
    size = math.hypot(*rest.reaction)
    length = math.dist(start, tip)
    assert start == pytest.approx(
        [1e6 * v for v in limit_ring.positions[0].displacement["4"]], rel=1e-6
    )
    for k in (0, 1):
        # Rows contain seven digits.
        assert (tip[k] - start[k]) / length == pytest.approx(rest.reaction[k] / size, abs=1e-5)


def test_the_circles_of_a_spline_are_its_radii(picture, read):
    # K_w = 1.78e7 N/m, F_m = 0.1 · 500 N: the spline slips beyond 50/1.78e7 m.
    _, panel, _ = panels(picture("full_float", "floats"), read)
    (circle,) = {r["circle"] for r in panel.rows("line", "circle")}
    assert circle == "slips beyond 2.81 µm"
    radii = [math.hypot(r["x"], r["y"]) for r in panel.rows("line", "circle")]
    assert radii == pytest.approx([50.0 / 17.8] * len(radii), rel=1e-6)
    assert "clearance used up at 400 µm (not shown)" in panel.words()
    _, panel, _ = panels(picture("all_elements", "floats"), read)
    used = [r for r in panel.rows("line", "circle") if r["circle"] == "clearance used up at 40 µm"]
    assert [math.hypot(r["x"], r["y"]) for r in used] == pytest.approx([40.0] * len(used), rel=1e-6)


def test_states_that_differ_are_counted(all_elements, picture, read):
    words = read(picture("all_elements", "floats").spec).words()
    counts = [line for line in words.splitlines() if " of 4" in line]
    assert counts
    for gear in ("4", "5"):
        states = Counter(p.floats[gear].boundary for p in all_elements.positions)
        for boundary, count in states.items():
            if len(states) > 1:
                assert f"on boundary: {boundary} at {count} of 4" in counts
    assert "spline: " in words
    assert "reaction up to" in words


def test_a_case_without_floats_says_so():
    result = ls.solve(shipped("fgfbstts/base"), positions=[1])
    with pytest.raises(ls.LoadshareError, match="no gear floats"):
        result.plot.floats()


@pytest.mark.parametrize(
    ("numbers", "text"),
    [([1, 2, 3], "1–3"), ([5], "5"), ([1, 3, 4, 9], "1, 3–4, 9"), ([1, 3, 5, 7], "1, 3, 5 …")],
)
def test_places(numbers, text):
    assert places_text(numbers) == text


@pytest.mark.parametrize(
    ("vector", "text"),
    [((0, 0, -1), "−z"), ((1, 0, 0), "x"), ((0.6, 0.8, 0), "(0.6, 0.8, 0)")],
)
def test_directions(vector, text):
    assert direction_name(vector) == text
