"""The fast method gives the equilibrium of Clarabel with the exact solve, or none.

Source: formulation, sections 7 and 11. Both end in a dense solve on an identified active set, by
different formulas (forces here, displacements there); they differ by round-off times the condition
number of the case. 1e-9 of the largest figure is required, as between the back-ends.
"""

import pytest
from hypothesis import given, note, settings
from hypothesis import strategies as st
from tests.physics.test_random_trains import split_torques, stars
from tests.reproducible import TRAINS, examples
from tests.support import EVERY_SHIPPED, answer, disagreement, forces, furthest, shipped

import loadshare as ls
from loadshare.certify import certify
from loadshare.job.hot import HOT, hot_answers
from loadshare.job.machine import Machine
from loadshare.results.result import Position
from loadshare.settings import CERTIFY
from loadshare.train import build_train

AGREE = 1e-9
EXACT = 1e-12
"""Residual below which displacements are compared. A larger imbalance, though within the tolerance,
may float a loose gear to its limit in only one of the answers.
"""


def floats(position: Position) -> dict[tuple[str, int], float]:
    """Return the displacements of a position [m] by gear and axis."""
    return {(g, k): v for g, d in position.displacement.items() for k, v in enumerate(d)}


@pytest.mark.parametrize("case", EVERY_SHIPPED)
@pytest.mark.quick(4)
def test_every_position_of_a_shipped_case(case):
    """Undetermined displacements agree as well: both give those of least norm."""
    hot, other = ls.solve(shipped(case)), ls.solve(shipped(case), solver="clarabel")
    for here, there in zip(hot.positions, other.positions, strict=True):
        assert here.effort.rung == HOT, here.position
        assert there.effort.rung == "clarabel + exact"
        assert furthest(here.torque, there.torque) < AGREE, here.position
        assert furthest(here.coast_torque, there.coast_torque) < AGREE, here.position
        assert furthest(floats(here), floats(there)) < AGREE, here.position
        assert here.undetermined.keys() == there.undetermined.keys(), here.position
        for name, ends in here.undetermined.items():
            assert there.undetermined[name] == pytest.approx(ends, rel=AGREE), name


def agrees(case: ls.Case) -> bool:
    """Return whether the fast method answers a train; its answer must then be right."""
    note(case.to_toml())
    train = build_train(case)
    found = hot_answers(Machine(train), [1], CERTIFY.tolerance).get(1)
    if found is None:
        return False
    mine = found.equilibrium
    verdict = certify(train, mine)
    assert verdict.passed, verdict.failing
    assert found.certificate.passed
    try:
        other, _ = answer(train)
    except ls.Refused:
        return True
    second = certify(train, other)
    if second.passed:
        # Forces agree as closely as the certificates found the answers to be in balance.
        left = max(verdict.worst, second.worst)
        assert furthest(forces(mine), forces(other)) < AGREE + 10.0 * left
        if left < EXACT:
            assert disagreement(train, mine, other)[1] < AGREE
    return True


@pytest.mark.parametrize("family", [stars, split_torques], ids=["star", "split torque"])
@pytest.mark.quick(1)
def test_a_random_train(family):
    """Its answers are right, and it answers nearly all: the ladder would hide its failures."""
    answered = []

    @settings(TRAINS, max_examples=examples(6, 12))
    @given(family())
    def run(case: ls.Case) -> None:
        answered.append(agrees(case))

    run()
    assert sum(answered) >= 0.9 * len(answered), answered


@pytest.mark.slow
def test_many_random_trains():
    answered = []

    @settings(TRAINS, max_examples=500)
    @given(st.one_of(split_torques(), stars()))
    def run(case: ls.Case) -> None:
        answered.append(agrees(case))

    run()
    assert sum(answered) >= 0.9 * len(answered), answered
