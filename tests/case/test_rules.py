import tomllib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from tests.support import CASES, mostly_slow

from loadshare.case import Case, load_case
from loadshare.case.checks import CHECKS
from loadshare.case.content import ABOUT
from loadshare.case.draft import Draft, read_draft
from loadshare.case.keys import dotted, look_up, walk
from loadshare.case.origin import Origin
from loadshare.case.revise import revise
from loadshare.errors import CaseError

RULES = tomllib.loads(Path(__file__).with_name("rules.toml").read_text(encoding="utf-8"))["rule"]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule["said"][0].partition(": ")[2][:40])
def test_a_broken_rule_is_reported_word_for_word(drive: Case, rule):
    changes = dict.fromkeys(rule.get("drop", ())) | rule.get("change", {})
    with pytest.raises(CaseError) as caught:
        drive.replace(changes)
    assert [str(replace(problem, file="")) for problem in caught.value.problems] == rule["said"]


@pytest.fixture(scope="module")
def broken(drive: Case) -> Callable[[int], Draft]:
    """Return the draft that breaks a rule, made once for all checks."""

    @cache
    def draft(number: int) -> Draft:
        rule = RULES[number]
        changes = dict.fromkeys(rule.get("drop", ())) | rule.get("change", {})
        return read_draft(*revise(drive.to_dict(), Origin(), changes))

    return draft


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_every_check_is_broken_by_a_rule(broken, check):
    assert any(list(check(broken(number))) for number in range(len(RULES)))


SEVERAL = [
    "fgfbstts/all_elements.toml",
    "fgfbstts/spline_clearance.toml",
    "planetary/four_planets.toml",
    "two_path/from_teeth.toml",
]


@pytest.mark.parametrize(
    "file", mostly_slow(SEVERAL, {*SEVERAL} - {"fgfbstts/spline_clearance.toml"})
)
def test_a_changed_value_is_judged_as_in_a_case_that_is_new(file):
    """When one case is made from another, rules that a value does not concern are skipped."""
    case = load_case(CASES / file)
    for path in [path for path in walk(case.to_dict()) if path[0] not in ABOUT]:
        number, _, unit = str(look_up(case.to_dict(), path)).partition(" ")
        with suppress(ValueError):
            for changed in (0.0, -float(number), 30.0 * float(number)):
                change = {dotted(path): f"{changed!r} {unit}" if unit else changed}
                data, origin = revise(case.to_dict(), Origin(), change)
                assert _said(lambda: case.replace(change)) == _said(  # noqa: B023
                    lambda: Case(data, origin=origin)  # noqa: B023
                )


def _said(make) -> list[tuple[str, str]]:
    try:
        make()
    except CaseError as error:
        return [(problem.key, problem.message) for problem in error.problems]
    return []


def test_no_message_speaks_the_language_of_a_library():
    for rule in RULES:
        for word in ("Input should", "pydantic", "validation", "NoneType", "Traceback"):
            assert not any(word in message for message in rule["said"])


def test_one_bad_element_hides_no_other(drive: Case):
    with pytest.raises(CaseError) as caught:
        drive.replace(
            {
                "gears.a.base_radius": "3 kg",
                "gears.b.support": "rigd",
                'meshes."c-d".pressure_angle': "60 deg",
                'shafts."b-c".stiffness': 5,
                "stages.I.meshes": ["a-x"],
                "operating.output": "e",
                "assumed": ["shafts.*.radius"],
                "tittle": "x",
            }
        )
    assert [problem.key for problem in caught.value.problems] == [
        "tittle",
        "gears.a.base_radius",
        "gears.b.support",
        'meshes."c-d".pressure_angle',
        'shafts."b-c".stiffness',
        "operating.output",
        "stages.I.meshes[0]",
        "assumed[0]",
    ]
    assert str(caught.value).count("\n") == 7
