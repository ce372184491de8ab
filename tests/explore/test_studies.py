"""Studies beside the page: run by workers, cancelled when nobody waits for them."""

from __future__ import annotations

import http.client
import json
import re
import time
import tomllib
from contextlib import suppress
from itertools import pairwise
from urllib.parse import urlsplit

import pytest
from selenium.common.exceptions import ElementNotInteractableException, TimeoutException
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from tests.chromium import badly_set, steady, waiting
from tests.explore.asking import ask
from tests.explore.conftest import SEED
from tests.explore.walks import opened, settled, whole
from tests.support import shipped

import loadshare as ls
from loadshare.explore import workers
from loadshare.explore.answer import plain
from loadshare.explore.inputs import PageInputs
from loadshare.explore.questions import Along
from loadshare.explore.request import RequestError
from loadshare.explore.samples import omega_table, scatter
from loadshare.job.engines import is_available
from loadshare.settings import EXPLORE, JOB

FLOAT = {"name": "rings.*.float", "low": 0.0, "high": 12.0}


def study(address, name, body):
    """Return the lines of a study's answer."""
    status, headers, content = ask(address, f"/study/{name}", body)
    assert status == 200
    assert headers["content-type"] == "application/x-ndjson"
    return [json.loads(line) for line in content.splitlines()]


@pytest.mark.slow
def test_critical_values_are_those_of_the_study(seed):
    """They are searched interval by interval, the nearest to the present value first."""
    lines = study(seed, "critical", FLOAT | {"low": 2.5, "high": 3.1, "at": 2.95})
    assert [line["done"] for line in lines] == list(range(1, EXPLORE.stretches + 1))
    assert {line["of"] for line in lines} == {EXPLORE.stretches}
    wanted = ls.critical(str(SEED), "rings.*.float", "2.5 um", "3.1 um", positions=[1])
    found = [event["value"] for line in lines for event in line["events"]]
    # The start of the search affects the last digits.
    assert found == pytest.approx(sorted({e.value for e in wanted.events}), rel=1e-9)
    text = lines[0]["events"][0]["label"]
    assert text.startswith("gear 5 leaves its ring")
    assert text.endswith("at 2.977 um")
    gaps = [end for line in lines for gap in line["gaps"] for end in gap[:2]]
    assert gaps == pytest.approx([e for u in wanted.unproved for e in (u.start, u.stop)], rel=1e-8)


@pytest.mark.parametrize(("low", "high"), [(0.0, 7.0), (-1e308, -1.0)])
def test_stretches_make_the_whole_slider(low, high):
    whole = Along(shipped("fgfbstts/limit_ring"), ("rings.4.float",), low, high, "um", 2, 1)
    at = low + 0.7 * (high - low)
    parts = whole.stretches(at)
    assert parts[0].low <= at <= parts[0].high
    ends = sorted((part.low, part.high) for part in parts)
    assert ends[0][0] == low
    assert ends[-1][1] == high
    assert all(one[1] == other[0] for one, other in pairwise(ends))


@pytest.mark.slow
def test_a_stretch_whose_end_makes_no_case_is_reported(seed):
    """The other intervals are still searched."""
    request = {"name": "rings.4.float", "low": -1.0, "high": 2.0, "at": 2.0}
    lines = study(seed, "critical", request)
    assert lines[0]["gaps"] == []
    low, high, why = lines[-1]["gaps"][0]
    assert (low, high) == (-1.0, -0.5)
    assert "negative" in why


def test_a_trace_is_a_sweep(seed):
    (found,) = study(seed, "sweep", FLOAT | {"points": 5, "position": 2})
    wanted = ls.sweep(str(SEED), {"rings.*.float": "0 um:12 um:5"}, positions=[2]).dataset
    assert found["x"] == [0.0, 3.0, 6.0, 9.0, 12.0]
    omega = wanted["omega"].sel(stage="II").values.tolist()
    assert found["lines"]["II"] == pytest.approx(omega, rel=1e-9)
    assert len(found["places"]["4"]) == 5


