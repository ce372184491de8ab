"""The page in a browser: it always shows the answer to its present inputs, on every screen."""

from __future__ import annotations

import json
import tomllib
from urllib.parse import quote

import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from tests.chromium import CONTRAST, NAMES, badly_set, on_screen, too_wide, waiting
from tests.explore.conftest import SEED
from tests.explore.test_server import partly_refused, tables_of
from tests.explore.walks import contradicted, opened, settled, walked, whole
from tests.report.pages import EVIL_CASE
from tests.support import mostly_slow, shipped

from loadshare.case import Case, load_case
from loadshare.explore.inputs import PageInputs

PICTURES = "figure:not([hidden]) > svg"


@pytest.fixture(scope="module")
def inputs():
    return PageInputs(load_case(SEED))


def types(browser, name, text):
    """Write into the field of an input, as with a keyboard."""
    field = browser.find_element(By.CSS_SELECTOR, f".control[data-name='{name}'] .value")
    field.click()
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys(text, Keys.ENTER)
    return settled(browser)


def test_the_page_opens_without_a_complaint(browser, seed, inputs):
    opened(browser, seed)
    assert browser.get_log("browser") == []
    assert "Limit rings on the floating pinions" in browser.title
    says = settled(browser)
    assert says["outcome"] == "certified"
    assert says["tables"] == tables_of(inputs.case)
    loaded = browser.execute_script(
        "return performance.getEntriesByType('resource').map((entry) => entry.name)"
    )
    assert loaded
    assert all(name.startswith(seed) for name in loaded)


def test_a_planetary_set_opens_with_what_may_vary(browser, served):
    """It opens with the error of a pin, but not with numbers of teeth."""
    with served(shipped("planetary/four_planets")) as address:
        opened(browser, address, names=[])
        waiting(browser, 10).until(lambda b: len(settled(b)["fields"]) == 6)
        names = set(settled(browser)["fields"])
        browser.get("about:blank")
    supports = {f"gears.planet{k}.support" for k in (1, 2, 3, 4)}
    assert names == supports | {"operating.torque", "errors.planet2.pin.tangential"}


def test_a_slider_moves_the_answer(browser, seed, inputs):
    opened(browser, seed)
    slider = browser.find_element(By.CSS_SELECTOR, "[data-name='rings.5.float'] [type=range]")
    for key in (Keys.ARROW_RIGHT, Keys.PAGE_DOWN, Keys.HOME, Keys.END):
        slider.send_keys(key)
        says = settled(browser)
        assert contradicted(says, inputs, tables_of) == ""
    assert says["fields"]["rings.5.float"] == "5.5 um"
    text = browser.execute_async_script(
        """const [done] = arguments;
        import("/page/controls.js").then(({ written }) =>
          done(["um", ""].map((unit) => written({ unit, step: 1e-15 }, 1.6e-12))));"""
    )
    assert text == ["1.6e-12 um", 1.6e-12]


@pytest.mark.parametrize("seed_number", mostly_slow((1, 2), (1,)))
def test_a_walk_never_shows_what_is_not_of_the_present_inputs(browser, seed, inputs, seed_number):
    _walk(browser, seed, inputs, steps=25, number=seed_number)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(100))
def test_a_hundred_walks_of_fifty_steps(browser, seed, inputs, number):
    _walk(browser, seed, inputs, steps=50, number=1000 + 7919 * number)


def _walk(browser, seed, inputs, steps, number):
    opened(browser, seed)
    seen, marked = walked(browser, steps, number)
    assert marked > 0
    # The first and the last; how many come between depends on the load of the computer.
    assert len({one["number"] for one in seen}) >= 2
    assert [bad for one in seen if (bad := contradicted(one, inputs, tables_of))] == []


