"""The page in a browser: it opens offline without errors, shows figures and sorts tables."""

from __future__ import annotations

import pytest
from tests.chromium import visit, waiting
from tests.report.pages import EVIL_CASE

from loadshare.report.page import chapter_of_file, save_report

DRAWN = "return document.querySelectorAll('.figure svg.marks').length"
PLACES = "return document.querySelectorAll('.figure').length"
COLUMN = """
const all = [...document.querySelectorAll("table")];
const table = all.find((t) => t.textContent.includes(arguments[0]));
return [...table.tBodies[0].rows].map((row) => row.cells[arguments[1]].textContent.trim());
"""
CLICK = """
const all = [...document.querySelectorAll("table")];
const table = all.find((t) => t.textContent.includes(arguments[0]));
table.tHead.rows[0].cells[arguments[1]].querySelector("button").click();
return table.tHead.rows[0].cells[arguments[1]].getAttribute("aria-sort");
"""


@pytest.fixture(scope="module")
def page(tmp_path_factory, ring_chapter):
    """Write a report of a good case, a bad one, and one with hostile texts."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "evil.toml").write_text(EVIL_CASE, encoding="utf-8")
    (folder / "bad.toml").write_text("title = 'bad'\n", encoding="utf-8")
    others = [chapter_of_file(folder / name) for name in ("evil.toml", "bad.toml")]
    save_report([ring_chapter, *others], folder / "report.html")
    return folder / "report.html"


@pytest.fixture
def opened(browser, page):
    """Open the page, and wait until all figures are drawn."""
    visit(browser, page)
    figures = browser.execute_script(PLACES)
    assert figures >= 8
    waiting(browser, 60).until(lambda b: b.execute_script(DRAWN) == figures)
    return browser


def test_the_page_opens_without_a_complaint(opened):
    assert opened.get_log("browser") == []
    assert "load sharing" in opened.title
    assert opened.execute_script("return performance.getEntriesByType('resource').length") == 0


def test_hostile_texts_do_nothing(opened):
    assert opened.execute_script("return window.pwned") is None
    assert opened.execute_script("return document.querySelectorAll('article img').length") == 0


def test_hovering_over_a_float_tells_its_figures(opened):
    from selenium.webdriver.common.action_chains import ActionChains

    point = opened.execute_script(
        """const figure = document.querySelector('[data-name="floats"]');
        const marks = [...figure.querySelectorAll('path[aria-roledescription="point"]')];
        marks[7].scrollIntoView({block: "center"});
        return marks[7];"""
    )
    ActionChains(opened).move_to_element(point).perform()
    tip = waiting(opened, 10).until(
        lambda b: b.execute_script(
            "const t = document.querySelector('#vg-tooltip-element.visible');"
            "return t && t.innerText;"
        )
    )
    lines = [line.strip() for line in tip.splitlines() if line.strip()]
    tooltip = dict(zip(lines[::2], lines[1::2], strict=True))
    assert tooltip["position"] == "1–5"
    assert tooltip["rests"] == "upper stop + arc 6"
    assert tooltip["x [µm]"].startswith("4.12")
    assert tooltip["y [µm]"].startswith("7.13")
    assert float(tooltip["reaction of the ring [N]"]) > 50.0


def test_tables_sort_by_figures_and_by_words(opened):
    heading = "torque [N·m]"
    torques = [float(v) for v in opened.execute_script(COLUMN, heading, 2)]
    assert torques != sorted(torques)
    assert opened.execute_script(CLICK, heading, 2) == "ascending"
    assert [float(v) for v in opened.execute_script(COLUMN, heading, 2)] == sorted(torques)
    assert opened.execute_script(CLICK, heading, 2) == "descending"
    assert [float(v) for v in opened.execute_script(COLUMN, heading, 2)] == sorted(torques)[::-1]
    assert opened.execute_script(CLICK, heading, 0) == "ascending"
    meshes = opened.execute_script(COLUMN, heading, 0)
    # Numbers within names are sorted as numbers: 10 after 9.
    assert meshes == sorted(meshes, key=lambda m: [int(n) for n in m.split("-")])
    assert opened.get_log("browser") == []


def test_sorting_works_from_the_keyboard(opened):
    button = opened.find_element("css selector", "article table.sortable th button")
    opened.execute_script("arguments[0].focus()", button)
    from selenium.webdriver.common.keys import Keys

    button.send_keys(Keys.ENTER)
    header = opened.find_element("css selector", "article table.sortable th")
    assert header.get_attribute("aria-sort") == "ascending"


def test_the_page_prints(opened):
    """Folded tables are unfolded on paper; nothing is wider than the page."""
    import base64

    printed = base64.b64decode(opened.execute_cdp_cmd("Page.printToPDF", {})["data"])
    assert printed.startswith(b"%PDF-")
    closed = "article details:not(.vega-embed details):not([open])"
    assert opened.find_elements("css selector", closed) == []


def test_a_single_figure_opens_as_well(browser, picture, tmp_path):
    file = picture("all_elements", "share").save(tmp_path / "share.html")
    visit(browser, file)
    waiting(browser, 60).until(lambda b: b.execute_script(DRAWN) == 1)
    assert browser.get_log("browser") == []


INTRUDER = """
const script = document.createElement("script");
script.textContent = "window.pwned = true";
document.body.append(script);
// Later, because what a test itself runs may compile.
setTimeout(() => {
  try { new Function("return true")(); window.compiling = "works"; }
  catch (error) { window.compiling = "refused"; }
}, 0);
"""


def test_no_script_runs_but_those_of_the_page(browser, page):
    """Its policy lists them by hash, and forbids compilation. The test leaves errors in the log."""
    visit(browser, page)
    browser.execute_script(INTRUDER)
    compiling = waiting(browser, 60).until(lambda b: b.execute_script("return window.compiling"))
    assert compiling == "refused"
    assert browser.execute_script("return window.pwned") is None
    complaints = [entry["message"] for entry in browser.get_log("browser")]
    assert any("Executing inline script violates" in message for message in complaints)
