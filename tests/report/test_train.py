"""The drawing: circles that touch, lines that are tangent, misfits in red."""

from __future__ import annotations

import math
from itertools import groupby

import numpy as np
import pytest
from tests.support import CASES, EVERY_SHIPPED, shipped

import loadshare as ls
from loadshare.case.reader import load_draft
from loadshare.report.figures.layout import FIXED, FLOATS, layout_of
from loadshare.report.figures.paths import circle, corners
from loadshare.report.figures.train import train
from loadshare.report.flanks import carrying
from loadshare.train import build_train


@pytest.fixture
def moved_idler(tmp_path):
    """Write a case whose gear 6 is 3.17 degrees out of place."""
    base = (CASES / "fgfbstts/limit_ring.toml").as_posix()
    file = tmp_path / "wrong.toml"
    centre = '{ about = "10", distance = "525.6314 mm", angle = "38 deg" }'
    file.write_text(f"extends = '{base}'\n[gears.6]\ncentre = {centre}\n", encoding="utf-8")
    return file


@pytest.mark.parametrize("name", EVERY_SHIPPED)
def test_pitch_circles_touch_in_every_case(name):
    """The two pitch circles meet at the pitch point, from whichever gear it is computed."""
    case = shipped(name)
    layout = layout_of(case, build_train(case))
    assert len(layout.pairs) == len(case.meshes)
    for pair in layout.pairs:
        assert pair.fits
        for gear, radius in zip((pair.driver, pair.driven), pair.pitch_radii, strict=True):
            body = layout.bodies[gear]
            arm = pair.pitch_point - body.centre
            arm = arm - (arm @ body.axis) * body.axis
            kinds = {layout.bodies[n].kind for n in (pair.driver, pair.driven)}
            if "face" in kinds and body.kind != "face":
                continue
            # Cases give base radii and centres with four decimals of a millimetre: a case may have
            # a misfit of 1e-3, the shipped ones fit to 1e-5.
            assert np.linalg.norm(arm) == pytest.approx(radius, rel=2e-5)


@pytest.mark.parametrize("name", ["fgfbstts/limit_ring", "two_path/clocking_error"])
def test_lines_of_action_are_tangent_to_both_base_circles(name, drawing, read):
    case = shipped(name)
    layout = layout_of(case, build_train(case))
    spec = read(drawing(name).spec)
    lines = {r["part"]: [] for r in spec.rows("line", "part") if r["part"] in case.meshes}
    for unit in spec.marks("line"):
        if unit["mark"].get("color") == "#1f2933":
            for row in unit["rows"]:
                # Leaders from a name to a centre also have the ink colour, but are no mesh.
                if "part" in row:
                    lines[row["part"]].append((row["x"], row["y"]))
    seen = 0
    for pair in layout.pairs:
        bodies = [layout.bodies[n] for n in (pair.driver, pair.driven)]
        if any(b.kind != "external" for b in bodies):
            continue
        tail, tip = (np.array(p) for p in lines[pair.name][:2])
        way = (tip - tail) / np.linalg.norm(tip - tail)
        for body in bodies:
            away = 1e3 * body.centre[:2] - tail
            distance = abs(way[0] * away[1] - way[1] * away[0])
            assert distance == pytest.approx(1e3 * body.base_radius, rel=1e-4)
        # The driver pushes the driven gear away from itself.
        assert way @ (1e3 * bodies[1].centre[:2] - 1e3 * bodies[0].centre[:2]) > 0.0
        seen += 1
    assert seen >= 2


def test_arrows_of_a_result_are_those_of_the_flanks_that_carry(read):
    """A push on the coast flank is tangent to the same base circles, but turns the other way."""
    case = shipped("fgfbstts/all_elements").replace({"operating.power": "-2000 kW"})
    built, result = build_train(case), ls.solve(case, positions=[1])
    drive = layout_of(case, built).pairs
    coast = layout_of(case, built, list(carrying(result.positions[0]))).pairs
    seen = 0
    for one, other in zip(drive, coast, strict=True):
        bodies = [layout_of(case, built).bodies[n] for n in (one.driver, one.driven)]
        if any(b.kind != "external" for b in bodies):
            continue
        for body in bodies:
            arm = one.pitch_point - body.centre
            turns = [float(body.axis @ np.cross(arm, m)) for m in (*one.pushes, *other.pushes)]
            assert abs(turns[0]) == pytest.approx(body.base_radius, rel=1e-3)
            # Both flanks of a jammed mesh push; the coast flank comes last.
            assert turns[-1] == pytest.approx(-turns[0], rel=1e-3)
        seen += 1
    assert seen == 8
    assert "push of the flanks that carry at position 1" in read(result.plot.train().spec).words()
    assert "push of the drive flanks" in read(train(case).spec).words()