def test_what_matters_comes_in_parts(seed):
    keys = ["rings.4.float", "rings.5.float", "errors.9.installation.amount"]
    lines = study(seed, "slopes", {"keys": keys})
    assert [line["done"] for line in lines] == [2, 3]
    cells = {row[0]: row[1:] for line in lines for row, _ in line["rows"]}
    wanted = ls.sensitivity(str(SEED), "rings.5.float", positions=[1])
    rate = wanted.omega["rings.5.float", "rising"]["system"] * 1e-6
    assert f"{rate:+.3g}" in cells["rings.5.float"][0]
    assert cells["rings.4.float"][0].startswith("0 ")
    assert set(cells) == set(keys)
    effects = {row[0]: effect for line in lines for row, effect in line["rows"]}
    assert effects["rings.5.float"] > effects["rings.4.float"] == 0.0


def test_a_slope_to_a_side_that_is_none_is_no_zero(seed):
    """A float of zero can only grow."""
    none = {"rings.4.float": "0 um"}
    (line,) = study(seed, "slopes", {"keys": ["rings.4.float"], "changes": none})
    ((key, slope, _), effect), *_ = line["rows"]
    case = ls.load_case(SEED).replace(none)
    wanted = ls.sensitivity(case, "rings.4.float", positions=[1]).omega["rings.4.float", "rising"]
    assert key == "rings.4.float"
    assert slope == f"– | {wanted['system'] * 1e-6:+.3g} per um"
    assert effect > 0.0


RANGES = {"rings.*.float": [0.0, 12.0], "errors.6.installation.direction": [-180.0, 180.0]}


def figures(found, limit):
    """Return the table of a page, from the result of `loadshare tolerance`."""
    shown = [one for one in found.omega if one.over in found.overs]
    shown.sort(key=lambda one: one != found.of("system", "stage"))
    return plain(omega_table(shown, limit))["rows"]


@pytest.mark.slow
def test_a_tolerance_study_of_what_is_shown_is_the_one_of_the_library(seed):
    """Samples, and statistics at every stage, are the same to the last printed digit."""
    # The compiled engine solves a block at a time.
    count = JOB.block + 400 if is_available() else 512
    body = {"ranges": RANGES, "samples": count, "seed": 3, "limit": 1.003}
    lines = study(seed, "tolerance", body)
    first, *parts = lines
    assert len(parts) > 1
    assert [part["done"] for part in parts] == sorted(part["done"] for part in parts)
    case = ls.load_case(SEED).replace(
        {"errors.6.installation": {"amount": "100.0 um", "direction": "90.0 deg"}}
    )
    table = tomllib.loads(first["begun"]["toml"])["study"]["explorer"]
    assert table["inputs"]["rings.4.float=rings.5.float"]["distribution"] == "uniform"
    case = case.replace({"study.explorer": table})
    found = ls.tolerance(case, indices=0, worst=False)
    assert parts[-1]["table"]["rows"] == figures(found, 1.003)
    assert parts[-1]["done"] == found.samples == count
    assert sum(parts[-1]["histogram"]["counts"]) == found.of("system", "stage").summary.count
    early = ls.tolerance(case, samples=parts[0]["done"], indices=0, worst=False)
    assert parts[0]["table"]["rows"] == figures(early, 1.003)


def test_counts_and_geometry_do_not_scatter():
    """They are left out and named; alone they are no study."""
    inputs = PageInputs(shipped("planetary/four_planets"))
    ranges = {"gears.sun.teeth": [0.0, 36.0], "gears.sun.centre[0]": [-0.1, 0.1]}
    varying = {"errors.planet2.pin.tangential": [0.0, 40.0]}
    found = scatter(inputs, {"ranges": ranges | varying})
    assert list(found.table["inputs"]) == list(varying)
    assert found.left == tuple(ranges)
    with pytest.raises(RequestError, match="only counts and geometry"):
        scatter(inputs, {"ranges": ranges})


