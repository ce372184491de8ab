"""The larger and the smaller of two numbers, for loops over samples side by side.

`max` and `min` of an array entry and another number compile into a store to only those entries
that change, which takes some processors ten times as long as a store to all of them.
"""

from __future__ import annotations


def larger(number: float, other: float) -> float:
    """Return the larger of two numbers; the first where the other is NaN."""
    return max(number, other)


def smaller(number: float, other: float) -> float:
    """Return the smaller of two numbers; the first where the other is NaN."""
    return min(number, other)
