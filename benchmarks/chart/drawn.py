"""Batches of random trains, for how fast trains are that nobody chose."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

import loadshare as ls
from benchmarks.random_trains.draw import draw
from benchmarks.random_trains.layouts import LAYOUTS
from benchmarks.random_trains.planetary import LOOPS, PLANETARY
from loadshare.case import Case
from loadshare.study.sensitivity.inputs import inputs_of

SEED = 20
TRAINS, SAMPLES = 300, 400
SCATTER = 0.1
"""By which part of its value an input varies to either side."""
VARIED = re.compile(
    r"operating\.(torque|external\.\w+)"
    r"|errors\.\w+\.(installation(\.amount|\[\d\])?|eccentricity\.amount)"
    r"|(rings|bearings)\.\w+\.(clearance|radius|float(\.\w+)?|stiffness)"
    r"|splines\.\w+\.(clearance|friction_force|bending_stiffness)"
    r'|meshes\."[^"]+"\.(stiffness|gap|law\.[bc]|(normal_)?backlash)'
    r'|shafts\."[^"]+"\.(stiffness|clocking)'
)
"""Inputs that vary: loads, errors, clearances, gaps, stiffnesses."""


def drawn(count: int, tell: Callable[[str], None]) -> list[dict[str, Any]]:
    """Measure batches of so many random trains; trains without an answer are left out.

    Parameters
    ----------
    count : int
    tell : callable
        Called with what is being measured.

    Returns
    -------
    list of dict
        "train", "microseconds" (of the processor, an equilibrium of a batch solved before),
        "equilibria", "certified".
    """
    layouts = LAYOUTS | PLANETARY | LOOPS
    found = []
    for number in range(count):
        if number % 50 == 0:
            tell(f"random trains: {number} of {count}")
        case = draw(SEED, number, layouts)
        try:
            ls.solve(case)
        except (ls.CaseError, ls.Refused):
            continue
        found.append(measured(case, samples_of(case, number)))
    return found


def samples_of(case: Case, number: int) -> dict[str, NDArray[np.float64]]:
    """Return samples in which every input varies that `VARIED` names."""
    dice = np.random.default_rng([SEED, number])
    return {
        f"{item.key} [{item.value.unit}]": item.value.number
        * dice.uniform(1.0 - SCATTER, 1.0 + SCATTER, SAMPLES)
        for item in inputs_of(case, None)
        if VARIED.fullmatch(item.key)
    }


def measured(case: Case, samples: Mapping[str, NDArray[np.float64]]) -> dict[str, Any]:
    """Solve samples twice, and time the second run."""
    ls.solve_many(case, samples, engine="compiled")
    start = time.process_time()
    found = ls.solve_many(case, samples, engine="compiled")
    seconds, size = time.process_time() - start, found.certified.size
    return {
        "train": case.name,
        "microseconds": 1e6 * seconds / size,
        "equilibria": size,
        "certified": int(found.certified.sum()),
    }
