"""Memory that a block frees is kept for the next one."""

import os
import platform
import subprocess
import sys

import pytest
from tests.support import CASES

SCRIPT = f"""
import resource, numpy as np, loadshare as ls
from loadshare.job import allocation
case = {str(CASES / "fgfbstts" / "limit_ring.toml")!r}
floats = {{f"rings.{{g}}.float [um]": np.linspace(4.0, 8.0, 3000) for g in "45"}}
faults = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_minflt
counts = []
for _ in range(3):
    before = faults()
    ls.solve_many(case, floats, keep=(), positions=[1], engine="vectorised", workers=1)
    counts.append(faults() - before)
print(counts[-1])
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library")
@pytest.mark.slow
def test_pages_are_not_fetched_anew():
    """A repeated batch reuses its memory."""

    def pages(**environment: str) -> int:
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            check=True,
            timeout=300,
        )
        return int(done.stdout)

    assert pages() * 10 < pages(MALLOC_TRIM_THRESHOLD_="131072")