def test_an_old_answer_that_comes_late_is_marked(browser, seed):
    """From the first change on, the figures shown are marked as those of the previous setting."""
    opened(browser, seed)
    says = browser.execute_script(
        """const slider = document.querySelector("[data-name='rings.5.float'] [type=range]");
        slider.value = 1.23;
        slider.dispatchEvent(new Event("input", { bubbles: true }));
        return [document.body.dataset.state, document.getElementById("verdict").textContent];"""
    )
    assert says[0] == "asking"
    assert "setting before" in says[1]
    assert settled(browser)["fields"]["rings.5.float"] == "1.23 um"


def test_a_lost_server_leaves_no_answer(browser, served):
    with served(shipped("star/floating_sun_4")) as address:
        opened(browser, address, names=["operating.torque"])
    slider = browser.find_element(By.CSS_SELECTOR, "[data-name='operating.torque'] [type=range]")
    slider.send_keys(Keys.ARROW_RIGHT)
    says = settled(browser)
    assert says["outcome"] == "failed"
    assert says["tables"] == []
    assert "server" in says["messages"][0]
    browser.get_log("browser")


@pytest.mark.parametrize(
    ("text", "outcome", "why"),
    mostly_slow(
        [
            ("3", "invalid", "has no unit"),
            ("nan um", "invalid", "is not finite"),
            ("1e308 um", "invalid", "outside the range of any machine"),
            ("3 kg", "invalid", "a length is needed"),
            ("0.004 mm", "certified", ""),
        ],
        ("3", "0.004 mm"),
    ),
)
def test_what_is_typed(browser, seed, inputs, text, outcome, why):
    opened(browser, seed, names=["rings.5.float"])
    says = types(browser, "rings.5.float", text)
    assert says["outcome"] == outcome
    assert why in " ".join(says["messages"])
    assert contradicted(says, inputs, tables_of) == ""
    slider = browser.find_element(By.CSS_SELECTOR, "[data-name='rings.5.float'] [type=range]")
    assert slider.is_enabled()
    if outcome == "certified":
        assert slider.get_attribute("value") == "4"
        slider.send_keys(Keys.ARROW_RIGHT)
        assert 4.0 < float(settled(browser)["fields"]["rings.5.float"].split()[0]) < 4.1
    if outcome == "invalid":
        assert browser.find_elements(By.CSS_SELECTOR, "#floats svg, #bars svg, #tables table") == []


def test_inputs_are_found_by_search(browser, seed):
    opened(browser, seed, names=["rings.5.float"])
    field = browser.find_element(By.ID, "search")
    field.send_keys("shaft 2-4 stiff")
    (found,) = browser.find_elements(By.CSS_SELECTOR, "#found button")
    assert found.text.startswith('shafts."2-4".stiffness')
    field.send_keys(Keys.ENTER)
    name = "return document.activeElement.closest('.control').dataset.name"
    assert browser.execute_script(name) == 'shafts."2-4".stiffness'
    field.send_keys("rings.4.float=rings.5.clearance", Keys.ENTER)
    waiting(browser, 10).until(
        lambda b: len(b.find_elements(By.CSS_SELECTOR, ".control[data-name]")) == 3
    )
    field.send_keys("rings.*.flaot*", Keys.ENTER)
    note = waiting(browser, 10).until(lambda b: b.find_element(By.ID, "done").text)
    assert "matches no key" in note


def test_tied_inputs_move_together(browser, seed, inputs):
    opened(browser, seed, names=["rings.*.float", "rings.4.float", "rings.5.float"])
    differ = "return document.querySelector(\"[data-name='rings.*.float'] .apart\").textContent"
    assert "rings.4.float = 8.24 um, rings.5.float = 2.74 um" in browser.execute_script(differ)
    says = types(browser, "rings.*.float", "2.5 um")
    assert browser.execute_script(differ) == ""
    assert set(says["fields"].values()) == {"2.5 um"}
    del says["fields"]["rings.*.float"]
    assert contradicted(says, inputs, tables_of) == ""


