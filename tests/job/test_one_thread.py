"""BLAS works with one thread during a batch, and as before afterwards."""

from __future__ import annotations

from threadpoolctl import threadpool_info, threadpool_limits

from loadshare.job.one_thread import one_thread


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
