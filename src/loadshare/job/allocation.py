"""Keep the memory of a block for the next one (glibc).

Blocks fill and drop a hundred MiB of arrays. glibc returns freed memory to the system at once;
fetching it again, page by page, took up to a tenth of a batch. mallopt(3), called once in a
process, sets how much glibc keeps.
"""

from __future__ import annotations

import ctypes
import os
from functools import cache

from loadshare.settings import JOB

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3
"""Parameters that are set, with their numbers in <malloc.h>."""
OWN = "MALLOC_TRIM_THRESHOLD_"
"""Environment variable by which users set this themselves; it takes precedence."""


@cache
def keep_freed_memory() -> None:
    """Let glibc keep the memory that blocks free; other C libraries are left alone."""
    if OWN in os.environ:
        return
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):
        return
    mallopt(M_MMAP_THRESHOLD, JOB.allocated)
    mallopt(M_TRIM_THRESHOLD, JOB.kept)