def test_a_dial_turns_an_error(browser, seed, inputs):
    opened(browser, seed, names=["errors.6.installation.direction"])
    dial = browser.find_element(By.CSS_SELECTOR, "svg.dial")
    ActionChains(browser).move_to_element_with_offset(dial, -20, 0).click().perform()
    says = settled(browser)
    assert abs(abs(float(says["fields"].popitem()[1].split()[0])) - 180.0) < 3.0
    dial = browser.find_element(By.CSS_SELECTOR, "svg.dial")
    ActionChains(browser).move_to_element_with_offset(dial, 0, -20).click().perform()
    says = settled(browser)
    assert abs(float(says["fields"]["errors.6.installation.direction"].split()[0]) - 90.0) < 3.0
    assert contradicted(says, inputs, tables_of) == ""


@pytest.mark.slow
def test_pinned_settings_are_compared(browser, seed):
    opened(browser, seed, names=["rings.5.float"])
    browser.find_element(By.ID, "pin").click()
    types(browser, "rings.5.float", "1 um")
    browser.find_element(By.ID, "pin").click()
    types(browser, "rings.5.float", "4 um")
    rows = {
        row.find_elements(By.TAG_NAME, "td")[0].text: [
            cell.text for cell in row.find_elements(By.TAG_NAME, "td")[1:]
        ]
        for row in browser.find_elements(By.CSS_SELECTOR, "#compared tbody tr")
    }
    case = load_case(SEED)
    wanted = [
        tables_of(case.replace({"rings.5.float": text}))[0][1][-1]
        for text in ("2.74 um", "1 um", "4 um")
    ]
    assert rows["stage II: Ω = Kγ"][:3] == wanted
    assert len(browser.find_elements(By.CSS_SELECTOR, "#floats [stroke-dasharray='2 2']")) >= 4
    browser.find_element(By.CSS_SELECTOR, "[aria-label='unpin A']").click()
    heads = browser.find_elements(By.CSS_SELECTOR, "#compared th")
    assert [head.text for head in heads] == ["figure", "B", "now", "change, B to now"]
    # A pinned value that is cut off by the edge of a picture is reported below it.
    types(browser, "rings.5.float", "90 um")
    browser.find_element(By.ID, "pin").click()
    types(browser, "rings.5.float", "1 um")
    below = browser.find_element(By.CSS_SELECTOR, "#floats [data-gear='5'] figcaption").text
    assert "outside the picture: pinned A at (" in below


def test_a_link_opens_the_view_again(browser, seed, inputs):
    opened(browser, seed)
    types(browser, "rings.5.float", "3.21 um")
    slider = browser.find_element(By.ID, "position-slider")
    slider.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    settled(browser)
    browser.find_element(By.ID, "link").click()
    address = browser.current_url
    before = settled(browser)
    browser.get("about:blank")
    browser.get(address)
    after = settled(browser)
    assert (after["tables"], after["fields"]) == (before["tables"], before["fields"])
    assert contradicted(after, inputs, tables_of) == ""
    assert _position(browser) == ("3", "3 of 5")
    view = {"changes": {"rings.4.float": "2 um"}, "names": ["rings.4.float"], "position": 2}
    number = after["number"]
    browser.execute_script("location.hash = arguments[0]", quote(json.dumps(view)))
    waiting(browser, 10).until(lambda b: settled(b)["number"] != number)
    assert settled(browser)["fields"] == {"rings.4.float": "2 um"}
    assert _position(browser) == ("2", "2 of 5")


def _position(browser):
    """Return the value of the position slider, and the text beside it."""
    slider = browser.find_element(By.ID, "position-slider").get_attribute("value")
    text = browser.find_element(By.ID, "position-text").text
    assert browser.find_element(By.ID, "of").text.startswith(f"Pictures at position {slider}.")
    return slider, text.partition(",")[0]


