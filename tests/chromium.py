"""A headless Chromium, and checks of a page that need no eye."""

from __future__ import annotations

import os
import shutil
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1280,1000",
)
LONGEST = 120.0
"""Time [s] after which a browser that does not answer fails the test."""
FRACTION = 0.25
"""Fraction of the letter height by which the boxes of two lines may overlap: a box includes the
space above and below the letters."""

TEXTS = """
const [picture, fraction] = arguments;
const root = typeof picture === "string" ? document.querySelector(picture) : picture;
function light(colour) {
  const [r, g, b] = colour.match(/[\\d.]+/g).map((v) => {
    const part = v / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}
const frame = root.getBoundingClientRect(), found = [], bad = [];
for (const text of root.querySelectorAll("text")) {
  const box = text.getBoundingClientRect(), style = getComputedStyle(text);
  if (!text.textContent.trim() || !box.width || style.opacity === "0") continue;
  const m = text.getScreenCTM();
  const size = parseFloat(style.fontSize) * Math.hypot(m.a, m.b);
  // On white; white itself is the rim of a word, or stands on a colour.
  const ratio = 1.05 / (light(style.fill) + 0.05);
  if (ratio > 1.01 && ratio < 4.5) bad.push(`pale, ${ratio.toFixed(2)}: ${text.textContent}`);
  if (box.left < frame.left - 0.5 || box.top < frame.top - 0.5
      || box.right > frame.right + 0.5 || box.bottom > frame.bottom + 0.5)
    bad.push(`cut: ${text.textContent}`);
  for (const other of found) {
    const wide = Math.min(box.right, other.box.right) - Math.max(box.left, other.box.left);
    const tall = Math.min(box.bottom, other.box.bottom) - Math.max(box.top, other.box.top);
    // The rim of a label is the same text once more, in white.
    const rim = other.text === text.textContent && Math.abs(box.left - other.box.left) < 2
      && Math.abs(box.top - other.box.top) < 2;
    const allowed = Math.min(size, other.size);
    const across = box.height > 1.5 * size;
    const over = across ? wide > fraction * allowed && tall > 1
      : wide > 1 && tall > fraction * allowed;
    if (!rim && over) bad.push(`${other.text} | ${text.textContent}`);
  }
  found.push({ text: text.textContent, box, size });
}
return bad;
"""
"""Words in a picture that overlap, are cut off or are too pale."""

CONTRAST = """
function parts(colour) { return colour.match(/[\\d.]+/g).map(Number); }
function light([r, g, b]) {
  const [x, y, z] = [r, g, b].map((v) => {
    const part = v / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * x + 0.7152 * y + 0.0722 * z;
}
function behind(element) {
  const layers = [];
  for (let at = element; at; at = at.parentElement) {
    const [r, g, b, a = 1] = parts(getComputedStyle(at).backgroundColor);
    if (a > 0) layers.push([r, g, b, a]);
    if (a === 1) break;
  }
  return layers.reverse().reduce(
    (under, [r, g, b, a]) => [r, g, b].map((v, k) => a * v + (1 - a) * under[k]), [255, 255, 255]);
}
const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), bad = new Map();
while (walk.nextNode()) {
  const element = walk.currentNode.parentElement, text = walk.currentNode.textContent.trim();
  if (!text || element.closest("script, style, noscript, svg, [hidden]")) continue;
  if (!element.checkVisibility({ checkOpacity: true, checkVisibilityCSS: true })) continue;
  const style = getComputedStyle(element);
  const [r, g, b, a = 1] = parts(style.color), ground = behind(element);
  const ink = [r, g, b].map((v, k) => a * v + (1 - a) * ground[k]);
  const [low, high] = [light(ink), light(ground)].sort((x, y) => x - y);
  const ratio = (high + 0.05) / (low + 0.05), size = parseFloat(style.fontSize);
  const large = size >= 24 || (size >= 18.66 && style.fontWeight >= 700);
  if (ratio < (large ? 3 : 4.5))
    bad.set(`${style.color} on rgb(${ground.map(Math.round)}): ${ratio.toFixed(2)}`,
      `${element.tagName}.${element.className}: ${text.slice(0, 40)}`);
}
return [...bad].map(([what, where]) => `${what} in ${where}`);
"""
"""Texts whose contrast is below that of WCAG 2.2 AA."""

