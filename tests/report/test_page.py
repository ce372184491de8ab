"""The report page: complete, self-contained, and safe against any text in a case."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from datetime import UTC, datetime

import pytest
from tests.report.pages import EVIL, EVIL_CASE, Reader
from tests.support import CASES, shipped

import loadshare as ls
from loadshare.report.page import (
    chapter,
    chapter_of_file,
    offline,
    report_page,
    save_report,
    write_report,
)
from loadshare.report.page.inputs import input_tables, written

MADE = datetime(2024, 5, 1, 12, 30, tzinfo=UTC)


@pytest.fixture(scope="module")
def ring_page(ring_chapter):
    return report_page([ring_chapter], made=MADE)


@pytest.fixture(scope="module")
def evil_page(tmp_path_factory):
    file = tmp_path_factory.mktemp("evil") / "evil.toml"
    file.write_text(EVIL_CASE, encoding="utf-8")
    one = chapter_of_file(file)
    assert one.outcome == "certified", one.problems
    return report_page([one, one], made=MADE)


def test_the_page_tells_what_was_computed(ring_page, ring_chapter):
    text = Reader(ring_page).text
    result = ring_chapter.result
    case = ring_chapter.case
    for words in (
        case.title,
        case.source,
        case.hash,
        "2024-05-01 12:30 UTC",
        "5 of 5 positions certified",
        "Input torque 2175.238 N·m on gear 1, output gear 10.",
        "on boundary: upper stop + arc 6",
        "loadshare run ",
        f"loadshare {ls.__version__}",
        "vl-convert-python",
        "Gear 1 x, gear 1 y: not determined, without limit.",
    ):
        assert words in text
    for torque in result.positions[0].torque.values():
        assert f"{torque:.1f}" in text
    for name in result.certificate.residuals:
        assert name.replace("_", " ") in text


def test_the_whole_case_is_on_the_page(ring_page, ring_chapter):
    toml = next(
        block
        for block in re.findall(r"<pre>(.*?)</pre>", ring_page, re.DOTALL)
        if "[operating]" in block
    )
    import html
    import tomllib

    assert ls.Case(tomllib.loads(html.unescape(toml))) == ring_chapter.case


def test_every_figure_is_on_the_page_twice(ring_page, ring_chapter):
    """It is there as a specification for the browser, and as SVG for one without scripts."""
    specs = re.findall(r'<script type="application/json" class="spec">(.*?)</script>', ring_page)
    wanted = [*ring_chapter.figures, ring_chapter.drawing]
    assert [json.loads(s) for s in specs] == [f.spec for f in wanted]
    assert [f.name for f in wanted] == ["share", "floats", "torque", "law", "train"]
    assert len(re.findall(r"<noscript><svg", ring_page)) == len(wanted)


def test_the_page_loads_nothing(ring_page):
    reader = Reader(ring_page)
    for tag, name, value in reader.attributes:
        if name in ("src", "href", "action", "data", "srcset", "xlink:href"):
            assert value.startswith(("#", "data:")), (tag, name, value)
    assert "connect-src" not in ring_page
    assert "default-src 'none'" in ring_page
    style = re.search(r"<style>(.*?)</style>", ring_page, re.DOTALL)[1]
    assert "url(" not in style
    assert "@import" not in style


def test_assumed_inputs_are_marked(ring_chapter):
    tables = {t.title: t for t in ring_chapter.inputs}
    gears = tables["Gears"]
    heads = [c.title for c in gears.columns]
    rows = {row[0].text: dict(zip(heads, row, strict=True)) for row in gears.rows}
    assert rows["4"]["base_radius"].text == "45.9 mm"
    assert rows["4"]["base_radius"].assumed
    assert rows["1"]["support"].assumed
    assert not rows["4"]["support"].assumed
    rings = tables["Rings"]
    assert [c.text for c in rings.rows[0]] == ["4", "7, 6", "0 um", "8.24 um"]
    assert not any(cell.assumed for row in rings.rows for cell in row)


@pytest.mark.parametrize("name", ["fgfbstts/all_elements", "branches/split_torque_6"])
def test_every_input_is_shown(name):
    """Each text that a case contains below its sections is in some cell."""
    case = shipped(name)
    cells = "\n".join(c.text for t in input_tables(case) for row in t.rows for c in row)

    def leaves(value):
        if isinstance(value, dict):
            for inner in value.values():
                yield from leaves(inner)
        elif isinstance(value, list):
            for inner in value:
                yield from leaves(inner)
        else:
            yield written(value)

    data = {
        k: v for k, v in case.to_dict().items() if k not in ("title", "source", "notes", "assumed")
    }
    for leaf in leaves(data):
        assert leaf in cells


def test_text_of_a_case_stays_text(evil_page):
    reader = Reader(evil_page)
    # One JSON block for each figure of the two chapters, and two scripts with code.
    figures = len(re.findall(r'class="spec"', evil_page))
    assert figures >= 8
    assert reader.tags["script"] == figures + 2
    assert reader.tags["img"] == 0
    assert reader.tags["b"] == 0
    assert not any(name.startswith("on") for _, name, _ in reader.attributes)
    assert " ".join(EVIL.split()) in reader.text
    assert "<svg onload=alert(1)>" in reader.text


def test_a_bad_case_is_drawn_and_its_problems_reported(tmp_path):
    base = (CASES / "star/floating_sun_3.toml").as_posix()
    bad = tmp_path / "bad.toml"
    text = "[gears.planet1]\ncentre = ['95 mm', '0 mm']\n"
    bad.write_text(f"extends = '{base}'\n{text}", encoding="utf-8")
    missing = tmp_path / "none.toml"
    chapters = [chapter_of_file(f) for f in (bad, missing)]
    assert [c.outcome for c in chapters] == ["cannot be used"] * 2
    assert chapters[0].drawing is not None
    assert chapters[1].drawing is None
    text = Reader(report_page(chapters, made=MADE)).text
    assert "do not fit" in text
    assert "no such file" in text


def test_a_refused_position_is_reported_next_to_those_that_are_certified():
    case = shipped("star/floating_sun_3").replace(
        {
            'meshes."sun-planet3"': None,
            'meshes."planet3-ring"': None,
            "gears.planet3": None,
            "stages": None,
            "operating.torque": ["0 N*m", "1000 N*m"],
            "operating.positions": 2,
        }
    )
    one = chapter(case)
    assert one.outcome == "partly refused"
    assert "1 of 2 positions certified" in one.verdict
    assert any(problem.startswith("position 2: ") for problem in one.problems)
    assert [f.name for f in one.figures] == ["floats", "torque"]
    text = Reader(report_page([one], made=MADE)).text
    assert "partly refused" in text
    assert "loadshare run" not in text


def test_several_cases_have_an_overview(ring_chapter, tmp_path):
    bare = replace(ring_chapter, figures=[], drawing=None)
    page = report_page([bare, bare], made=MADE)
    reader = Reader(page)
    links = [value for tag, name, value in reader.attributes if tag == "a" and name == "href"]
    assert links == ["#case-1", "#case-2"]
    ids = [value for tag, name, value in reader.attributes if name == "id" and tag == "article"]
    assert ids == ["case-1", "case-2"]
    save_report([bare], tmp_path / "new" / "report.html")
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["report.html"]


def test_from_python(tmp_path):
    file = tmp_path / "report.html"
    chapters = write_report([shipped("star/floating_sun_3")], file)
    assert [c.outcome for c in chapters] == ["certified"]
    assert Reader(file.read_text(encoding="utf-8")).tags["article"] == 1


def test_the_page_is_the_same_again(ring_page, ring_chapter):
    assert report_page([ring_chapter], made=MADE) == ring_page


def test_the_scripts_are_kept_and_a_damaged_copy_is_made_anew(tmp_path, monkeypatch):
    monkeypatch.setenv("LOADSHARE_CACHE", str(tmp_path))
    monkeypatch.setattr("vl_convert.javascript_bundle", lambda *_, **__: "made </script>")
    made = offline.scripts.__wrapped__()
    assert made == "made <\\/script>"
    (kept,) = (tmp_path / "scripts").iterdir()
    monkeypatch.setattr("vl_convert.javascript_bundle", lambda *_, **__: "made anew </script>")
    assert offline.scripts.__wrapped__() == made
    kept.write_bytes(kept.read_bytes()[:-1])
    assert offline.scripts.__wrapped__() == "made anew <\\/script>"
