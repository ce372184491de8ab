"""Memory of a block is kept for the next one (glibc).

Blocks fill and drop arrays of some MiB each. Above a threshold glibc hands what is given back to
the system at once; to fetch it anew, page by page, took a tenth of a batch. The threshold rises to
the largest array that was ever given back, up to 32 MiB, and it keeps twice as much (mallopt(3),
M_MMAP_THRESHOLD).
"""

from __future__ import annotations

from functools import cache

import numpy as np

LARGEST = (32 << 20) - (64 << 10)
"""Bytes just below the largest threshold."""


@cache
def keep_freed_memory() -> None:
    """Raise glibc's threshold; the array is never written and so takes no memory."""
    np.empty(LARGEST, dtype=np.int8)
