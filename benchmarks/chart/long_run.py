"""A million equilibria in bounded memory, in a separate process so that the peak is its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np

from benchmarks.workloads import Workload

EQUILIBRIA = 1_000_000
CHUNK = 50_000

PROGRAMME = """
import json, resource, sys, time
import numpy as np
import loadshare as ls
from loadshare.case import Case
given = json.load(sys.stdin)
case = Case(given["case"], name="long run")
generator, done, start, certified = np.random.default_rng(1), 0, time.perf_counter(), 0
while done < given["count"]:
    size = min(given["chunk"], given["count"] - done)
    samples = {k: generator.uniform(a, b, size) for k, (a, b) in given["limits"].items()}
    found = ls.solve_many(case, samples, positions=[1], keep=("torque",))
    certified += int(found.certified.values.sum())
    done += size
try:
    with open("/proc/self/status") as status:
        (peak,) = (float(line.split()[1]) / 1024.0 for line in status if line.startswith("VmHWM"))
except OSError:
    # It includes the process that started this one, if that was larger.
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
print(json.dumps({"equilibria": certified, "seconds": time.perf_counter() - start, "MiB": peak}))
"""


def long_run(workload: Workload, count: int = EQUILIBRIA) -> dict[str, float]:
    """Solve very many samples of a workload; return their number, the time and the peak of memory.

    Parameters
    ----------
    workload : Workload
    count : int

    Returns
    -------
    dict of str to float
        "equilibria" (certified), "seconds", "MiB"; empty where it took longer than allowed.
    """
    limits = {k: [float(np.min(v)), float(np.max(v))] for k, v in workload.samples.items()}
    given = {
        "case": workload.case.to_dict(),
        "limits": limits,
        "count": count,
        "chunk": CHUNK,
    }
    try:
        run = subprocess.run(
            [sys.executable, "-c", PROGRAMME],
            input=json.dumps(given),
            capture_output=True,
            text=True,
            check=True,
            timeout=240.0,
            env=dict(os.environ),
        )
    except subprocess.TimeoutExpired:
        return {}
    found: dict[str, float] = json.loads(run.stdout)
    return found
