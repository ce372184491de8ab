"""The look of a page and its pictures, as far as it can be judged without an eye."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from selenium.webdriver.common.by import By
from tests.chromium import (
    CONTRAST,
    NAMES,
    badly_set,
    badly_set_file,
    on_screen,
    too_wide,
    visit,
    waiting,
)
from tests.support import CASES, mostly_slow

from loadshare.report.figures.train import train
from loadshare.report.page import chapter_of_file, save_report

DRAWN = """
const places = [...document.querySelectorAll(".figure")];
return places.every((p) => p.dataset.drawn);
"""
CASE_FILES = [p for p in sorted(CASES.rglob("*.toml")) if p.parent.name != "pairs"]


@pytest.fixture(scope="module")
def page(tmp_path_factory, ring_chapter):
    """Write a report of one case, or of two cases, once."""
    folder = tmp_path_factory.mktemp("page")

    @cache
    def made(name: str) -> Path:
        others = [CASES / "star/floating_sun_4.toml"] if name == "two.html" else []
        save_report([ring_chapter, *map(chapter_of_file, others)], folder / name)
        return folder / name

    return made


def opened(browser, file, width, dark=False):
    on_screen(browser, width, dark=dark)
    visit(browser, file)
    waiting(browser, 60).until(lambda b: b.execute_script(DRAWN))


SCREENS = [(name, width) for name in ("one.html", "two.html") for width in (390, 1280, 1920)]


@pytest.mark.parametrize(("name", "width"), mostly_slow(SCREENS, [SCREENS[1]]))
def test_a_report_fits_every_screen(browser, page, name, width):
    """Nothing needs horizontal scrolling outside its own box; no words overlap or are cut off."""
    opened(browser, page(name), width, dark=width == 1280)
    assert too_wide(browser, width) <= 0
    pictures = browser.find_elements(By.CSS_SELECTOR, ".figure svg.marks")
    assert len(pictures) >= 5
    assert [bad for one in pictures for bad in badly_set(browser, one)] == []
    assert browser.execute_script(CONTRAST) == []
    assert browser.execute_script(NAMES) == []


def test_the_verdict_is_on_the_first_screen(browser, page):
    on_screen(browser, 1280, 800)
    visit(browser, page("one.html"))
    cards = browser.find_elements(By.CSS_SELECTOR, ".cards")
    assert all(c.rect["y"] + c.rect["height"] <= 800 for c in cards)
    verdict = cards[0].text
    for words in ("Load sharing by stage", "1.0013", "upper stop + arc 6", "flank", "Assumed"):
        assert words in verdict


def test_letters_on_a_phone_are_large_enough(browser, page):
    """Letters in pictures have at least 8 pixels."""
    opened(browser, page("one.html"), 390)
    sizes = browser.execute_script(
        """return [...document.querySelectorAll(".figure svg text")].map((text) => {
          const m = text.getScreenCTM();
          return parseFloat(getComputedStyle(text).fontSize) * Math.hypot(m.a, m.b);
        });"""
    )
    assert min(sizes) >= 8


@pytest.mark.slow
def test_every_control_is_reached_by_the_keyboard(browser, page):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    opened(browser, page("two.html"), 1280)
    wanted = browser.execute_script(
        """return [...document.querySelectorAll("a[href], button, summary")]
        .filter((c) => c.checkVisibility()).length;"""
    )
    seen = set()
    for _ in range(wanted):
        ActionChains(browser).send_keys(Keys.TAB).perform()
        seen.add(browser.switch_to.active_element.id)
    assert len(seen) >= wanted


def test_a_bad_picture_is_seen(browser, tmp_path):
    """The check itself can fail."""
    words = [("10", "20", "one"), ("14", "22", "two"), ("90", "40", "beyond the rim")]
    texts = "".join(f'<text x="{x}" y="{y}">{t}</text>' for x, y, t in words)
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" width="120" height="60">{texts}</svg>'
    assert badly_set_file(browser, svg, tmp_path) == ["one | two", "cut: beyond the rim"]


@pytest.mark.parametrize(
    "file",
    sorted((CASES.parent / "docs").rglob("*.svg")),
    ids=lambda p: f"{p.parent.name}/{p.name}",
)
def test_no_words_overlap_in_a_picture_of_the_docs(browser, tmp_path, file):
    assert badly_set_file(browser, file.read_text(encoding="utf-8"), tmp_path) == []


def test_every_committed_picture_is_judged():
    """A bitmap is the counterpart of a drawing that is judged, or a screenshot of such a page."""
    bitmaps = [f for f in (CASES.parent / "docs").rglob("*.png") if f.parent.name != "screens"]
    assert bitmaps
    assert [f.name for f in bitmaps if not f.with_suffix(".svg").exists()] == []


@pytest.mark.slow
@pytest.mark.parametrize("file", CASE_FILES, ids=lambda p: p.stem)
def test_no_words_overlap_in_a_picture_of_a_case(browser, tmp_path, file):
    one = chapter_of_file(file)
    for figure in (*one.figures, train(one.case)):
        assert badly_set_file(browser, figure.to_svg(), tmp_path) == [], figure.name
