"""Pictures of a pair against the computed values."""

import math

import numpy as np
import pytest

from loadshare.report.figures.ltca_cycle import stiffness, transmission_error
from loadshare.report.figures.ltca_flank import contact_pattern, load_map, plane_of
from loadshare.tooth.pair.file import load_pair


@pytest.fixture
def analysed(spur):
    pair = load_pair(spur)
    geometry = pair.geometry
    planes = plane_of(geometry.driver, 1), plane_of(geometry.driven, geometry.driven_side)
    return pair, pair.analyse(), planes


def rows_of(figure):
    """Return all data of a figure."""
    return [row for rows in figure.spec["datasets"].values() for row in rows]


def test_a_flank_is_rolled_out_to_its_size(analysed):
    pair, _, (driver, _) = analysed
    gear = pair.geometry.driver_gear
    # Length of an involute between two angles of roll: r_b (ξ² − ξ0²)/2.
    profile = 0.5 * gear.base_radius * (gear.tip_roll**2 - gear.form_roll**2)
    assert driver.size[0] == pytest.approx(20e-3, rel=1e-12)
    # 64 chords of the involute.
    assert driver.size[1] == pytest.approx(profile, rel=1e-4)
    corner = driver.at(np.array([[1.0, 1.0], [driver.foot, 0.0]]))
    np.testing.assert_allclose(corner, [driver.size, (0.0, 0.0)], atol=1e-15)


def test_the_stiffness_is_that_of_the_analysis(analysed):
    pair, found, _ = analysed
    rows = [row for row in rows_of(stiffness(found, pair.title)) if row["name"] == "T"]
    shown = {row["x"]: row["y"] for row in rows}
    assert shown[0.0] == shown[1.0] == pytest.approx(found.secant(1.0)[0] * 1e-3)
    assert shown[0.5] == pytest.approx(found.secant(1.0)[1] * 1e-3)


def test_the_error_is_shown_with_and_without_load(analysed):
    pair, found, _ = analysed
    rows = rows_of(transmission_error(found, pair.title))
    assert {row["name"] for row in rows} == {"T", "0.5 T", "0.1 T", "no load"}
    assert max(row["y"] for row in rows) == pytest.approx(1e6 * found.angle[:, -1].max())


def test_the_load_map_holds_all_lines_within_the_flank(analysed):
    pair, found, planes = analysed
    rows = rows_of(load_map(found, planes, pair.title))
    lines = {(row["position"], row["pair"]) for row in rows}
    assert lines == {
        (k + 1, line.pair) for k, place in enumerate(found.positions) for line in place.lines
    }
    force = sum(
        row["value"] * math.hypot(row["x2"] - row["x"], row["y2"] - row["y"]) for row in rows
    )
    # Both positions carry the torque; figures are rounded to five digits.
    assert force == pytest.approx(2 * 100.0 / pair.geometry.arm, rel=1e-3)


def test_the_pattern_is_as_wide_as_the_contact(analysed):
    pair, found, planes = analysed
    figure = contact_pattern(found, planes, pair.title)
    largest = max(float(load.half_width.max()) for row in found.lines for load in row[-1])
    assert len(figure.spec["datasets"]) == 2
    for rows in figure.spec["datasets"].values():
        # Corners 1 and 2 of a cell are opposite each other across the line.
        sides = [{row["cell"]: row["y"] for row in rows if row["order"] == k} for k in (1, 2)]
        widest = max(abs(sides[1][cell] - sides[0][cell]) for cell in sides[0])
        assert widest == pytest.approx(2e3 * largest, rel=1e-3)


def test_every_figure_is_drawn(analysed, tmp_path):
    pair, found, planes = analysed
    for figure in (
        stiffness(found, pair.title),
        transmission_error(found, pair.title),
        load_map(found, planes, pair.title),
        contact_pattern(found, planes, pair.title),
    ):
        text = figure.save(tmp_path / f"{figure.name}.svg").read_text(encoding="utf-8")
        assert "A spur pair" in text
