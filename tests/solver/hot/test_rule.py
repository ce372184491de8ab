"""The rule that predicts a sample's active set: what it learns, and that it changes no answer."""

import numpy as np
import pytest
from tests.solver.hot.trains import ROLLERS, planets_in_bearings
from tests.support import CASES

from benchmarks.workloads import workloads
from loadshare.job.machine import Machine
from loadshare.scene.loading import loading_of
from loadshare.settings import RULE
from loadshare.solver.hot import compiled, vectorised
from loadshare.solver.hot import rule as rule_module
from loadshare.solver.hot.exchange import exchange, first_sets
from loadshare.solver.hot.iterate import at_rest
from loadshare.solver.hot.rule import rule_of, samples_to_learn
from loadshare.train.samples import samples_of

TAUGHT, COUNT = 256, 768
SPRING, RIGID = {"stiffness": "4e8 N/m"}, {"stiffness": "rigid"}


@pytest.fixture(scope="module")
def rings():
    """Return a machine with limit rings, samples of errors, and what exchange finds from rest."""
    work = workloads(CASES, quick=True)[0]
    ((_, samples),) = samples_of(work.case, work.some(COUNT))
    machine, situations = Machine(samples.train), samples.situations(1)
    loading = loading_of(machine.structure, situations)
    iterate = at_rest(machine.structure, loading)
    states = first_sets(machine.structure, loading)
    found = exchange(machine.structure, loading, iterate, vectorised.settle, states)
    return machine, situations, loading, iterate, found


def test_it_names_most_sets_of_samples_that_it_has_not_seen(rings):
    machine, _, loading, iterate, found = rings
    taught = np.arange(TAUGHT)
    states = found.states[:, : machine.structure.rows]
    of = machine.structure, loading.take(taught), found.states[taught], iterate.take(taught)
    rule = rule_of(*of)
    right = (rule.states[rule.named(loading)[0]] == states).all(axis=1)[TAUGHT:]
    _, times = np.unique(states, axis=0, return_counts=True)
    assert right.mean() >= max(0.7, 1.1 * times.max() / COUNT)


def test_samples_of_one_set_all_begin_there(rings):
    machine, _, loading, iterate, found = rings
    states, taught = np.repeat(found.states[:1], TAUGHT, axis=0), np.arange(TAUGHT)
    rule = rule_of(machine.structure, loading.take(taught), states, iterate.take(taught))
    named = rule.states[rule.named(loading)[0]]
    assert (named == states[0, : machine.structure.rows]).all()


@pytest.mark.parametrize("count", [640, 5120, 16_670, 10**6])
def test_samples_to_learn_from_are_spread_over_all_positions(count):
    rows, wanted = samples_to_learn(count), min(RULE.taught, count // RULE.worth)
    assert 0.9 * wanted < len(rows) <= wanted
    per_part = np.bincount(rows * 5 // count)
    assert np.abs(per_part - len(rows) / 5).max() <= 2
    # Except for some, they are other samples of a study at each position.
    assert len(np.unique(rows % (count // 5))) > 0.7 * wanted


def test_few_samples_teach_nothing():
    assert not len(samples_to_learn(RULE.worth * RULE.fewest - 1))


def test_answers_are_those_from_rest_in_fewer_visits(rings, monkeypatch):
    # The same settings are used in both places.
    monkeypatch.setattr(rule_module, "RULE", RULE._replace(taught=TAUGHT, worth=3))
    machine, situations, _, iterate, found = rings
    answers = machine.answer(situations, 1e-9, vectorised.settle, starts=(1,))
    assert found.solved.all()
    assert answers.passed.all()
    assert answers.turns.mean() < found.turns.mean()
    flanks = machine.structure.columns.flanks
    force = np.maximum(iterate.force[:, flanks], 0.0) * machine.structure.force
    # Another start changes an answer by round-off.
    assert np.abs(answers.equilibria.flank_force - force).max() <= 1e-12 * force.max()


def test_numbers_that_do_not_vary_teach_nothing(rings):
    machine, situations, *_ = rings
    loading = loading_of(machine.structure, situations.take(np.zeros(TAUGHT, dtype=np.intp)))
    states = np.zeros((TAUGHT, machine.structure.switches), dtype=np.int8)
    states[::2, 0] = 1
    rule = rule_of(machine.structure, loading, states, at_rest(machine.structure, loading))
    # All start on the set that was met most often; of two equally frequent ones, on the first.
    assert (rule.named(loading)[0] == 0).all()


@pytest.mark.parametrize(
    ("engine", "law"),
    [
        *((compiled.settle, law) for law in (ROLLERS, SPRING, RIGID)),
        (vectorised.settle, SPRING),
        # They take many visits without compiled code.
        *(pytest.param(vectorised.settle, law, marks=pytest.mark.slow) for law in (ROLLERS, RIGID)),
    ],
)
def test_floats_begin_on_the_walls_that_hold_them(engine, law):
    """From rest, a float needs one visit for every wall that it drifts to."""
    case = planets_in_bearings(**law)
    samples = {
        "operating.torque [N*m]": np.linspace(500.0, 1500.0, COUNT),
        "errors.planet2.pin.radial [um]": 20.0 * np.sin(np.arange(COUNT)),
    }
    ((_, group),) = samples_of(case, samples)
    machine, situations = Machine(group.train), group.situations(1)
    alone = machine.answer(situations, 1e-9, engine)
    begun = machine.answer(situations, 1e-9, engine, starts=(1,))
    assert alone.passed.all()
    assert begun.passed.all()
    assert begun.turns.mean() < 1.2 < 5.0 <= alone.turns.mean()
    one, other = alone.equilibria.flank_force, begun.equilibria.flank_force
    assert np.abs(one - other).max() <= 1e-12 * one.max()
