"""Screenshots of the explorer for the documentation: `python -m tests.explore.screens [FOLDER]`.

Screens of a phone, a laptop and a desktop, light and dark, from a browser; look at each of them.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from selenium.webdriver.common.by import By
from tests.chromium import chromium, on_screen, waiting
from tests.explore.conftest import SEED, serving
from tests.explore.walks import opened, settled
from tests.support import CASES

from loadshare.case import load_case

FOLDER = CASES.parent / "docs" / "pictures" / "screens"
SCREENS = ((390, 844), (1280, 900), (1920, 1080))
PLACE = ("errors.6.installation.amount", "errors.6.installation.direction")
NAMES = ("rings.5.float", "rings.4.float", *PLACE, "operating.power")
SETTING = {"rings.5.float": "2.2 um"}
SCATTER = ("rings.*.float", *PLACE, "operating.power")
SAMPLES = 1000


def main(folder: Path) -> None:
    """Write the screenshots into a folder."""
    with (
        tempfile.TemporaryDirectory() as profile,
        chromium(Path(profile), offline=False) as browser,
        serving(load_case(SEED), SEED) as address,
    ):
        for width, height in SCREENS:
            for dark in (False, True):
                on_screen(browser, width, height, dark)
                opened(browser, address, names=NAMES, changes=SETTING)
                if width > 900:
                    _along(browser)
                _rested(browser)
                name = f"explorer_{width}{'_dark' if dark else ''}.png"
                (folder / name).write_bytes(browser.get_screenshot_as_png())
        on_screen(browser, 1280, 3500)
        opened(browser, address, names=SCATTER)
        _studied(browser)
        part = browser.find_element(By.ID, "studies")
        (folder / "explorer_studies.png").write_bytes(part.screenshot_as_png)


def _along(browser) -> None:
    """Show critical values and the trace of the first input."""
    for button in browser.find_elements(By.CSS_SELECTOR, ".control[data-name] .row button")[:2]:
        button.click()
    _waits(browser, "#trace svg")
    status = "return document.querySelector('.control[data-name] [role=status]').textContent"
    waiting(browser, 300).until(lambda b: "on the slider" in b.execute_script(status))


def _studied(browser) -> None:
    """Run sensitivities and a tolerance study."""
    browser.find_element(By.ID, "slopes").click()
    for field, text in (("samples", SAMPLES), ("limit", 1.05)):
        browser.find_element(By.ID, field).clear()
        browser.find_element(By.ID, field).send_keys(str(text))
    browser.find_element(By.ID, "tolerance").click()
    _waits(browser, "#mattering table")
    waiting(browser, 900).until(lambda b: not b.find_element(By.ID, "stop").is_enabled())


def _rested(browser) -> None:
    settled(browser)
    _waits(browser, "#trust dl")


def _waits(browser, selector) -> None:
    waiting(browser, 300).until(lambda b: b.find_elements(By.CSS_SELECTOR, selector))


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
