"""Several cases on a page: differences come first, and nothing else is shown as different."""

from __future__ import annotations

from datetime import UTC, datetime

import pytest
from tests.report.pages import Reader
from tests.support import shipped

import loadshare as ls
from loadshare.report.page import chapter, report_page
from loadshare.report.page.comparison import comparison
from loadshare.report.page.inputs import written

BEARING = "force on the bearing or pin"
MADE = datetime(2024, 5, 1, 12, 30, tzinfo=UTC)


@pytest.fixture(scope="module")
def star():
    return shipped("star/floating_sun_4")


def words(table):
    return {row[0].text: [cell.text for cell in row[1:]] for row in table.rows}


def test_a_case_beside_itself_differs_in_nothing(star):
    inputs, figures, *rests = comparison(["a", "b"], [ls.solve(star), ls.solve(star)])
    assert inputs.rows == figures.rows == rests == []
    assert "inputs are the same" in inputs.notes[0]


def test_cases_that_share_nothing_have_no_count_of_what_they_share():
    results = [ls.solve(shipped(n)) for n in ("planetary/star", "planetary/differential")]
    _, figures, *_ = comparison(["a", "b"], results)
    assert not any("0 other" in note for note in figures.notes)


def test_words_of_an_input_are_those_of_a_case_file():
    assert written({"held": True, "centre": ["0 mm", "1 mm"]}) == "held true; centre 0 mm, 1 mm"


def test_twice_the_load_is_twice_every_torque():
    """Linear springs without gaps: only the forces depend on the size of the load."""
    case = shipped("fgfbstts/rigid_closed_form").replace({"meshes.4-6.gap": "0 rad"})
    torque = max(case.operating.input_torque)
    more = case.replace({"operating.torque": f"{2 * torque!r} N*m"})
    inputs, figures, *_ = comparison(["a", "b"], [ls.solve(case), ls.solve(more)])
    assert list(words(inputs)) == ["operating.torque"]
    changes = [row[-1].value for row in figures.rows if row[0].text == "torque on the driver"]
    assert changes == pytest.approx([100.0] * len(case.meshes))
    assert not any(row[0].text.startswith("Ω") for row in figures.rows)


def test_round_off_is_no_difference():
    """A bearing that carries 3e-8 N in one case and nothing in the other is not a difference."""
    results = [ls.solve(shipped(f"fgfbstts/{n}")) for n in ("limit_ring", "installation_error")]
    _, figures, *_ = comparison(["a", "b"], results)
    rows = [r for r in figures.rows if [c.text for c in r[:2]] == [BEARING, "gear 5"]]
    assert rows == []
    assert any(r[0].text == BEARING for r in figures.rows)


def test_what_changes_stands_with_both_figures():
    case = shipped("fgfbstts/limit_ring")
    other = case.replace({"errors.6.installation": ["30 um", "100 um"]})
    results = [ls.solve(case), ls.solve(other)]
    inputs, figures, *_ = comparison(["case 1", "case 2"], results)
    assert words(inputs) == {"errors.6.installation": ["0 um, 100 um", "30 um, 100 um"]}
    (system,) = [
        r for r in figures.rows if [c.text for c in r[:2]] == ["Ω over stage", "the system"]
    ]
    before, after = (r.omega["system"] for r in results)
    assert [system[2].value, system[3].value] == [before, after]
    assert system[4].value == pytest.approx(100 * (after - before) / before)
    sizes = [abs(r[-1].value) for r in figures.rows if not r[0].text.startswith("Ω")]
    assert sizes == sorted(sizes, reverse=True)


def test_the_page_opens_on_what_differs(star):
    other = star.replace({'errors."planet1".installation': ["20 um", "0 um"]})
    one = chapter(star)
    text = Reader(report_page([one, chapter(other)], made=MADE)).text
    assert text.index("What differs") < text.index("certified 1 of 1") < text.index("Pictures")
    alone = Reader(report_page([one], made=MADE)).text
    assert "What differs" not in alone
    found = [
        alone.index(w) for w in ("Load sharing by stage", "Largest forces", "Pictures", "Inputs")
    ]
    assert found == sorted(found)


def test_a_negative_figure_that_becomes_smaller_changes_downwards():
    """−100 to −50 N·m is −50 %, like the change of a force's size."""
    case = shipped("fgfbstts/rigid_closed_form").replace({"meshes.4-6.gap": "0 rad"})
    torque = max(case.operating.input_torque)
    brakes = [case.replace({"operating.torque": f"{-k * torque!r} N*m"}) for k in (1.0, 0.5)]
    _, figures, *_ = comparison(["a", "b"], [ls.solve(c) for c in brakes])
    rows = [row for row in figures.rows if row[0].text == "torque on the driver"]
    assert all(row[2].value < row[3].value < 0.0 for row in rows)
    assert [row[-1].value for row in rows] == pytest.approx([-50.0] * len(case.meshes))
