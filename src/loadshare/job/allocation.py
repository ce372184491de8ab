"""Memory of a block is kept for the next one (glibc).

Blocks fill and drop a hundred MiB of arrays. glibc hands what is given back to the system at once;
to fetch it again, page by page, took up to a tenth of a batch. How much it keeps for itself is set
by mallopt(3), once in a process.
"""

from __future__ import annotations

import ctypes
import os
from functools import cache

from loadshare.settings import JOB

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""What is set, as <malloc.h> numbers it."""
OWN = "MALLOC_TRIM_THRESHOLD_"
"""Environment variable by which a user says it, who then has the last word."""


@cache
def keep_freed_memory() -> None:
    """Let glibc keep what blocks give back; other C libraries do as they like."""
    if OWN in os.environ:
        return
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):
        return
    mallopt(M_MMAP_THRESHOLD, JOB.allocated)
    mallopt(M_TRIM_THRESHOLD, JOB.kept)