@pytest.mark.slow
def test_a_study_of_the_case_is_the_one_that_its_file_describes(served):
    case = shipped("nrel_5mw/gearbox")
    with served(case) as address:
        offered = ask(address, "/case")[2]["studies"]
        first, *parts = study(address, "tolerance", {"study": "pins", "samples": 32, "seed": 1})
    assert set(offered) == {"pins", "teeth"}
    assert first["begun"]["limit"] == 1.1
    found = ls.tolerance(case, study="pins", samples=32, indices=0, worst=False)
    assert parts[-1]["table"]["rows"] == figures(found, 1.1)
    assert first["begun"]["inputs"] == [[i.name, str(i.distribution)] for i in found.inputs.every]


@pytest.mark.slow
def test_samples_without_an_answer_are_counted(seed):
    """The load would compress teeth by more than their height."""
    request = {"changes": {"operating.power": "2e9 kW"}, "ranges": RANGES, "samples": 20}
    last = study(seed, "tolerance", request)[-1]
    assert (last["done"], last["refused"]) == (20, 20)
    assert last["reasons"][0].startswith("20 × ")
    assert "table" not in last


def test_what_is_no_length_scatters_about_its_setting(seed):
    request = {"ranges": {"operating.power": [0.0, 9.0]}, "changes": {"operating.power": "100 kW"}}
    first = study(seed, "tolerance", request | {"samples": 1})[0]["begun"]
    distribution = "truncated normal mean 100, deviation 2, low 94, high 106 kW"
    assert first["inputs"] == [["operating.power", distribution]]


@pytest.mark.parametrize(
    ("name", "body", "status"),
    [
        ("nothing", FLOAT, 404),
        ("sweep", {}, 400),
        ("sweep", FLOAT | {"points": 10**6}, 400),
        ("sweep", FLOAT | {"low": "x"}, 400),
        ("critical", FLOAT | {"low": 5.0, "high": 1.0}, 400),
        ("critical", FLOAT | {"low": -1e308, "high": 1e308}, 400),
        ("critical", FLOAT | {"at": None}, 400),
        ("critical", FLOAT | {"at": 10**400}, 400),
        ("slopes", FLOAT | {"keys": "x"}, 400),
        ("slopes", {"keys": []}, 400),
        ("tolerance", {}, 400),
        ("tolerance", {"ranges": {"rings.4.float": [1]}}, 400),
        ("tolerance", {"ranges": {"rings.4.float": [0, 1]}, "samples": 10**9}, 400),
        ("tolerance", {"ranges": {"rings.4.float": [0, 1]}, "seed": -1}, 400),
        ("tolerance", {"study": "no such"}, 400),
    ],
)
def test_odd_studies_are_answered_with_a_message(seed, name, body, status):
    found = ask(seed, f"/study/{name}", body)
    assert found[0] == status
    assert found[2]["messages"]


@pytest.mark.parametrize(
    ("name", "body", "why"),
    [
        ("sweep", FLOAT | {"name": "title"}, "describes the case"),
        ("slopes", {"keys": ["title"]}, "describes the case"),
        ("tolerance", {"ranges": {"rings.4.float": [2, 1]}}, "is not above low"),
        ("tolerance", {"ranges": {"rings.4.float": [-1, 1]}}, "negative"),
        ("tolerance", {"ranges": {"title": [0, 1]}}, "describes the case"),
        (
            "tolerance",
            {"ranges": {"operating.power": [1, 2]}, "changes": {"operating.power": "5 mm"}},
            "operating.power = .5 mm.",
        ),
    ],
)
def test_a_study_that_cannot_be_is_reported(seed, name, body, why):
    status, _, content = ask(seed, f"/study/{name}", body)
    assert status == 200
    found = content if isinstance(content, dict) else json.loads(content)
    assert re.search(why, " ".join(found["messages"]))


def test_a_study_that_is_broken_off_is_stopped(seed):
    """Its worker is killed, and the next study is served."""
    parts = urlsplit(seed)
    for _ in range(2):
        line = http.client.HTTPConnection(parts.hostname, parts.port)
        body = json.dumps(FLOAT | {"points": 401})
        line.request("POST", "/study/sweep", body, {"Content-Type": "application/json"})
        time.sleep(0.1)
        line.close()
    (found,) = study(seed, "sweep", FLOAT | {"points": 3})
    assert len(found["x"]) == 3


