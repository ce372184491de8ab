import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from loadshare.case import Case
from loadshare.case.checks import CHECKS
from loadshare.case.draft import read_draft
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


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_every_check_is_broken_by_a_rule(drive: Case, check):
    def problems(rule):
        changes = dict.fromkeys(rule.get("drop", ())) | rule.get("change", {})
        data, origin = revise(drive.to_dict(), Origin(), changes)
        return list(check(read_draft(data, origin)))

    assert any(problems(rule) for rule in RULES)


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
