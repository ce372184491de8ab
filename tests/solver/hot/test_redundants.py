"""Redundants of the compiled kernel: the same statics, with few non-zero entries."""

from __future__ import annotations

import numpy as np
import pytest

import loadshare as ls
from benchmarks import families
from loadshare.scene.statics import Basis
from loadshare.scene.structure import structure_of
from loadshare.solver.hot.kernel.redundants import eliminated, local
from loadshare.train import build_train


def _statics(branches: int) -> Basis:
    """Return the basis with every possible flank and stop acting."""
    structure = structure_of(build_train(ls.Case(families.split_torque(branches).to_dict())))
    states = np.zeros(structure.switches, dtype=np.int8)
    states[: structure.flat] = 1
    return structure.basis(states)


@pytest.mark.parametrize("branches", [2, 4, 12, 32])
def test_statics_are_the_same(branches):
    basis = _statics(branches)
    particular, n = local(basis)
    unit = np.eye(basis.directions.shape[1])
    held = unit - basis.loose @ basis.loose.T
    assert basis.directions.T @ particular @ held == pytest.approx(held, abs=1e-12)
    assert basis.directions.T @ n == pytest.approx(np.zeros((len(unit), n.shape[1])), abs=1e-12)
    assert np.linalg.matrix_rank(n) == n.shape[1] == basis.redundant.shape[1]


@pytest.mark.parametrize("branches", [2, 4, 12, 32])
def test_the_factor_is_zero_where_it_is_said_to_be(branches):
    _, n = local(_statics(branches))
    n, factor = eliminated(n, n[:0], 2)
    compliance = np.random.default_rng(1).uniform(1.0, 2.0, len(n))
    there = np.linalg.cholesky(n.T * compliance @ n)
    r = n.shape[1]
    allowed = np.zeros((r, r), dtype=bool)
    rows, columns = factor.rows, factor.columns
    allowed[rows, columns] = True
    assert not there[~allowed].any()
    full = [factor.below[factor.starts[c] : factor.starts[c + 1]][-2:] for c in range(r)]
    assert all(rows.tolist() == [r, r + 1] for rows in full)


@pytest.mark.parametrize("branches", [16, 32, 64, 128])
@pytest.mark.quick(2)
def test_entries_of_the_factor_grow_with_the_branches_alone(branches):
    _, n = local(_statics(branches))
    assert len(eliminated(n, n[:0], 0)[1].rows) < 4 * branches