NAMES = """
const bad = [];
if (!document.documentElement.lang) bad.push("no lang");
if (!document.title) bad.push("no title");
for (const image of document.querySelectorAll("img"))
  if (!image.hasAttribute("alt")) bad.push(`no alt: ${image.src}`);
for (const frame of document.querySelectorAll("iframe:not([hidden])"))
  if (!frame.title) bad.push("frame without a title");
const controls = "a[href], button, input, select, textarea, summary";
for (const control of document.querySelectorAll(controls)) {
  if (control.type === "hidden" || !control.checkVisibility({ checkVisibilityCSS: true })) continue;
  const inside = control.querySelector("img[alt], svg title");
  const named = control.textContent.trim() || control.getAttribute("aria-label") || control.title
    || control.placeholder || (control.labels && control.labels.length)
    || control.getAttribute("aria-labelledby") || (inside && (inside.alt || inside.textContent));
  if (!named) bad.push(`no name: ${control.outerHTML.slice(0, 120)}`);
}
let last = 0;
for (const heading of document.querySelectorAll("h1, h2, h3, h4, h5, h6")) {
  if (!heading.checkVisibility()) continue;
  const level = Number(heading.tagName[1]);
  if (level > last + 1) bad.push(`h${last} then h${level}: ${heading.textContent.trim()}`);
  last = level;
}
const ids = [...document.querySelectorAll("main [id], article [id]")].map((e) => e.id);
const twice = ids.filter((id, at) => ids.indexOf(id) !== at);
for (const id of new Set(twice)) bad.push(`id twice: ${id}`);
return bad;
"""
"""Controls, pictures and frames without a name; headings out of order; duplicate names."""

OVER = """
const [width, done] = arguments, start = performance.now();
// A page follows its screen some frames later.
(function look() {
  const over = document.documentElement.scrollWidth - width;
  if (over <= 0 || performance.now() - start > 2000) done(over); else requestAnimationFrame(look);
})();
"""
"""Number of pixels by which a page is too wide, once it has adapted to its screen."""


@contextmanager
def chromium(profile: Path, offline: bool = True) -> Iterator[Any]:
    """Yield a browser without a network, or one that reaches a server of the test.

    Without a browser the test is skipped; if CI is set, it fails.
    """
    named = (shutil.which(n) for n in ("chromium", "chromium-browser", "google-chrome"))
    program, driver = next(filter(None, named), None), shutil.which("chromedriver")
    if program is None or driver is None:
        reason = "no chromium and chromedriver (apt-get install chromium chromium-driver)"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options = Options()
    options.binary_location = program
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    # The driver waits for a browser without end, unless sockets have a limit when it is made.
    socket.setdefaulttimeout(LONGEST)
    try:
        found = webdriver.Chrome(options=options, service=Service(driver))
    finally:
        socket.setdefaulttimeout(None)
    yield as_new(found, offline)
    found.quit()


def as_new(browser: Any, offline: bool = True) -> Any:
    """Return the browser without the screens, downloads and log entries of earlier tests."""
    browser.get("about:blank")
    browser.get_log("browser")
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    browser.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "default"})
    if offline:
        # Pages must work without a network, so the browser has none either.
        browser.set_network_conditions(offline=True, latency=0, throughput=0)
    else:
        browser.delete_network_conditions()
    return browser


def visit(browser: Any, page: Path) -> None:
    """Open a file completely: the driver may return from a large one while it is still loading."""
    browser.get(page.as_uri())
    complete = "return document.readyState === 'complete'"
    waiting(browser, 60).until(lambda b: b.execute_script(complete))


def waiting(browser: Any, seconds: float) -> Any:
    """Return a wait of at most `seconds` that polls a page often enough to lose no time itself."""
    from selenium.webdriver.support.ui import WebDriverWait

    return WebDriverWait(browser, seconds, 0.02)


def steady(browser: Any, look: Callable[[Any], Any]) -> Any:
    """Return what a look at the page finds; look again if anything is redrawn meanwhile."""
    from selenium.common.exceptions import StaleElementReferenceException

    for _ in range(20):
        with suppress(StaleElementReferenceException):
            return look(browser)
    return look(browser)


def on_screen(browser: Any, width: int, height: int = 900, dark: bool = False) -> None:
    """Give the browser a screen of `width` by `height` pixels, light or dark."""
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})


def too_wide(browser: Any, width: int) -> int:
    """Return the pixels by which a page is wider than its screen; a phone would zoom out."""
    return int(browser.execute_async_script(OVER, width))


def badly_set(browser: Any, picture: Any) -> list[str]:
    """Return the words in an SVG element that overlap, are cut off or are too pale.

    ``picture`` is the element, or its selector if the page may redraw it meanwhile.
    """
    return list(browser.execute_script(TEXTS, picture, FRACTION))


def badly_set_file(browser: Any, svg: str, folder: Path) -> list[str]:
    """Return the same for the text of an SVG file."""
    page = folder / "picture.html"
    page.write_text(f'<!doctype html><meta charset="utf-8"><body>{svg}', encoding="utf-8")
    visit(browser, page)
    return badly_set(browser, browser.find_element("css selector", "svg"))