def test_a_study_that_has_begun_is_not_refused_when_many_wait(seed, monkeypatch):
    """It used to end with what it had found, if others came between two of its parts."""
    parts = urlsplit(seed)
    line = http.client.HTTPConnection(parts.hostname, parts.port, timeout=300)
    keys = ["gears.*.base_radius", "rings.*.float", "errors.9.installation.amount"]
    body = json.dumps({"keys": keys})
    line.request("POST", "/study/slopes", body, {"Content-Type": "application/json"})
    reply = line.getresponse()
    first = json.loads(reply.readline())
    monkeypatch.setattr(workers, "EXPLORE", EXPLORE._replace(waiting=0))
    assert ask(seed, "/study/slopes", {"keys": keys})[0] == 503
    found = [first, *map(json.loads, reply)]
    line.close()
    assert all("rows" in one for one in found)
    assert found[-1]["done"] == found[-1]["of"] > 2 * len(first["rows"])


@pytest.mark.slow
def test_a_tolerance_study_that_is_broken_off_frees_its_worker(seed):
    """The study is cancelled in the middle of its lines."""
    parts = urlsplit(seed)
    line = http.client.HTTPConnection(parts.hostname, parts.port, timeout=300)
    body = json.dumps({"ranges": RANGES, "samples": 100_000})
    line.request("POST", "/study/tolerance", body, {"Content-Type": "application/json"})
    reply = line.getresponse()
    assert "begun" in json.loads(reply.readline())
    assert json.loads(reply.readline())["done"] < 100_000
    line.close()
    (found,) = study(seed, "sweep", FLOAT | {"points": 3})
    assert len(found["x"]) == 3


@pytest.mark.slow
def test_ticks_trace_and_a_study_on_the_page(browser, seed):
    opened(browser, seed, names=["rings.*.float"])
    field = browser.find_element(By.CSS_SELECTOR, ".control[data-name] .value")
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys("2.95 um", Keys.ENTER)
    settled(browser)
    browser.find_element(By.CSS_SELECTOR, ".control[data-name] summary").click()
    for end, value in zip(
        browser.find_elements(By.CSS_SELECTOR, ".control[data-name] details input"),
        ("2.9", "3.0"),
        strict=True,
    ):
        end.send_keys(Keys.CONTROL, "a")
        end.send_keys(value, Keys.ENTER)
    buttons = browser.find_elements(By.CSS_SELECTOR, ".control[data-name] .row button")
    buttons[0].click()
    tick = By.CSS_SELECTOR, ".ticks button"

    def pressed(page):
        with suppress(ElementNotInteractableException):
            page.find_element(*tick).send_keys(Keys.ENTER)
            return True
        return False

    waiting(browser, 120).until(lambda b: b.find_elements(*tick))
    # Further intervals of the slider redraw them.
    labels = steady(
        browser, lambda b: [one.get_attribute("aria-label") for one in b.find_elements(*tick)]
    )
    assert any("gear 5 leaves its ring" in label for label in labels)
    buttons[1].click()
    waiting(browser, 120).until(lambda b: b.find_elements(By.CSS_SELECTOR, "#trace svg"))
    # While the trace is being placed, ticks are out of reach for a moment.
    waiting(browser, 60).until(lambda b: steady(b, pressed))
    says = settled(browser)
    assert says["fields"]["rings.*.float"].startswith("2.976")
    assert browser.find_elements(By.CSS_SELECTOR, "#trace svg .here")
    drawn = By.CSS_SELECTOR, "figure:not([hidden]) > svg"
    bad = steady(browser, lambda b: [badly_set(b, picture) for picture in b.find_elements(*drawn)])
    assert bad
    assert not any(bad)
    assert browser.get_log("browser") == []


def shown(browser, identity):
    return browser.find_element(By.ID, identity)