def test_bent_arrows_run_in_the_running_sense(drawing, read):
    case = shipped("star/floating_sun_3")
    built = build_train(case)
    spec = read(drawing("star/floating_sun_3").spec)
    turned = {}
    for unit in spec.marks("line"):
        if unit["mark"].get("strokeWidth") == 1.8:
            for gear, drawn in groupby(unit["rows"], key=lambda row: row["gear"]):
                points = [(r["x"], r["y"]) for r in list(drawn)[:60]]
                middle = min(
                    built.gears.values(),
                    key=lambda g, p=points: float(
                        np.std([math.dist(1e3 * g.centre[:2], q) for q in p])
                    ),
                )
                assert middle.centre == pytest.approx(built.gears[gear].centre)
                a, b = (np.array(p) - 1e3 * middle.centre[:2] for p in (points[0], points[10]))
                sense = math.copysign(1.0, a[0] * b[1] - a[1] * b[0])
                turned.setdefault(gear, []).append(sense)
    for number in (1, 2, 3):
        assert turned[f"planet{number}"] == [built.gears[f"planet{number}"].sense]
    # Sun and ring are coaxial and run in opposite senses.
    coaxial = turned.get("sun", []) + turned.get("ring", [])
    assert sorted(coaxial) == [-1.0, 1.0]
    assert built.gears["sun"].sense == -built.gears["ring"].sense


def test_floating_gears_are_marked(drawing, read):
    figure = drawing("fgfbstts/limit_ring")
    rows = {r["gear"]: r for r in read(figure.spec).rows("point", "held")}
    assert {g for g, r in rows.items() if r["held"] == FLOATS} == {"1", "4", "5"}
    assert rows["10"]["held"] == FIXED
    assert rows["4"]["centre"].startswith("248.75")


def test_a_wrong_centre_is_seen_at_once(moved_idler, read):
    with pytest.raises(ls.CaseError):
        ls.load_case(moved_idler)
    spec = read(train(load_draft(moved_idler)).spec)
    distance = math.dist(
        (497.5 * math.cos(math.pi / 3), 497.5 * math.sin(math.pi / 3)),
        (525.6314 * math.cos(math.radians(38)), 525.6314 * math.sin(math.radians(38))),
    )
    needed = (45.9 + 114.75) / math.cos(math.radians(18.75))
    words = spec.words()
    assert f"the centres are {distance:.3f} mm apart, the radii need {needed:.3f} mm" in words
    assert f"{distance - needed:.1f} mm too far apart" in words
    red = [u for u in spec.marks("line") if u["mark"].get("color") == "#b3261e"]
    assert {r["mesh"] for u in red for r in u["rows"] if "mesh" in r} == {"4-6"}


def test_what_cannot_be_read_is_left_out(tmp_path, read):
    file = tmp_path / "torn.toml"
    base = (CASES / "star/floating_sun_3.toml").as_posix()
    file.write_text(
        f"extends = '{base}'\n[gears.planet2]\nbase_radius = 3\n"
        "[gears.planet3]\ncentre = { about = 'nowhere', distance = '1 mm', angle = '0 deg' }\n",
        encoding="utf-8",
    )
    draft = load_draft(file)
    assert len(draft.problems) >= 2
    rows = read(train(draft).spec).rows("point", "gear")
    assert {r["gear"] for r in rows} == {"sun", "planet1", "ring"}


def test_nothing_to_draw_says_so(tmp_path):
    file = tmp_path / "empty.toml"
    file.write_text("title = 'nothing'\n", encoding="utf-8")
    with pytest.raises(ls.LoadshareError, match="nothing can be drawn"):
        train(load_draft(file))


def test_a_side_view_only_where_heights_differ(drawing):
    assert len(drawing("star/floating_sun_3").spec["vconcat"]) == 1
    assert len(drawing("two_path/clocking_error").spec["vconcat"]) == 2
    assert len(drawing("fgfbstts/limit_ring").spec["vconcat"]) == 2


def test_views_are_to_scale(drawing, read):
    spec = drawing("fgfbstts/limit_ring").spec
    factors = []
    for view in spec["vconcat"]:
        (unit, *_) = read({**view, "datasets": spec.get("datasets", {})}).marks("line")
        for channel, size in (("x", "width"), ("y", "height")):
            low, high = unit["encoding"][channel]["scale"]["domain"]
            factors.append(view[size] / (high - low))
    assert factors == pytest.approx([factors[0]] * 4, rel=1e-9)


def test_a_path_keeps_its_corners_and_where_it_turns_back():
    """A circle seen from the side is one line there and back; a circle has only corners."""
    round_ = circle((3.0, -2.0), 40.0)
    assert corners(round_) == round_
    flat = [(x, 0.3 * x + 1.0) for x, _ in round_]
    assert corners(flat) == [flat[0], flat[len(flat) // 2], flat[-1]]
    square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 2.0)]
    assert corners(square) == [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]


def test_a_long_title_makes_no_picture_wider():
    case = shipped("star/floating_sun_3").replace({"title": "of any length " * 100})
    wide = len(shipped("fgfbstts/limit_ring").title)
    lines = train(case).spec["title"]["subtitle"]
    assert wide < max(map(len, lines)) <= 150
    assert " ".join(lines).startswith(case.title.strip())
