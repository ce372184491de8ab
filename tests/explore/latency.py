"""Response times of the explorer: `nice -n 5 python -m tests.explore.latency [REPEATS]`.

They run from the change of a slider to the frame that shows its answer, and from opening an address
to a page with its first answer. The load of the computer, on which these times depend, is printed
too.
"""

from __future__ import annotations

import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

from tests.chromium import chromium
from tests.explore.conftest import SEED, serving
from tests.explore.walks import NAMES, opened

from loadshare.case import load_case
from loadshare.cli.console import say

LOADS = 5
SLIDE = """
const [value, done] = arguments;
const slider = document.querySelector("[data-name='rings.5.float'] input[type=range]");
const start = performance.now();
slider.value = value;
slider.dispatchEvent(new Event("input", { bubbles: true }));
const look = () => {
  const { number, state } = document.body.dataset;
  if (state === "present" && document.getElementById("answer").dataset.of === number)
    requestAnimationFrame(() => setTimeout(() => done(performance.now() - start)));
  else setTimeout(look, 1);
};
look();
"""
"""Time until the frame after the answer is on the screen [ms]."""


def main(repeats: int) -> None:
    """Measure and print the times."""
    before = os.getloadavg()
    with (
        tempfile.TemporaryDirectory() as profile,
        chromium(Path(profile), offline=False) as browser,
        serving(load_case(SEED), SEED) as address,
    ):
        loads = []
        for _ in range(LOADS):
            browser.get("about:blank")
            start = time.perf_counter()
            opened(browser, address)
            loads.append(time.perf_counter() - start)
        browser.set_script_timeout(60)
        slides = []
        for k in range(repeats):
            # Around 2 µm, never twice in a row at the same value.
            slides.append(browser.execute_async_script(SLIDE, 1.0 + 0.04 * ((17 * k) % repeats)))
            time.sleep(0.02)
    averages = ", ".join(f"{load:.1f}" for load in (before[0], os.getloadavg()[0]))
    say(f"load of the machine before and after: {averages}; {os.cpu_count()} processors")
    say(f"page with its first answer: {_spread(loads, 's', 2)}, {LOADS} times")
    say(f"slider to screen: {_spread(slides, 'ms', 0)}, {repeats} times, {len(NAMES)} sliders")


def _spread(values: list[float], unit: str, places: int) -> str:
    low, middle, high = min(values), statistics.median(values), max(values)
    return f"median {middle:.{places}f} {unit}, {low:.{places}f} to {high:.{places}f}"


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 50)
