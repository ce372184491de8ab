"""BLAS works with one thread while contacts are solved.

Its matrices are small. Threads of BLAS would take the time of those that solve blocks (a third of a
batch on two cores), wait for one another where another program works as well (eigenvalues of forty
unknowns take ten milliseconds in place of a fifth of one), and would let sums round differently
from one machine to the next.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

_lock = threading.Lock()
_asking: list[object] = []
_limits: list[Any] = []


@lru_cache(maxsize=1)
def _libraries(_modules: int) -> Any:
    """Return the libraries of this process; to find them takes as long as many samples."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS to one thread until the last of all that asks for it in this process has ended."""
    asking = object()
    with _lock:
        if not _asking:
            # Another library comes with another module.
            _limits.append(_libraries(len(sys.modules)).limit(limits=1, user_api="blas"))
        _asking.append(asking)
    try:
        yield
    finally:
        with _lock:
            _asking.remove(asking)
            if not _asking:
                _limits.pop().restore_original_limits()
