"""A sample of the stress map: outcomes only, never times.

Two linear programmes (`stress.truth`) decide what is solvable, not the solver under test.
"""

import pytest

import loadshare as ls
from benchmarks import families
from benchmarks.stress.families import FAMILIES
from benchmarks.stress.problem import COUNT
from benchmarks.stress.run import cell_of
from benchmarks.stress.truth import truth_of
from benchmarks.stress.verdict import Outcome, judge, ours
from benchmarks.stress.workbench import star
from loadshare.certify import certify
from loadshare.errors import Refused
from loadshare.train import build_train

SLICE = tuple(range(3, COUNT, 40))
"""Five problems of a family, over its whole range of levels."""


def test_there_are_enough_problems():
    assert len(FAMILIES) >= 16
    assert all(f.count >= 200 for f in FAMILIES.values())
    assert sum(f.count for f in FAMILIES.values()) >= 3000


@pytest.mark.parametrize("family", FAMILIES.values(), ids=lambda f: f.name)
@pytest.mark.quick(3)
def test_a_slice_of_the_map(family):
    for number in SLICE:
        verdict = judge(family.problem(number), ours)
        assert verdict.outcome in (Outcome.CERTIFIED, Outcome.REFUSED), verdict
        assert verdict.as_it_should_be, verdict


def test_a_problem_is_the_same_every_time():
    family = FAMILIES["wedging"]
    assert family.problem(17).case.to_toml() == family.problem(17).case.to_toml()
    assert family.problem(17).case != family.problem(18).case
    with pytest.raises(IndexError, match="problems 0 to 199"):
        family.problem(200)


def test_every_level_is_used_from_harmless_to_extreme():
    for family in FAMILIES.values():
        used = [family.level(n) for n in range(family.count)]
        assert set(used) == set(family.levels)
        assert used[0] == family.levels[0]
        assert used[-1] == family.levels[-1]


def test_truth_knows_what_cannot_be_balanced():
    bent = star(2)
    bent.place("planet2", 2.5)
    truth = truth_of(build_train(bent.case("bent")))
    assert not truth.solvable
    assert truth.elements == ("sun",)
    assert truth_of(build_train(families.star(3))).solvable


def test_truth_knows_limits_that_contradict_each_other():
    for number in range(0, COUNT, 7):
        problem = FAMILIES["impossible"].problem(number)
        truth = truth_of(build_train(problem.case))
        assert not truth.solvable, problem.name
        assert truth.elements


@pytest.mark.slow
@pytest.mark.parametrize("family", FAMILIES)
def test_every_problem_is_a_train(family):
    """Problems must be within the limits of case files, which may have become stricter."""
    for number in range(COUNT):
        build_train(FAMILIES[family].problem(number).case)


def _claims(shift: float):
    """Return a method that claims the right answer with every rotation off by a factor."""

    def method(problem, train):
        found = ls.explain(problem.case, 1).equilibrium
        from dataclasses import replace

        return replace(found, rotation={g: v * (1.0 + shift) for g, v in found.rotation.items()})

    return method


def test_a_wrong_claim_is_called_wrong():
    problem = FAMILIES["lost-contact"].problem(5)
    assert judge(problem, _claims(0.0)).outcome is Outcome.CERTIFIED
    verdict = judge(problem, _claims(1e-6))
    assert verdict.outcome is Outcome.WRONG
    assert not verdict.as_it_should_be
    cell = cell_of("a peer", "lost-contact", [verdict])
    assert cell.counts["wrong"] == cell.missed == 1


def test_crashes_and_refusals_are_distinguished():
    problem = FAMILIES["lost-contact"].problem(5)

    def refuses(_problem, _train):
        raise Refused("position 1: no")

    def crashes(_problem, _train):
        raise ZeroDivisionError("float division by zero")

    assert judge(problem, refuses).outcome is Outcome.REFUSED
    crash = judge(problem, crashes)
    assert crash.outcome is Outcome.CRASHED
    assert "ZeroDivisionError" in crash.reason


def test_a_certified_answer_to_a_problem_without_one_would_be_wrong():
    impossible = FAMILIES["impossible"].problem(0)
    other = FAMILIES["lost-contact"].problem(5)
    found = ls.explain(other.case, 1).equilibrium
    assert certify(build_train(other.case), found).passed

    from benchmarks.stress.verdict import _judged

    truth = truth_of(build_train(impossible.case))
    _, outcome, _ = _judged(build_train(other.case), found, truth)
    assert outcome is Outcome.WRONG
