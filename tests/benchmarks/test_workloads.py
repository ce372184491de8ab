"""The workloads of the speed chart: each can be built, and its samples have answers."""

from pathlib import Path

import loadshare as ls
from benchmarks.random_batches.__main__ import text
from benchmarks.random_batches.measure import measured
from benchmarks.workloads import branches, workloads

CASES = Path(__file__).parents[2] / "cases"


def test_samples_are_certified():
    """All are in one test: as parameters, every worker would build them."""
    for workload in (*workloads(CASES, quick=True), *branches(quick=True)[:2]):
        found = ls.solve_many(workload.case, workload.some(20), positions=[1], engine="vectorised")
        assert found.certified.all(), workload.name


def test_a_random_batch_agrees_with_single_solves():
    found = measured(20, 1)
    assert found["certified"] == found["equilibria"] > 0
    assert found["apart"] < 1e-9
    assert "| all trains |" in text([found, {"train": "without an answer"}])
