"""The larger and the smaller of two numbers, in loops over samples side by side.

What `max` and `min` make of a number in an array and another is compiled into a store to the
places that change, which takes some processors ten times as long as one to all of them.
"""

from __future__ import annotations


def larger(number: float, other: float) -> float:
    """Return the larger of two numbers; the first where the other is none."""
    return max(number, other)


def smaller(number: float, other: float) -> float:
    """Return the smaller of two numbers; the first where the other is none."""
    return min(number, other)
