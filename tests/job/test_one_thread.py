"""BLAS uses one thread while contacts are solved, and its former number afterwards."""

from __future__ import annotations

from tests.support import shipped
from threadpoolctl import threadpool_info, threadpool_limits

import loadshare as ls
from loadshare.one_thread import one_thread
from loadshare.solver import solve_scene


def _threads() -> dict[str, int]:
    return {
        pool["filepath"]: pool["num_threads"]
        for pool in threadpool_info()
        if pool["user_api"] == "blas"
    }


def test_batches_that_overlap_leave_blas_as_it_was() -> None:
    with threadpool_limits(2, "blas"):
        before, (first, second) = _threads(), (one_thread(), one_thread())
        first.__enter__()
        second.__enter__()
        assert {*_threads().values()} == {1}
        first.__exit__(None, None, None)
        assert {*_threads().values()} == {1}
        second.__exit__(None, None, None)
        assert _threads() == before


def test_hard_cases_and_marches_have_one_thread(monkeypatch) -> None:
    seen = []

    def solved(*given, **more):
        seen.append({*_threads().values()})
        return solve_scene(*given, **more)

    monkeypatch.setattr("loadshare.job.ladder.solve_scene", solved)
    monkeypatch.setattr("loadshare.study.memory.held.solve_scene", solved)
    with threadpool_limits(2, "blas"):
        before = _threads()
        ls.solve(shipped("fgfbstts/limit_ring"), positions=[1], solver="clarabel")
        ls.march(shipped("fgfbstts/spline_clearance"), gear="4", revolutions=0.1, steps=1)
        # Libraries may load a BLAS of their own when they are imported.
        after = {name: threads for name, threads in _threads().items() if name in before}
    assert len(seen) >= 2
    assert all(threads == {1} for threads in seen)
    assert after == before
    # Some may have been built for a single thread.
    assert 2 in before.values()
