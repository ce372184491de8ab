"""Every number in the prose of the pages is computed again, or known not to be a result."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def _load(name: str):
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


prose, figures = _load("prose"), _load("figures")


def read(page: str) -> str:
    text = (ROOT / page).read_text(encoding="utf-8")
    end = figures.MEASURED_FROM.get(page)
    return text if end is None else text[: text.index(end)]


def misfits(rule, text: str) -> list[str]:
    """Return what is wrong with the numbers of a rule, wherever its text occurs in a page."""
    found = prose.matches(rule, text)
    if not found:
        return []  # another test checks that each rule matches
    wanted = rule.values()
    wrong = []
    for match in found:
        for shown, value in zip(match.groups(), wanted, strict=True):
            if isinstance(value, figures.Below):
                fits = value.value < float(shown)
            else:
                fits = prose.same(shown, value)
            if not fits:
                wrong.append(f"{match[0]!r}: {shown} should be {value}")
    return wrong


SLOW = ("| CVXPY |", "| Picard |", "| power cone |", "| the same without reduction |")
"""Rows of solvers that take seconds; all solvers are compared in `tests/solver`."""


@pytest.mark.parametrize(
    "rule",
    [
        pytest.param(rule, marks=[pytest.mark.slow] if rule.text.startswith(SLOW) else [])
        for rule in figures.RULES
    ],
    ids=lambda rule: f"{rule.page}: {rule.text}"[:60],
)
def test_a_number_in_prose_is_what_is_computed(rule):
    assert misfits(rule, read(rule.page)) == []


@pytest.mark.parametrize("page", figures.PAGES)
def test_every_number_in_prose_is_accounted_for(page):
    """A new number needs a rule in `figures.RULES`, or a pattern in `GIVEN` if it is no result."""
    text = read(page)
    spans = [
        match.span()
        for rule in figures.RULES
        if rule.page == page
        for match in prose.matches(rule, text)
    ]
    for patterns in figures.GIVEN.values():
        for pattern in patterns:
            spans += [m.span() for m in re.finditer(pattern, text, re.MULTILINE)]
    assert prose.uncovered(text, spans) == []


@pytest.mark.parametrize("page", sorted({rule.page for rule in figures.RULES}))
def test_every_rule_is_about_something(page):
    text = read(page)
    own = [r for r in figures.RULES if r.page == page]
    idle = [r.text for r in own if not prose.matches(r, text)]
    # A clearance appears once, whether the pinion sticks or slips there.
    assert [t for t in idle if not t.endswith(("| st", "| slip"))] == []


def test_a_wrong_number_is_seen():
    rule = figures.Rule("", "carries {} % too much", lambda: [2.4549])
    assert misfits(rule, "branch 7-10 carries 2.5 % too much") == []
    assert misfits(rule, "branch 7-10 carries\n2.5 % too much") == []
    assert misfits(rule, "branch 7-10 carries 2.4 % too much")
    bound = figures.Rule("", "below {} here", lambda: [figures.Below(3e-13)])
    assert misfits(bound, "below 1e-12 here") == []
    assert misfits(bound, "below 1e-13 here")


def test_a_number_that_nobody_accounts_for_is_seen():
    page = "Ω is 1.05 here.\n```text\n1.06\n```\nSee `1.07` and [that](page.md#8), $x = 9$."
    assert prose.uncovered(page, []) == ["1.05 in: Ω is 1.05 here."]
    assert prose.uncovered(page, [(0, 10)]) == []
