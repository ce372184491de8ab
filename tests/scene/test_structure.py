"""The force method: statics of active sets, and the numbers that vary between samples.

Source: formulation, section 11. The numbers are compared with the scene of the revised case, which
`assemble` writes independently.
"""

import numpy as np
import pytest
from tests.solver.hot.trains import VARIED, varied
from tests.support import EVERY_SHIPPED, shipped

from benchmarks import families
from loadshare.job.machine import Machine
from loadshare.scene import assemble
from loadshare.scene.loading import loading_of
from loadshare.scene.structure import Structure, structure_of
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.contact_states import graph
from loadshare.solver.hot.exchange import exchange, first_sets
from loadshare.solver.hot.iterate import at_rest
from loadshare.train import build_train
from loadshare.train.samples import samples_of
from loadshare.train.situations import situation_of

DIGITS = 1e-12


def sets(structure: Structure, index: int = 1) -> list[np.ndarray]:
    """Return the first set, all elements, none, and some random sets."""
    first = first_sets(structure, loading_of(structure, situation_of(structure.train, index)))[0]
    rng = np.random.default_rng(structure.switches)
    some = rng.integers(0, 2, (4, structure.switches)).astype(np.int8)
    return [first, np.ones_like(first), np.zeros_like(first), *some]


@pytest.mark.parametrize("name", EVERY_SHIPPED)
def test_the_statics_of_a_set(name):
    """P carries every load that the set can carry, N carries none; together they span all forces,
    and directions that no element resists are loose.
    """
    structure = structure_of(build_train(shipped(name)))
    for states in sets(structure):
        basis = structure.basis(states)
        a, p, n, loose = basis.directions, basis.particular, basis.redundant, basis.loose
        size = structure.size
        resisted = np.eye(size) - loose @ loose.T
        np.testing.assert_allclose(a.T @ p, resisted, atol=DIGITS * np.abs(p).max(initial=1.0))
        np.testing.assert_allclose(a.T @ n, 0.0, atol=DIGITS)
        np.testing.assert_allclose(a @ loose, 0.0, atol=DIGITS)
        np.testing.assert_allclose(n.T @ n, np.eye(n.shape[1]), atol=DIGITS)
        np.testing.assert_allclose(loose.T @ loose, np.eye(loose.shape[1]), atol=DIGITS)
        if len(a):
            expected = np.linalg.pinv(a.T, rcond=1e-10)
            np.testing.assert_allclose(p, expected, atol=1e-9 * np.abs(expected).max())
        assert n.shape[1] == len(a) - (size - loose.shape[1])


@pytest.mark.parametrize("name", EVERY_SHIPPED)
def test_the_elements_are_the_scene(name):
    """Rows and radials agree in name and direction; springs give the scene's stiffness."""
    train = build_train(shipped(name))
    scene = assemble(train, 1)
    structure = structure_of(train)
    rows = scene.rows_at(np.zeros(scene.size))
    assert structure.row_names == tuple(r.name for r in rows)
    assert structure.vectors.shape == (len(structure.kinds), scene.size)
    for k, row in enumerate(rows):
        np.testing.assert_array_equal(structure.vectors[structure.springs + k], row.vector)
    for j, radial in enumerate(scene.radials):
        k = structure.radial_column(j)
        np.testing.assert_array_equal(structure.vectors[k : k + 2], radial.matrix)
    loading = loading_of(structure, situation_of(train, 1))
    springs = structure.vectors[: structure.springs]
    stiffness = 1.0 / loading.bending[0, : structure.springs] * structure.force / structure.length
    whole = springs.T @ (stiffness[:, None] * springs)
    np.testing.assert_allclose(whole, scene.stiffness, rtol=1e-12, atol=1e-6)


@pytest.mark.parametrize(("branches", "redundants"), [(2, 1), (4, 3), (6, 5), (8, 7)])
def test_a_branched_train_has_a_redundant_per_branch_but_one(branches, redundants):
    structure = structure_of(build_train(families.split_torque(branches)))
    assert structure.basis(sets(structure)[0]).redundant.shape[1] == redundants


def test_the_seed_has_three_redundants_and_a_floating_pinion_takes_one():
    """A pinion that floats freely divides its torque equally by itself: one redundant less."""
    counts = {}
    for support in ("rigid", "free"):
        case = shipped("fgfbstts/base").replace({"gears.4.support": support})
        structure = structure_of(build_train(case))
        counts[support] = structure.basis(sets(structure)[0]).redundant.shape[1]
    assert counts == {"rigid": 3, "free": 2}


def test_a_set_is_reduced_once():
    structure = structure_of(build_train(shipped("fgfbstts/all_elements")))
    states = sets(structure)[0]
    again = np.where(states != 0, 3, 0).astype(np.int8)
    assert structure.basis(states) is structure.basis(again), "only what acts matters"


