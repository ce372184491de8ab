"""Trains of cases that differ in numbers only: elements that are unchanged are not built again."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from loadshare.case import Case, Gear, Operating
from loadshare.case.content import ABOUT
from loadshare.case.power_flow import has_sets
from loadshare.case.quantity import NUMBER
from loadshare.train.array_keys import array_unit
from loadshare.train.build import train_of
from loadshare.train.columns import Column
from loadshare.train.geometry import Geometry
from loadshare.train.pressed import pressed_flanks
from loadshare.train.train import Train

_NUMBER = re.compile(NUMBER)


def train_alike(case: Case, base: tuple[Case, Geometry, Train]) -> Train | None:
    """Return the train of a case, built from that of an earlier case; None if that is impossible.

    It is possible if the cases differ only in numbers that become arrays in a table of samples (see
    `array_keys`) and the loads press the same flanks: the geometry is then the same.

    Parameters
    ----------
    case : Case
    base : (Case, Geometry, Train)
        The earlier case with its mesh laws resolved, its geometry and its train.

    Raises
    ------
    CaseError
        As `build_train`.
    """
    if any([*getattr(case, n)] != [*getattr(base[0], n)] for n in ("gears", "meshes", "shafts")):
        # The order of the elements is also that of the results.
        return None
    differences = list(case.differences(base[0]))
    for path, before, after in differences:
        if path[0] in ABOUT:
            continue
        numbers = [_number(value) for value in (before, after)]
        if None in numbers:
            return None
        if array_unit(case, Column(path, "", np.array(numbers, dtype=float))) is None:
            return None
    loaded = any(path[0] == "operating" for path, _, _ in differences)
    if loaded and not _runs_alike(case.operating, base[0].operating, case.gears):
        found = pressed_flanks(case, base[1].gears, base[1].period)
        pairs = base[1].pairs.items()
        if any(
            [bool(f) for f in found[n]] != [pair.named_backwards, pair.flank_uncertain]
            for n, pair in pairs
        ):
            return None
    changed = {path[:2] for path, _, _ in differences}
    return train_of(case, base[1], (base[0], base[2]), changed)


def _runs_alike(now: Operating, before: Operating, gears: Mapping[str, Gear]) -> bool:
    """Return whether the input torque alone decides the pressed flanks, and has the same signs."""
    if has_sets(gears) or now.external:
        return False
    return np.array_equal(np.sign(now.input_torque), np.sign(before.input_torque))


def _number(value: object) -> float | None:
    """Return the number in a value of a case file, whatever its unit; None for a word."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    match = _NUMBER.match(value.strip()) if isinstance(value, str) else None
    return float(match[0].replace("−", "-")) if match else None
