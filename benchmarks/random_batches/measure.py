"""A random train with many samples, timed and compared with single solves."""

from __future__ import annotations

import re
import time
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

import loadshare as ls
from benchmarks.random_trains.draw import draw
from benchmarks.random_trains.layouts import LAYOUTS
from benchmarks.random_trains.planetary import LOOPS, PLANETARY
from loadshare.case import Case
from loadshare.study.sensitivity.inputs import inputs_of

Samples = Mapping[str, NDArray[np.float64]]

COUNTS = (20, 100, 400)
"""Numbers of samples, of which the largest is measured that does not take too long."""
LONGEST = 20.0
"""Processor time [s] that the next number of samples may take, judged by the one before."""
SCATTER = 0.1
"""Largest change of an input, in parts of its value."""
COMPARED = 3
"""Samples that are also solved by themselves."""
VARIED = re.compile(
    r"operating\.(torque|external\.\w+)"
    r"|errors\.\w+\.(installation(\.amount|\[\d\])?|eccentricity\.amount)"
    r"|(rings|bearings)\.\w+\.(clearance|radius|float(\.\w+)?|(ball_|roller_)?stiffness)"
    r"|splines\.\w+\.clearance"
    r'|meshes\."[^"]+"\.(stiffness|gap|law\.[bc]|(normal_)?backlash)'
    r'|shafts\."[^"]+"\.(stiffness|clocking)'
)
"""Inputs that vary from sample to sample: loads, errors, clearances, gaps, stiffnesses."""


def measured(seed: int, number: int) -> dict[str, Any]:
    """Measure the batch of a random train; plain data.

    Returns
    -------
    dict
        "train"; and if the train itself has an answer: "equilibria", "certified", "microseconds" of
        processor time per equilibrium of a batch that was solved before, and "apart", the largest
        difference of a torque from that of a single solve, over the largest torque.
    """
    case = draw(seed, number, LAYOUTS | PLANETARY | LOOPS)
    try:
        ls.solve(case)
    except (ls.CaseError, ls.Refused):
        return {"train": case.name}
    samples = samples_of(case, seed, number)
    for count, following in pairwise((*COUNTS, COUNTS[-1])):
        found, each = _timed(case, {key: values[:count] for key, values in samples.items()})
        if 1e-6 * each * found.certified.size * following / count > LONGEST:
            break
    return {
        "train": case.name,
        "equilibria": int(found.certified.size),
        "certified": int(found.certified.sum()),
        "microseconds": each,
        "apart": max(_apart(case, samples, found, k) for k in range(COMPARED)),
    }


def _timed(case: Case, samples: Samples) -> tuple[Any, float]:
    """Solve samples twice; return the result, and the second time over equilibria [µs]."""
    ls.solve_many(case, samples, engine="compiled")
    start = time.process_time()
    found = ls.solve_many(case, samples, engine="compiled")
    return found, 1e6 * (time.process_time() - start) / found.certified.size


def samples_of(case: Case, seed: int, number: int) -> Samples:
    """Return samples in which every input varies that `VARIED` names."""
    dice = np.random.default_rng([seed, number])
    return {
        f"{item.key} [{item.value.unit}]": item.value.number
        * dice.uniform(1.0 - SCATTER, 1.0 + SCATTER, COUNTS[-1])
        for item in inputs_of(case, None)
        if VARIED.fullmatch(item.key)
    }


def _apart(case: Case, samples: Samples, found: Any, sample: int) -> float:
    """Return how far the torques of a sample are from those of a single solve."""
    changes = {}
    for key, values in samples.items():
        name, unit = key[:-1].rsplit(" [", 1)
        changes[name] = f"{float(values[sample])!r} {unit}"
    try:
        alone = ls.solve(case.replace(changes))
    except ls.Refused:
        return 0.0
    apart = 0.0
    for position in alone.positions:
        here = found.torque.sel(position=position.position)[sample]
        largest = max(map(abs, position.torque.values()))
        # What the batch refuses and a single solve answers is as far apart as can be.
        differences = [abs(float(here.sel(mesh=m)) - t) for m, t in position.torque.items()]
        apart = max([apart, *(np.inf if np.isnan(d) else d / largest for d in differences)])
    return apart
