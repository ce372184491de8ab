"""The vectorised kernel with another array library, of which only the standard is known.

`array_api_strict` is NumPy without anything that the array API standard does not have.
"""

from functools import partial

import array_api_strict as strict
import numpy as np
import pytest
from tests.solver.hot.trains import ROLLERS, VARIED, planets_in_bearings, varied
from tests.support import loaded, shipped

import loadshare as ls
from benchmarks import families
from loadshare.array_library import cube_root, in_places, largest, library_of, put_rows, to_numpy
from loadshare.job.machine import Machine
from loadshare.scene.loading import Loading, loading_of
from loadshare.scene.structure import Structure, structure_of
from loadshare.solver.hot import passes, vectorised
from loadshare.solver.hot.exchange import exchange, first_sets
from loadshare.solver.hot.iterate import at_rest
from loadshare.solver.hot.on_set import OnSet
from loadshare.solver.hot.symmetric import solve
from loadshare.train import build_train
from loadshare.train.samples import samples_of

SAME = 1e-13
CASES = ("fgfbstts/all_elements", "fgfbstts/spline_clearance", "two_path/nasa", "planetary/star")


def posed(case: ls.Case, *positions: int) -> tuple[Structure, Loading]:
    """Return the samples that are a case's positions."""
    machine = Machine(build_train(case))
    return machine.structure, loading_of(machine.structure, machine.situations(positions))


def agree(structure: Structure, loading: Loading, *, singly: bool = False) -> None:
    """Solve samples with NumPy and with the other library, and compare."""
    found = []
    for library in (np, strict):
        iterate = at_rest(structure, loading)
        engine = partial(vectorised.settle, library=library)
        found.append((iterate, exchange(structure, loading, iterate, engine, singly=singly)))
    (iterate, one), (other_iterate, other) = found
    np.testing.assert_array_equal(one.states, other.states)
    np.testing.assert_array_equal(one.solved, other.solved)
    assert one.solved.any()
    for name in ("x", "force", "root"):
        values, others = (getattr(i, name)[one.solved] for i in (iterate, other_iterate))
        assert np.abs(values - others).max() <= SAME * np.abs(values).max()


@pytest.mark.parametrize("name", VARIED)
def test_samples_are_solved_alike(name):
    ((_, group),) = samples_of(*varied(name, 30, seed=3))
    situations = group.situations(1)
    structure = structure_of(situations.train)
    agree(structure, loading_of(structure, situations))


@pytest.mark.parametrize("name", CASES)
def test_shipped_cases_are_solved_alike(name):
    agree(*posed(shipped(name), 1))


def test_walls_that_yield_like_rollers_are_followed_alike():
    agree(*posed(planets_in_bearings(**ROLLERS), 1, 2), singly=True)


def test_nothing_acts_without_a_load():
    agree(*posed(loaded(families.star(3), "0 N*m"), 1))


def test_all_that_passes_change_belongs_to_the_library():
    """Otherwise the tests above would compare NumPy with itself."""
    structure, loading = posed(shipped("fgfbstts/all_elements"), 1)
    (states,) = first_sets(structure, loading)
    iterate = at_rest(structure, loading)
    on = OnSet(structure, loading, states, np.arange(1), iterate, strict)
    passes.run(on, strict.asarray([False]))
    changed = (on.x, on.force, on.compression, on.root, on.z, on.settled, on.gross_to)
    assert all(library_of(array) is strict for array in changed)
    on.store(iterate)
    np.testing.assert_array_equal(iterate.x, to_numpy(on.x))


@pytest.mark.parametrize("library", [np, strict])
def test_singular_systems_are_solved_beside_regular_ones(library):
    matrices = np.array([[[2.0, 1.0], [1.0, 2.0]], [[1.0, 1.0], [1.0, 1.0]], np.zeros((2, 2))])
    sides = np.array([[3.0, 3.0], [2.0, 2.0], [0.0, 0.0]])
    found = to_numpy(solve(library.asarray(matrices), library.asarray(sides), 2))
    np.testing.assert_allclose(found, [[1.0, 1.0], [1.0, 1.0], [0.0, 0.0]], atol=1e-9)


@pytest.mark.parametrize("library", [np, strict])
def test_what_the_standard_lacks(library):
    numbers = library.asarray([[0.0, 8.0, -3.0], [1.0, 2.0, 27.0]])
    np.testing.assert_allclose(to_numpy(cube_root(numbers[1, :])), [1.0, 2.0 ** (1 / 3), 3.0])
    np.testing.assert_array_equal(to_numpy(largest(numbers)), [8.0, 27.0])
    np.testing.assert_array_equal(to_numpy(largest(numbers[:, :0])), [0.0, 0.0])
    place = library.asarray([3, 0, 2, 3])
    np.testing.assert_array_equal(
        to_numpy(in_places(numbers, place)), [[0.0, 0.0, -3.0, 0.0], [0.0, 1.0, 27.0, 0.0]]
    )
    these = library.asarray([False, True])
    put = put_rows(these, numbers[:1, :], numbers)
    np.testing.assert_array_equal(to_numpy(put), [[0.0, 8.0, -3.0], [0.0, 8.0, -3.0]])