def test_opposed_arcs_are_known_where_neighbours_stand_firm():
    """Ring 4 is on the line between its idlers, so a squeeze would be sham. Elastic ones yield."""
    structure = structure_of(build_train(shipped("fgfbstts/limit_ring")))
    pairs = [tuple(structure.row_names[k] for k in pair) for pair in structure.opposed]
    assert pairs == [
        ("ring 4: arc 7", "ring 4: arc 6"),
        ("ring 5: arc 9", "ring 5: arc 8"),
    ]
    elastic = structure_of(build_train(shipped("fgfbstts/all_elements")))
    assert not elastic.opposed


# --- What varies ---


@pytest.mark.parametrize("name", VARIED)
@pytest.mark.quick(3)
def test_the_numbers_of_a_sample_are_those_of_its_scene(name):
    """Gaps, compliances, loads and radial laws of random samples agree in the elements' units."""
    case, samples = varied(name, 6, seed=7)
    ((_, group),) = samples_of(case, samples)
    structure = Machine(group.train).structure
    force, length = structure.force, structure.length
    for index in sorted({1, group.train.count}):
        loading = loading_of(structure, group.situations(index))
        assert loading.count == 6
        for sample in range(6):
            scene = assemble(build_train(group.one(sample)), index)

            def of(array: np.ndarray, sample: int = sample) -> np.ndarray:
                return array[sample if len(array) > 1 else 0]

            gap, bending, hertz = of(loading.gap), of(loading.bending), of(loading.hertz)
            springs = structure.vectors[: structure.springs]
            preset = springs.T @ (gap[: structure.springs] / bending[: structure.springs])
            load = (of(loading.load) + preset) * force
            push = np.abs(scene.load).max(initial=1.0)
            np.testing.assert_allclose(load, scene.load, atol=DIGITS * push)
            fixed = len(scene.rows)
            for k, row in enumerate(scene.rows_at(np.zeros(scene.size))):
                column = structure.springs + k
                probe = 0.7 * scene.force_unit()
                scaled = probe / force
                if loading.tabulated[column] >= 0:
                    forces, bends = of(loading.tables)[loading.tabulated[column]]
                    compression = np.interp(scaled, forces, bends)
                    probe = min(probe, np.nanmax(forces) * force)
                else:
                    compression = bending[column] * scaled + hertz[column] * np.cbrt(scaled) ** 2
                expected = row.law.compression(probe)
                assert compression * length == pytest.approx(expected, rel=DIGITS, abs=1e-20)
                if k < fixed:
                    assert gap[column] * length == pytest.approx(row.gap, rel=DIGITS, abs=1e-18)
            for a, arc in enumerate(scene.arcs):
                start = (loading.nominal[a] + of(loading.shift)[a]) * length
                np.testing.assert_allclose(start, arc.arc.start, rtol=DIGITS, atol=1e-15)
                assert of(loading.clearance)[a] * length == pytest.approx(arc.arc.clearance)
                np.testing.assert_array_equal(loading.relative[a], arc.relative)
            for j, radial in enumerate(scene.radials):
                torque = 123.0
                law = radial.law(torque)
                single = graph(of(loading.radial)[None, j], np.array([torque / force]))
                ends = [p.length for p in law.pieces if np.isfinite(p.length)]
                if law.pieces[-1].name == "stick":
                    assert np.isinf(single.stick[0])
                else:
                    reach = float(single.reach[0]) * length
                    assert reach == pytest.approx(sum(ends), rel=DIGITS, abs=1e-18)
                column = structure.radial_column(j)
                np.testing.assert_allclose(
                    gap[column : column + 2] * length, radial.centre, atol=1e-18
                )


@pytest.mark.parametrize(
    "name", ["fgfbstts/both_errors", "star/floating_sun_4", "two_path/clocking_error"]
)
def test_an_answer_is_in_balance_and_compatible(name):
    """Aᵀ μ = f, Nᵀ (g + δ) = 0 and x = Pᵀ (g + δ), if all laws are linear."""
    train = build_train(shipped(name))
    structure = structure_of(train)
    loading = loading_of(structure, situation_of(train, 1))
    state = at_rest(structure, loading)
    found = exchange(structure, loading, state, vectorised.settle)
    assert found.solved.all()
    basis = structure.basis(found.states[0])
    acting = basis.columns
    forces = state.force[0, acting]
    closing = loading.gap[0, acting] + loading.bending[0, acting] * forces
    size = np.abs(closing).max()
    push = np.abs(loading.load).max()
    np.testing.assert_allclose(basis.directions.T @ forces, loading.load[0], atol=DIGITS * push)
    np.testing.assert_allclose(basis.redundant.T @ closing, 0.0, atol=DIGITS * size)
    np.testing.assert_allclose(state.x[0], basis.particular.T @ closing, atol=1e-10 * size)
