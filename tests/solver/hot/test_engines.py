"""NumPy for all samples of a set, Numba for samples side by side: both do the same passes.

Each checks the other, because every formula is in both. The number of passes may differ, because
NumPy ends when the last sample of a set has settled; so they differ by round-off, and 1e-12 of the
largest figure is required. The acting elements are the same, except those with neither force nor
gap: whether they count depends on the path.
"""

import numpy as np
import pytest
from hypothesis import given, note, settings
from hypothesis import strategies as st
from tests.physics.test_random_trains import split_torques, stars
from tests.reproducible import TRAINS, examples
from tests.solver.hot.trains import ROLLERS, VARIED, planets_in_bearings, varied
from tests.support import EVERY_SHIPPED, mostly_slow, shipped

import loadshare as ls
from loadshare.job.engines import engine_named
from loadshare.job.machine import Answers, Machine
from loadshare.job.table import KEPT
from loadshare.scene.loading import loading_of
from loadshare.settings import CERTIFY, JOB, SIDE_BY_SIDE
from loadshare.solver.hot import compiled, radials, vectorised
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot.exchange import exchange
from loadshare.solver.hot.iterate import at_rest
from loadshare.solver.hot.kernel.signs import right_state
from loadshare.train import build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.samples import samples_of
from loadshare.train.situations import Situations

SAME = 1e-12


def apart(one: np.ndarray, other: np.ndarray) -> float:
    """Return the largest difference in a sample over its largest figure."""
    if not one.size:
        return 0.0
    one, other = (v.reshape(len(v), -1) for v in (one, other))
    size = np.abs(one).max(axis=1)
    return float((np.abs(one - other).max(axis=1) / np.where(size > 0.0, size, 1.0)).max())


def forces(machine: Machine, found: Equilibria) -> np.ndarray:
    """Return all forces (S, forces) [N], torques of shafts at the smallest base circle."""
    radius = min(g.base_radius for g in machine.train.gears.values())
    every = (
        found.flank_force,
        found.ring_force,
        found.radial_reaction,
        found.support_force,
        found.shaft_torque / radius,
    )
    return np.concatenate([v.reshape(len(v), -1) for v in every], axis=1)


def moves(machine: Machine, found: Equilibria) -> np.ndarray:
    """Return all displacements (S, moves) [m], rotations at the base circle."""
    radius = [g.base_radius for g in machine.train.gears.values()]
    turned = found.rotation * radius
    return np.concatenate([turned, found.displacement.reshape(len(turned), -1)], axis=1)


def contact_forces(machine: Machine, found: Answers) -> np.ndarray:
    """Return the force of every switch [N], (S, switches); radial elements count as carrying."""
    rows = np.concatenate([found.equilibria.flank_force, found.equilibria.ring_force], axis=1)
    radials = machine.structure.switches - machine.structure.rows
    return np.pad(rows, ((0, 0), (0, radials)), constant_values=np.nan)


