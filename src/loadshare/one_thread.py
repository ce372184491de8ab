"""One thread of BLAS while contacts are solved.

The matrices are small. Threads of BLAS would take time from the threads that solve blocks (a third
of a batch on two cores), would wait for one another while another program is running (eigenvalues
of forty unknowns take ten milliseconds instead of a fifth of one), and would make sums round
differently from one machine to the next.
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
    """Return the libraries of this process; finding them takes as long as solving many samples."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS to one thread until the last such context in this process has ended."""
    asking = object()
    with _lock:
        if not _asking:
            # A further BLAS can only have come with a further module, so their number is the key.
            _limits.append(_libraries(len(sys.modules)).limit(limits=1, user_api="blas"))
        _asking.append(asking)
    try:
        yield
    finally:
        with _lock:
            _asking.remove(asking)
            if not _asking:
                _limits.pop().restore_original_limits()
