"""BLAS works with one thread while a batch is solved.

Its matrices are small: threads of BLAS would take the time of those that solve blocks (a third of a
batch on two cores), and would let sums round differently from one machine to the next.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

_lock = threading.Lock()
_batches: list[object] = []
_limits: list[Any] = []


@lru_cache(maxsize=1)
def _libraries(_modules: int) -> Any:
    """Return the libraries of this process; to find them takes as long as many samples."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS to one thread until the last of all batches of this process has ended."""
    batch = object()
    with _lock:
        if not _batches:
            # Another library comes with another module.
            _limits.append(_libraries(len(sys.modules)).limit(limits=1, user_api="blas"))
        _batches.append(batch)
    try:
        yield
    finally:
        with _lock:
            _batches.remove(batch)
            if not _batches:
                _limits.pop().restore_original_limits()