def few_abreast(*given):
    """Solve eight at a time, so that samples wait, and slow ones start again beside each other."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "SIDE_BY_SIDE", SIDE_BY_SIDE._replace(widest=8))
        return compiled.settle(*given)


def alone(*given):
    """Solve every sample alone."""
    structure, loading, sets, parts, *state = given
    each = np.repeat(sets, [len(part) for part in parts], axis=0)
    return compiled.settle(structure, loading, each, np.concatenate(parts)[:, None], *state)


def agree(machine: Machine, situations: Situations) -> Answers:
    """Check that all engines certify the same samples, with the same elements and figures."""
    one, *others = (
        machine.answer(situations, CERTIFY.tolerance, engine)
        for engine in (vectorised.settle, compiled.settle, few_abreast, alone)
    )
    for other in others:
        same(machine, one, other)
    return one


def same(machine: Machine, one: Answers, other: Answers) -> None:
    """Check that two engines agree on what they certify."""
    assert one.passed.tolist() == other.passed.tolist()
    rows = one.passed
    apart_at = np.argwhere(one.states[rows] != other.states[rows])
    for found in (one, other):
        pushes = contact_forces(machine, found)[rows]
        largest = np.nanmax(np.abs(pushes), axis=1, initial=0.0)
        idle = np.abs(pushes) <= SAME * largest[:, None]
        assert all(idle[sample, switch] for sample, switch in apart_at), "other elements act"
    assert one.determined[rows].tolist() == other.determined[rows].tolist()
    determined = rows & one.determined
    for figures, these in ((forces, rows), (moves, determined)):
        mine, others = (figures(machine, a.equilibria)[these] for a in (one, other))
        assert apart(mine, others) < SAME, figures.__name__


@pytest.mark.parametrize("name", EVERY_SHIPPED)
@pytest.mark.quick(12)
def test_every_position_of_a_shipped_case(name):
    machine = Machine(build_train(shipped(name)))
    found = agree(machine, machine.situations(range(1, machine.train.count + 1)))
    assert found.passed.all()


@pytest.mark.parametrize("name", VARIED)
@pytest.mark.quick(3)
def test_random_samples(name):
    """Samples of every position; nearly all of them are solved by the fast method."""
    case, samples = varied(name, 40)
    ((_, group),) = samples_of(case, samples)
    machine = Machine(group.train)
    sets, passed = set(), []
    for index in range(1, min(group.train.count, 2) + 1):
        found = agree(machine, group.situations(index))
        passed += found.passed.tolist()
        sets |= {states.tobytes() for states in found.states}
    assert np.mean(passed) >= 0.9, name
    assert len(sets) > 1 or name in ("errors", "tables"), "nothing opened or closed"


@pytest.mark.parametrize(
    "family", mostly_slow((stars, split_torques), (stars,)), ids=["star", "split torque"]
)
def test_random_trains(family):
    @settings(TRAINS, max_examples=examples(10, 30))
    @given(family())
    def run(case: ls.Case) -> None:
        note(case.to_toml())
        machine = Machine(build_train(case))
        agree(machine, machine.situations([1]))

    run()


@settings(TRAINS, max_examples=200)
@given(st.data())
def test_radial_elements_move_alike_from_place_to_place(data):
    """This holds for any law, offset and force, on corners and off them."""
    length = st.sampled_from([0.0, 1.0, 1.0 + 1e-13, 2.0, 3.0])
    stick, level = data.draw(length), data.draw(length)
    first = data.draw(st.sampled_from([0.0, 1.0])) if stick == 0.0 else 1.0
    bound = first * stick * data.draw(st.sampled_from([1.0, 1.5])) + (stick == 0.0) * first
    last = data.draw(st.sampled_from([1.0, np.inf])) if first == 0.0 else first
    law = (first, stick, bound, stick + level, last, True)
    places = [at.OPEN, at.STICK, at.CORNER, at.PINNED, at.SLIP, at.STOP, at.WALL]
    place = data.draw(st.sampled_from(places))
    u, p = data.draw(length), data.draw(length) * data.draw(st.sampled_from([-1.0, 1.0]))
    graph = at.Graph(*(np.array([v]) for v in law))
    bands = (np.array([1e-12]),) * 3
    offset, force = np.array([[0.6 * u, 0.8 * u]]), np.array([[0.6 * p, 0.8 * p]])
    wrong, moved = radials.right_state(place, graph, offset, force, *bands)
    other = right_state.py_func(place, law, *offset[0], *force[0], 1e-12, 1e-12, 1e-12)
    assert other == (moved[0] if wrong[0] else place)


def test_planets_come_to_rest_in_their_roller_bearings_one_after_another():
    """The end of a drift is found once the walls before it are pressed in."""
    machine = Machine(build_train(planets_in_bearings(**ROLLERS)))
    loading = loading_of(machine.structure, machine.situations([1, 2, 3]))
    start = at_rest(machine.structure, loading)
    assert exchange(machine.structure, loading, start, compiled.settle).solved.all()
    agree(machine, machine.situations([1, 2, 3]))


def test_solve_many_with_either_engine():
    """This includes the name "auto", which compiles from a few thousand equilibria on."""
    case, samples = varied("drums", 60, seed=5)
    one, other = (
        ls.solve_many(case, samples, positions=[2], keep=KEPT, engine=engine)
        for engine in ("vectorised", "compiled")
    )
    for name in ("torque", "contact_force", "displacement"):
        assert apart(one[name].values, other[name].values) < SAME
    for name in ("certified", "determined", "rung"):
        np.testing.assert_array_equal(one[name], other[name])
    assert engine_named("vectorised", 10**6) is engine_named("auto", JOB.few) is vectorised.settle
    assert engine_named("compiled", 1) is engine_named("auto", JOB.few + 1) is compiled.settle
    with pytest.raises(ValueError, match="auto, compiled, vectorised"):
        engine_named("fast", 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIED)
def test_many_random_samples(name):
    case, samples = varied(name, 2000, seed=1)
    ((_, group),) = samples_of(case, samples)
    machine = Machine(group.train)
    assert agree(machine, group.situations(1)).passed.mean() >= 0.9
