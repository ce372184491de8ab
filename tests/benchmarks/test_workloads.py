"""The workloads of the speed chart: every one can be built, and its samples have answers."""

from pathlib import Path

import pytest

import loadshare as ls
from benchmarks.workloads import branches, workloads

CASES = Path(__file__).parents[2] / "cases"


@pytest.mark.parametrize(
    "workload", [*workloads(CASES, quick=True), *branches(quick=True)[:2]], ids=lambda w: w.name
)
def test_samples_are_certified(workload):
    found = ls.solve_many(workload.case, workload.some(20), positions=[1], engine="vectorised")
    assert found.certified.all()
