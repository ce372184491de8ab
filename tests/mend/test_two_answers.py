"""A case in which the exclusion arc's inequality holds on both sides of a neighbour.

The fast method once moved past the neighbour and found no load on the branch; the whole scene did
not. Both answers passed. All methods must now find the place on the pinion's own side, and refuse
it because of its displacement.
"""

from pathlib import Path

import pytest

import loadshare as ls
from loadshare.certify import certify
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.scene import assemble
from loadshare.solver import Options, solve_scene
from loadshare.train import build_train
from loadshare.train.situations import situation_of

HERE = Path(__file__).parent
CASES = ("two_answers", "two_answers_base")


def train_of(name):
    return build_train(ls.load_case(HERE / f"{name}.toml"))


def on_its_own_side(train, answer):
    (ring,) = train.drums
    for side, neighbour in enumerate(ring.neighbours):
        arc = situation_of(train, 1).arc(ring, side)
        assert not arc.beyond(answer.displacement[ring.gear] - answer.displacement[neighbour])


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
def test_the_hot_path_and_the_whole_scene_agree(name, engine):
    train = train_of(name)
    whole, _ = solve_scene(assemble(train, 1), Options(reduce=False))
    assert certify(train, whole).passed
    machine = Machine(train)
    found = machine.answer(machine.situations([1]), 1e-9, engine_named(engine, 1))
    assert found.passed.all()
    hot = found.equilibria.one(0, 1)
    largest = max(whole.flank_force.values())
    for flank, force in whole.flank_force.items():
        assert hot.flank_force[flank] == pytest.approx(force, rel=1e-8, abs=1e-9 * largest)
    on_its_own_side(train, whole)
    on_its_own_side(train, hot)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("reduce", [True, False])
def test_its_displacement_is_refused(name, reduce):
    """Teeth yield by more than their height: answers of linearised geometry are meaningless."""
    with pytest.raises(ls.Refused, match="displacements are too large") as refused:
        ls.solve(HERE / f"{name}.toml", reduce=reduce)
    assert refused.value.figures["compression"] > 10.0


def test_samples_side_by_side_agree():
    """Three hundred equal samples are solved by the compiled engine."""
    train = train_of("two_answers")
    machine = Machine(train)
    one = machine.answer(machine.situations([1]), 1e-9, engine_named("vectorised", 1))
    many = machine.answer(machine.situations([1] * 300), 1e-9, engine_named("compiled", 300))
    assert many.passed.all()
    assert many.equilibria.flank_force == pytest.approx(
        one.equilibria.flank_force.repeat(300, axis=0), rel=1e-8, abs=1e-3
    )
