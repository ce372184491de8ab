"""The explorer as it looks, for the documentation: `python -m tests.explore.screens [FOLDER]`.

Screens of a phone, a laptop and a desktop, light and dark, from a browser; each is to be looked at.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait
from tests.chromium import chromium, on_screen
from tests.explore.conftest import SEED, serving
from tests.explore.walks import opened, settled
from tests.support import CASES

from loadshare.case import load_case

FOLDER = CASES.parent / "docs" / "pictures" / "screens"
SCREENS = ((390, 844), (1280, 900), (1920, 1080))
NAMES = (
    "rings.5.float",
    "rings.4.float",
    "errors.6.installation.amount",
    "errors.6.installation.direction",
    "operating.power",
)


def taken(folder: Path, full: bool = False) -> None:
    """Write the screens into a folder."""
    with (
        tempfile.TemporaryDirectory() as profile,
        chromium(Path(profile), offline=False) as browser,
        serving(load_case(SEED), SEED) as address,
    ):
        for width, height in SCREENS:
            for dark in (False, True):
                on_screen(browser, width, height, dark)
                opened(browser, address, names=NAMES)
                _rested(browser)
                name = f"explorer_{width}{'_dark' if dark else ''}.png"
                if full:
                    high = browser.execute_script("return document.documentElement.scrollHeight")
                    on_screen(browser, width, high, dark)
                (folder / name).write_bytes(browser.get_screenshot_as_png())


def _rested(browser) -> None:
    settled(browser)
    WebDriverWait(browser, 60).until(lambda b: b.find_elements(By.CSS_SELECTOR, "#trust dl"))


if __name__ == "__main__":
    taken(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER, full="--full" in sys.argv)
