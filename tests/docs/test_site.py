"""The documentation as it is read: from a folder on disk, without a network, on any screen."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from selenium.webdriver.common.by import By
from tests.chromium import CONTRAST, NAMES, as_new, on_screen, too_wide, visit, waiting
from tests.support import mostly_slow

ROOT = Path(__file__).parents[2]
BARE = "evidence/branches.html"
"""A single picture, as the benchmarks write it."""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Return all pages, built strictly: by `make docs` if it gives their folder, else now."""
    if built := os.environ.get("LOADSHARE_SITE"):
        return ROOT / built
    folder = tmp_path_factory.mktemp("site")
    mkdocs = Path(sys.executable).with_name("mkdocs")
    found = mkdocs if mkdocs.exists() else shutil.which("mkdocs")
    if found is None:
        pytest.skip("no mkdocs")
    subprocess.run(
        [found, "build", "--strict", "--quiet", "-d", folder],
        cwd=ROOT,
        check=True,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
    )
    return folder


@pytest.fixture(scope="module")
def browser(chrome):
    return as_new(chrome, offline=True)


@pytest.mark.parametrize(
    "page", mostly_slow(("index.html", "evidence/speed.html"), ("index.html",))
)
def test_the_search_works_from_a_folder(browser, site, page):
    on_screen(browser, 1280)
    browser.get("about:blank")
    browser.get_log("browser")  # entries that earlier pages left
    visit(browser, site / page)
    field = browser.find_element(By.CSS_SELECTOR, "input.md-search__input")
    field.click()
    field.send_keys("backlash")
    found = waiting(browser, 30).until(
        lambda b: b.find_elements(By.CSS_SELECTOR, ".md-search-result__link")
    )
    browser.get(found[0].get_attribute("href"))
    assert "backlash" in browser.find_element(By.TAG_NAME, "article").text.lower()
    assert not [e for e in browser.get_log("browser") if e["level"] == "SEVERE"]


FEW = ("index.html", "case-reference.html", "evidence/speed.html", "gallery/float.html")
"""Pages of different kinds: words, wide tables, figures, code."""


@pytest.mark.parametrize("every", mostly_slow((False, True), (False,)), ids=["few", "every"])
def test_pages_can_be_read(browser, site, every):
    """Nothing is wider than the screen, text has contrast, controls and pictures have names."""
    # An earlier choice of the reader takes precedence over the system's setting.
    visit(browser, site / "index.html")
    browser.execute_script("localStorage.clear()")
    bad = []
    for page in sorted(site.rglob("*.html")):
        name = page.relative_to(site).as_posix()
        if name == BARE or not (every or name in FEW):
            continue
        for number, (width, dark) in enumerate(((390, False), (1280, True), (1920, False))):
            on_screen(browser, width, dark=dark)
            if number == 0:
                # The page follows the screen from then on.
                visit(browser, page)
            found = [*browser.execute_script(CONTRAST), *browser.execute_script(NAMES)]
            over = too_wide(browser, width)
            if over > 0:
                found.append(f"{over} px too wide")
            bad += [f"{name} at {width} px: {one}" for one in found]
    assert bad == []


MISSED = """
const controls = "a[href], button, input:not([type=radio]):not([type=checkbox]), summary";
return [...document.querySelectorAll(controls)]
  .filter((c) => c.checkVisibility({ checkVisibilityCSS: true, checkOpacity: true }))
  .filter((c) => c.getClientRects().length && !c.dataset.reached)
  .map((c) => c.outerHTML.slice(0, 100));
"""
"""Controls on the screen that were not reached."""


@pytest.mark.parametrize("page", mostly_slow(("index.html", "gallery/float.html"), ("index.html",)))
def test_the_keyboard_reaches_every_control(browser, site, page):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    on_screen(browser, 1280)
    visit(browser, site / page)
    shown = len(browser.execute_script(MISSED))
    assert shown > 20
    for _ in range(shown + 10):
        ActionChains(browser).send_keys(Keys.TAB).perform()
        browser.execute_script("document.activeElement.dataset.reached = 'yes'")
    assert browser.execute_script(MISSED) == []
