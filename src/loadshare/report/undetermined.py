"""What the forces leave open, in words: coordinates and the ranges that they may take."""

from __future__ import annotations

import math
from collections.abc import Sequence

from loadshare.report.numbers import significant
from loadshare.report.units import engineering
from loadshare.results import Position

DIGITS = 5
"""Significant digits of a range's ends."""


def undetermined_told(positions: Sequence[Position]) -> list[str]:
    """Return a line for every range, with the coordinates that have it; none if all is determined.

    Over several positions a coordinate is told from the least to the largest of all its values.
    """
    groups: dict[str, list[str]] = {}
    for name in dict.fromkeys(name for p in positions for name in p.undetermined):
        ranges = [p.undetermined[name] for p in positions if name in p.undetermined]
        told = range_told(name, min(r[0] for r in ranges), max(r[1] for r in ranges))
        if len(ranges) < len(positions):
            told += f", at {len(ranges)} of {len(positions)} positions"
        groups.setdefault(told, []).append(name)
    return [f"{', '.join(names)}: not determined, {told}" for told, names in groups.items()]


def range_told(name: str, low: float, high: float) -> str:
    """Return a coordinate's range: ``−50 … 50 µm``, ``from −12 µrad on``, ``without limit``."""
    unit = engineering((low, high), "rad" if name.endswith("rotation") else "m")
    least, largest = (significant(unit.of(end), DIGITS).replace("-", "−") for end in (low, high))
    if math.isinf(low) and math.isinf(high):
        return "without limit"
    if math.isinf(high):
        return f"from {least} {unit.name} on"
    if math.isinf(low):
        return f"up to {largest} {unit.name}"
    return f"{least} … {largest} {unit.name}"
