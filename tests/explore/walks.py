"""A simulated user changes the page, and everything that it shows meanwhile is recorded."""

from __future__ import annotations

import json
from urllib.parse import quote

from selenium.webdriver.common.by import By
from tests.chromium import waiting

from loadshare.errors import CaseError, Refused

NAMES = (
    "rings.4.float",
    "rings.5.float",
    "operating.power",
    "errors.6.installation.amount",
    "errors.6.installation.direction",
)
STATE = "return document.body.dataset.state"
SETTLED = ("present", "none")
SAYS = """
const says = () => ({
  number: document.body.dataset.number,
  state: document.body.dataset.state,
  outcome: document.getElementById("state").textContent,
  of: document.getElementById("answer").dataset.of || null,
  fields: Object.fromEntries([...document.querySelectorAll(".control[data-name]")].map((c) =>
    [c.dataset.name, c.querySelector(".value").value])),
  tables: [...document.querySelectorAll("#tables table")].map((t) =>
    [...t.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent))),
  messages: [...document.querySelectorAll("#messages li")].map((li) => li.textContent),
});
"""
WALK = (
    SAYS
    + """
const [steps, seed, done] = arguments;
let state = seed;
const draw = () => {
  // Small enough that every product is exact.
  state = (1664525 * state + 1013904223) % 2147483648;
  return state / 2147483648;
};
const sleep = (ms) => new Promise((then) => setTimeout(then, ms));
const sliders = [...document.querySelectorAll(".control[data-name] input[type=range]")];
const fields = [...document.querySelectorAll(".control[data-name] .value")];
const wrong = ["3", "nan um", "-5 um", "", "1e308 um"];
const seen = new Map();
let playing = true, marked = 0;
const look = () => {
  const now = says();
  if (now.state === "asking") marked += 1;
  else seen.set(`${now.number} ${now.state} ${JSON.stringify(now.tables)}`, now);
  if (playing) requestAnimationFrame(look);
};
look();
(async () => {
  for (let step = 0; step < steps; step += 1) {
    const k = Math.floor(draw() * sliders.length), slider = sliders[k];
    if (draw() < 0.08) {
      fields[k].value = wrong[Math.floor(draw() * wrong.length)];
      fields[k].dispatchEvent(new Event("change", { bubbles: true }));
    } else {
      const [low, high] = [Number(slider.min), Number(slider.max)];
      slider.value = low + draw() * (high - low);
      slider.dispatchEvent(new Event("input", { bubbles: true }));
    }
    await sleep(40 * draw());
    // Every now and then somebody reads what is there.
    if (draw() < 0.3) while (document.body.dataset.state === "asking") await sleep(10);
  }
  while (document.body.dataset.state === "asking") await sleep(10);
  look();
  playing = false;
  done({ seen: [...seen.values()], marked });
})();
"""
)


def opened(browser, address, names=NAMES, changes=None, timeout=60):
    """Open the page with these sliders, and wait for its first answer."""
    view = {"changes": changes or {}, "names": list(names), "position": 1}
    browser.get("about:blank")
    browser.get(f"{address}#{quote(json.dumps(view))}")
    settled(browser, timeout)
    controls = "return document.querySelectorAll('.control[data-name]').length"
    waiting(browser, timeout).until(lambda b: not names or b.execute_script(controls) == len(names))
    return browser


def settled(browser, timeout=60):
    """Return what the page shows when it is done."""
    waiting(browser, timeout).until(lambda b: b.execute_script(STATE) in SETTLED)
    return browser.execute_script(f"{SAYS} return says();")


def whole(browser):
    """Wait until the page is complete: the last parts move those below, where a test clicks."""
    waiting(browser, 120).until(lambda b: b.find_elements(By.CSS_SELECTOR, "#trust dl"))
    return browser


def walked(browser, steps, seed):
    """Return all that a page showed as current in a random walk, and the number of other frames."""
    browser.set_script_timeout(600)
    found = browser.execute_async_script(WALK, steps, seed)
    return found["seen"], found["marked"]


def setting(inputs, fields):
    """Return the changes of a case from the contents of the fields of the page."""
    return inputs.changes(
        {key: text for key, text in fields.items() if text != str(inputs.every[key].text)}
    )


def contradicted(says, inputs, tables_of):
    """Return why the page's figures do not belong to the inputs shown; empty if they do."""
    try:
        wanted = tables_of(inputs.case.replace(setting(inputs, says["fields"])))
    except CaseError:
        return "" if says["outcome"] == "invalid" and not says["tables"] else "invalid, but shown"
    except Refused:
        return "" if says["outcome"] == "refused" and not says["tables"] else "refused, but shown"
    if says["of"] != says["number"] or says["state"] != "present":
        return "is of another setting"
    return "" if says["tables"] == wanted else f"{says['tables']} instead of {wanted}"