def test_all_positions_replace_the_figures_of_one(browser, served):
    """Nothing is called K_γ before that; a position without an answer is reported."""
    case = partly_refused()
    with served(case) as address:
        opened(browser, address, names=["rings.4.float"])
        assert "Ω at position 1: I = " in browser.find_element(By.ID, "summary").text
        assert "1 of 15 positions" in browser.find_element(By.ID, "note").text
        browser.find_element(By.ID, "pin").click()
        whole(browser)
        says = settled(browser)
        compared, note, summary, bars = (
            browser.find_element(By.CSS_SELECTOR, place).text
            for place in ("#compared", "#note", "#summary", "#bars svg")
        )
        browser.get("about:blank")
    assert says["outcome"] == "partly refused"
    assert "position 9" in says["messages"][0]
    assert "14 of 15 positions certified" in note
    assert "Ω at 14 of 15" in bars
    assert "Kγ" not in summary
    # The pinned setting is the same, and follows.
    assert "Ω at 14 of 15" in compared
    assert "Ω at position 1" not in compared


def test_a_bad_link_does_no_harm(browser, seed, inputs):
    for bad in ("%7Bnope", "%00", json.dumps({"changes": {"x": "<img src=x>", "title": 3}})):
        browser.get("about:blank")
        browser.get(f"{seed}#{bad}")
        assert settled(browser)["tables"] == tables_of(inputs.case)
    assert browser.get_log("browser") == []


def test_what_is_saved(browser, seed, tmp_path):
    """The case is saved as a file that extends the original, the view as SVG and PNG."""
    browser.execute_cdp_cmd(
        "Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)}
    )
    opened(browser, seed, names=["rings.5.float"])
    types(browser, "rings.5.float", "3.21 um")
    names = {"toml": "limit_ring_explored.toml", "svg": "limit_ring.svg", "png": "limit_ring.png"}
    for button, name in names.items():
        browser.find_element(By.ID, button).click()
        file = tmp_path / name
        waiting(browser, 20).until(lambda _, file=file: file.exists())
        waiting(browser, 20).until(lambda _, file=file: file.stat().st_size > 0)
    written = tomllib.loads((tmp_path / names["toml"]).read_text())
    assert written == {"extends": "limit_ring.toml", "rings": {"5": {"float": "3.21 um"}}}
    assert (tmp_path / names["png"]).read_bytes().startswith(b"\x89PNG\r\n")
    drawn = (tmp_path / names["svg"]).read_text()
    assert "rings.5.float = 3.21 um" in drawn
    assert "Gear 5" in drawn


def test_hostile_texts_do_nothing(browser, served):
    case = Case(tomllib.loads(EVIL_CASE), name="</title><script>window.pwned=1</script>")
    with served(case) as address:
        browser.get(address)
        settled(browser)
        browser.find_element(By.ID, "pin").click()
        field = browser.find_element(By.ID, "search")
        field.send_keys("stiffness")
        assert browser.find_elements(By.CSS_SELECTOR, "#found button")
        field.send_keys("<img src=x onerror=window.pwned=1>*", Keys.ENTER)
        whole(browser)
        assert browser.execute_script("return window.pwned") is None
        assert browser.find_elements(By.CSS_SELECTOR, "main img, main script, main b, main i") == []
        assert browser.get_log("browser") == []


def test_nothing_is_compiled_and_no_other_script_runs(browser, seed):
    opened(browser, seed, names=[])
    browser.execute_script(
        """const script = document.createElement("script");
        script.textContent = "window.pwned = true";
        document.body.append(script);
        setTimeout(() => {
          try { new Function("return true")(); window.compiling = "works"; }
          catch (error) { window.compiling = "refused"; }
        }, 0);"""
    )
    found = waiting(browser, 10).until(lambda b: b.execute_script("return window.compiling"))
    assert found == "refused"
    assert browser.execute_script("return window.pwned") is None
    browser.get_log("browser")


SHOWN = ("fgfbstts/limit_ring", "nrel_5mw/gearbox", "fgfbstts/full_float", "two_path/nasa")


SCREENS = [(name, width) for name in SHOWN for width in (390, 1280, 1920)]