def begin(browser, samples):
    """Start a tolerance study on the page, and wait for its first figures."""
    shown(whole(browser), "samples").clear()
    shown(browser, "samples").send_keys(str(samples))
    shown(browser, "tolerance").click()
    try:
        waiting(browser, 120).until(
            lambda b: (
                b.find_elements(By.CSS_SELECTOR, "#histogram svg")
                and b.find_elements(By.CSS_SELECTOR, "#statistics table")
            )
        )
    except TimeoutException:
        pytest.fail(f"no figures; the page says: {shown(browser, 'sampled').text!r}")


@pytest.mark.slow
def test_a_tolerance_study_grows_is_stopped_and_says_of_what_it_is(browser, seed):
    opened(browser, seed, names=["rings.5.float"])
    begin(browser, 100_000)
    assert "uniform" in shown(browser, "scattering").get_attribute("textContent")
    assert "[study.explorer]" in shown(browser, "scatter-toml").get_attribute("textContent")
    assert badly_set(browser, "#histogram svg") == []
    before = shown(browser, "sampled").text
    waiting(browser, 120).until(lambda b: shown(b, "sampled").text != before)
    shown(browser, "stop").click()
    label = shown(browser, "sampled").text
    assert label.startswith("stopped: ")
    assert label.endswith("of 100000 samples")
    time.sleep(0.5)
    assert shown(browser, "sampled").text == label
    assert not shown(browser, "stop").is_enabled()
    # A repeated study ends when the setting changes; its result names the setting it belongs to.
    begin(browser, 100_000)
    assert not shown(browser, "earlier").is_displayed()
    slider = browser.find_element(By.CSS_SELECTOR, "[data-name='rings.5.float'] [type=range]")
    slider.send_keys(Keys.ARROW_RIGHT)
    settled(browser)
    label = shown(browser, "sampled").text
    assert label.startswith("stopped, as the setting has changed: ")
    assert shown(browser, "earlier").is_displayed()
    assert "As the case has it" in shown(browser, "sampled-of").text
    time.sleep(0.5)
    assert shown(browser, "sampled").text == label
    assert browser.get_log("browser") == []


def test_a_tolerance_study_comes_to_its_end(browser, served):
    """The numbers on the page are those of the library, with the seed and count of the case."""
    case = shipped("nrel_5mw/gearbox")
    with served(case) as address:
        opened(browser, address, names=[])
        fields = [shown(browser, name).get_attribute("value") for name in ("samples", "seed")]
        assert fields == ["4096", "1"]
        begin(browser, 8)
        waiting(browser, 120).until(lambda b: not shown(b, "stop").is_enabled())
        assert shown(browser, "sampled").text == "8 of 8 samples"
        rows = browser.execute_script(
            """return [...document.querySelectorAll("#statistics tbody tr")].map((row) =>
            [...row.cells].map((cell) => cell.textContent));"""
        )
    found = ls.tolerance(case, study="pins", samples=8, indices=0, worst=False)
    assert rows == figures(found, 1.1)
    assert browser.get_log("browser") == []


def test_what_matters_on_the_page(browser, seed):
    opened(browser, seed, names=["rings.5.float", "operating.power"])
    shown(whole(browser), "slopes").click()
    waiting(browser, 120).until(
        lambda b: (
            b.find_elements(By.CSS_SELECTOR, "#mattering tr") and not shown(b, "slopes-status").text
        )
    )
    rows = browser.find_elements(By.CSS_SELECTOR, "#mattering tbody tr")
    keys = [row.find_element(By.TAG_NAME, "td").text for row in rows]
    assert {"rings.5.float", "operating.power", "errors.6.installation.amount"} <= set(keys)
    effects = [abs(float(row.text.split()[-1].replace("−", "-"))) for row in rows]
    assert effects == sorted(effects, reverse=True)
    slider = browser.find_element(By.CSS_SELECTOR, "[data-name='rings.5.float'] [type=range]")
    slider.send_keys(Keys.ARROW_RIGHT)
    assert browser.find_elements(By.CSS_SELECTOR, "#mattering tr") == []
    settled(browser)
