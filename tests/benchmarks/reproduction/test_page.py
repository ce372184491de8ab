"""The committed page agrees with a fresh computation."""

from __future__ import annotations

import re

import pytest
from tests.benchmarks.reproduction.agree import PAGE, disagreement, section
from tests.support import CASES

from benchmarks.reproduction import loads, rings, single_errors, splines, stiffness
from benchmarks.reproduction.entry import Entry, entries_table, point, signed
from benchmarks.reproduction.page import PICTURES, VERSIONS
from benchmarks.reproduction.publish import reproduce
from loadshare.errors import LoadshareError


def test_a_disagreement_is_seen():
    """One unit of the last digit is rounding, two are not; words and whole numbers are exact."""
    assert disagreement("x 1.2345", "x 1.2344") == ""
    assert "1.2346" in disagreement("x 1.2346", "x 1.2344")
    assert disagreement("gear 6", "gear 8")
    assert disagreement("gear 6 first", "gear 6 last")
    assert disagreement("1.0 2.0", "1.0")
    assert disagreement("x 1.234", "x 1.239", least=0.01) == ""


def test_a_committed_chapter_agrees_with_a_fresh_computation(seed, turning):
    assert_fresh(single_errors.eccentricity_chapter(seed, turning))


@pytest.mark.slow
def test_the_committed_chapters_agree_with_a_fresh_computation(
    seed, displaced, full, loosened, limited, loaded
):
    """These are all chapters except Figs. 7, 10 and 11, which need tooth contact analysis."""
    chapters = [
        single_errors.installation_chapter(seed, displaced),
        splines.clearance_chapter(seed, loosened, full),
        rings.ring_chapter(seed, limited),
        rings.point_chapter(seed, limited),
        loads.chapter(loaded),
    ]
    for chapter in chapters:
        assert_fresh(chapter)


def assert_fresh(chapter):
    """Check that a chapter as computed now is the committed one."""
    fresh = "\n\n".join(b for b in chapter.blocks if not b.startswith("{"))
    assert disagreement(fresh, section(chapter.title)) == "", f"{chapter.title}: make reproduce"


@pytest.mark.slow
def test_the_committed_page_and_pictures_agree_with_a_fresh_computation():
    """Coordinates of a picture agree to a tenth of a pixel."""
    found = reproduce(CASES, lambda _: None)
    fresh, kept = found.text, PAGE.read_text(encoding="utf-8")
    assert fresh.splitlines()[-1].startswith(VERSIONS)
    here, there = (text.splitlines()[:-1] for text in (fresh, kept))
    assert disagreement("\n".join(here), "\n".join(there)) == "", "make reproduce"
    for name, svg in found.pictures.items():
        committed = (PAGE.parent / PICTURES / f"{name}.svg").read_text(encoding="utf-8")
        assert disagreement(svg, committed, least=0.1) == "", f"{name}: make reproduce"


def test_the_committed_stiffness_is_within_three_percent():
    """Fig. 7, both ends of three ranges. The slow test checks that the page is current."""
    found = re.findall(
        r"^\| (?:low|high)est K .* ([+−]?[\d.]+) % \|", section(stiffness.TITLE), re.M
    )
    assert len(found) == 6
    assert all(abs(float(text.replace("−", "-"))) <= 3.0 for text in found)


def test_every_committed_picture_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    shown = set(re.findall(rf"\]\({PICTURES}/(\w+)\.svg\)", text))
    assert shown == {p.stem for p in (PAGE.parent / PICTURES).glob("*.svg")}
    assert len(shown) == 9


def test_the_page_tells_versions_and_no_dates():
    text = PAGE.read_text(encoding="utf-8")
    assert "loadshare " in text.splitlines()[-1]
    assert not re.search(r"\b20\d\d-\d\d-\d\d\b|\b\d\d:\d\d\b", text)


def test_without_pair_files_the_page_says_so(seed):
    chapter = stiffness.chapter(seed, None)
    assert "missing" in chapter.verdict
    assert chapter.pictures == {}


def test_a_missing_case_is_named(tmp_path):
    with pytest.raises(LoadshareError, match=r"installation_error.toml: does not exist; --cases"):
        reproduce(tmp_path, lambda _: None)


def test_a_table_of_entries_signs_its_numbers():
    entries = [Entry("y [µm]", -2.37, -2.4, 2), Entry("z", None, 1e-9, 2)]
    first, second = entries_table(entries).splitlines()[2:]
    assert first == "| y [µm] | −2.37 | −2.40 | −0.03 | +1.3 % | predicted |"
    assert second == "| z | – | 0.00 | – | – | predicted |"
    assert signed(-1e-9, 3) == "0.000"
    assert point((-1.0, 2.0), 1) == "(−1.0, 2.0)"