@pytest.mark.parametrize(("name", "width"), mostly_slow(SCREENS, [SCREENS[0]]))
def test_the_page_fits_every_screen(browser, served, name, width):
    """No horizontal scrolling, no words that overlap or are cut; contrast and names of controls."""
    on_screen(browser, width, dark=width == 1280)
    with served(shipped(name)) as address:
        browser.get(address)
        settled(browser)
        whole(browser)
        browser.find_element(By.ID, "pin").click()
        assert too_wide(browser, width) <= 0
        pictures = browser.find_elements(By.CSS_SELECTOR, PICTURES)
        assert len(pictures) >= 2
        assert [bad for one in pictures for bad in badly_set(browser, one)] == []
        assert browser.execute_script(CONTRAST) == []
        assert browser.execute_script(NAMES) == []
    on_screen(browser, 1280)


IN_SIGHT = """
const inside = (element) => {
  const box = element.getBoundingClientRect(), [x, y] = [box.left + 30, box.top + box.height / 2];
  return element.contains(document.elementFromPoint(x, y));
};
return [document.getElementById("verdict"), document.querySelector("#bars svg"),
  document.querySelector("[data-name='rings.5.float'] [type=range]")].map(inside);
"""


def test_on_a_phone_the_answer_is_in_sight_of_the_slider(browser, seed):
    """The verdict with K_γ, the shares of the branches and the slider are on one screen."""
    on_screen(browser, 390, 844)
    opened(browser, seed, names=["rings.5.float", "operating.power"])
    assert browser.execute_script(IN_SIGHT) == [True, True, True]
    says = types(browser, "rings.5.float", "2.2 um")
    kept = browser.find_element(By.ID, "summary").text
    assert kept == f"Kγ I = {says['tables'][0][0][2]}, Kγ II = {says['tables'][0][1][2]}"
    browser.execute_script("document.querySelector('#floats').scrollIntoView()")
    assert browser.execute_script(IN_SIGHT)[::2] == [True, True]
    on_screen(browser, 1280)


def test_flank_forces_have_heads(browser, seed):
    """Each arrow is an outline that is wider at its head than at its shaft, for any force."""
    opened(browser, seed, names=["operating.power"])
    _arrows(browser)
    # However small all forces are, the largest is wide.
    types(browser, "operating.power", "2 kW")
    assert max(shaft for shaft, _ in _arrows(browser)) > 5.0


def _arrows(browser):
    widths = browser.execute_script(
        """return [...document.querySelectorAll("#train .forces [data-mesh]")].map((arrow) => {
          const [a, , wing, , other, , b] = arrow.getAttribute("d").match(/-?[\\d.]+ -?[\\d.]+/g)
            .map((point) => point.split(" ").map(Number));
          const wide = ([x, y], [u, v]) => Math.hypot(u - x, v - y);
          return [wide(a, b), wide(wing, other)];
        });"""
    )
    assert len(widths) > 3
    assert all(head > shaft + 5.0 for shaft, head in widths)
    return widths


def test_contrast_of_an_answer_that_is_not_there_yet(browser, seed):
    for dark in (False, True):
        on_screen(browser, 1280, dark=dark)
        opened(browser, seed)
        browser.execute_script("document.body.dataset.state = 'asking'")
        assert browser.execute_script(CONTRAST) == []
    on_screen(browser, 1280)


def test_every_control_is_reached_by_the_keyboard(browser, seed):
    opened(browser, seed, names=["rings.5.float", "errors.6.installation.direction"])
    wanted = browser.execute_script(
        """return [...document.querySelectorAll("a[href], button, input, select, summary")]
        .filter((c) => c.checkVisibility() && !c.disabled).length;"""
    )
    seen = set()
    for _ in range(wanted + 2):
        ActionChains(browser).send_keys(Keys.TAB).perform()
        seen.add(browser.switch_to.active_element.id)
    assert len(seen) >= wanted
