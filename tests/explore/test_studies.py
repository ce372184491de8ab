"""Studies beside the page: by workers, broken off when nobody waits for them."""

from __future__ import annotations

import http.client
import json
import time
from urllib.parse import urlsplit

import pytest
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait
from tests.explore.asking import ask
from tests.explore.conftest import SEED
from tests.explore.walks import opened, settled

import loadshare as ls

FLOAT = {"name": "rings.*.float", "low": 0.0, "high": 12.0}


@pytest.mark.slow
def test_critical_values_are_those_of_the_study(seed):
    found = ask(seed, "/study/critical", FLOAT | {"low": 2.9, "high": 3.0})[2]
    wanted = ls.critical(str(SEED), "rings.*.float", "2.9 um", "3.0 um", positions=[1])
    assert [e["value"] for e in found["events"]] == sorted({e.value for e in wanted.events})
    assert found["events"][0]["told"].startswith("gear 5 leaves its ring")
    assert found["events"][0]["told"].endswith("at 2.977 um")
    assert [gap[:2] for gap in found["gaps"]] == [[u.start, u.stop] for u in wanted.unproved]


def test_a_trace_is_a_sweep(seed):
    found = ask(seed, "/study/sweep", FLOAT | {"points": 5, "position": 2})[2]
    wanted = ls.sweep(str(SEED), {"rings.*.float": "0 um:12 um:5"}, positions=[2]).dataset
    assert found["x"] == [0.0, 3.0, 6.0, 9.0, 12.0]
    omega = wanted["omega"].sel(stage="II").values.tolist()
    assert found["lines"]["II"] == pytest.approx(omega, rel=1e-9)
    assert len(found["places"]["4"]) == 5


def test_what_matters(seed):
    keys = ["rings.4.float", "rings.5.float", "errors.9.installation.amount"]
    found = ask(seed, "/study/slopes", {"name": keys[0], "keys": keys})[2]
    told = {row[0]: row[1:] for row in found["rows"]}
    wanted = ls.sensitivity(str(SEED), "rings.5.float", positions=[1])
    rate = wanted.omega["rings.5.float", "rising"]["system"] * 1e-6
    assert f"{rate:+.3g}" in told["rings.5.float"][0]
    assert told["rings.4.float"][0].startswith("0 ")
    assert set(told) == set(keys)


def test_pieces_make_the_whole_tolerance_study(seed):
    ranges = {"rings.*.float": [0.0, 12.0], "errors.6.installation.direction": [-180.0, 180.0]}
    values, first = [], 0
    while first < 256:
        asked = {"ranges": ranges, "samples": 256, "seed": 3, "first": first}
        found = ask(seed, "/samples", asked)[2]
        values += found["values"]
        first += found["done"]
    spreads = {
        "rings.4.float=rings.5.float": {"distribution": "uniform", "low": "0 um", "high": "12 um"},
        "errors.6.installation.direction": {
            "distribution": "uniform",
            "low": "-180 deg",
            "high": "180 deg",
        },
    }
    table = {"errors.6.installation": {"amount": "100.0 um", "direction": "90.0 deg"}}
    whole = ls.tolerance(
        ls.load_case(SEED).replace(table), spreads, samples=256, seed=3, indices=0, worst=False
    )
    wanted = whole.to_frame(["omega.system"])["omega.system"].tolist()
    assert values == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize(
    ("path", "body", "status"),
    [
        ("/study/nothing", FLOAT, 404),
        ("/study/sweep", {}, 400),
        ("/study/sweep", FLOAT | {"points": 10**6}, 400),
        ("/study/sweep", FLOAT | {"low": "x"}, 400),
        ("/study/slopes", FLOAT | {"keys": "x"}, 400),
        ("/samples", {}, 400),
        ("/samples", {"ranges": {"rings.4.float": [1]}}, 400),
        ("/samples", {"ranges": {"rings.4.float": [0, 1]}, "samples": 10**9}, 400),
    ],
)
def test_odd_studies_are_answered_with_a_message(seed, path, body, status):
    found = ask(seed, path, body)
    assert found[0] == status
    assert found[2]["messages"]


def test_a_study_that_cannot_be_is_told(seed):
    told = ask(seed, "/study/critical", {"name": "rings.4.float", "low": 5.0, "high": 1.0})[2]
    assert "is not below" in told["messages"][0]
    told = ask(seed, "/study/sweep", FLOAT | {"name": "title"})[2]
    assert "is no number" in told["messages"][0] or "matches no key" in told["messages"][0]


def test_a_study_that_is_broken_off_is_stopped(seed):
    """Its worker is killed, and the next one is served."""
    parts = urlsplit(seed)
    for _ in range(3):
        line = http.client.HTTPConnection(parts.hostname, parts.port)
        body = json.dumps(FLOAT | {"points": 401})
        line.request("POST", "/study/sweep", body, {"Content-Type": "application/json"})
        time.sleep(0.1)
        line.close()
    found = ask(seed, "/study/sweep", FLOAT | {"points": 3})[2]
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
    ticks = WebDriverWait(browser, 120).until(
        lambda b: b.find_elements(By.CSS_SELECTOR, ".ticks button")
    )
    assert any("gear 5 leaves its ring" in one.get_attribute("aria-label") for one in ticks)
    buttons[1].click()
    WebDriverWait(browser, 120).until(lambda b: b.find_elements(By.CSS_SELECTOR, "#trace svg"))
    ticks[0].send_keys(Keys.ENTER)
    says = settled(browser)
    assert says["fields"]["rings.*.float"].startswith("2.976")
    assert browser.find_elements(By.CSS_SELECTOR, "#trace svg .here")
    browser.find_element(By.ID, "samples").send_keys("0")
    browser.find_element(By.ID, "tolerance").click()
    WebDriverWait(browser, 120).until(lambda b: b.find_elements(By.CSS_SELECTOR, "#histogram svg"))
    browser.find_element(By.ID, "stop").click()
    told = browser.find_element(By.ID, "study").text
    time.sleep(0.5)
    assert told.startswith("stopped")
    assert browser.find_element(By.ID, "study").text == told
    assert browser.get_log("browser") == []
