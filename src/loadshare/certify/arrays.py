"""Situations and claims as compiled code reads them: tuples of arrays of one kind.

There is one such tuple of each: Numba takes two that are alike for the same, and looks at all types
again in every call that it took for the other.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

import numpy as np

from loadshare.array_types import Array
from loadshare.train.equilibria import CLAIMED, Equilibria
from loadshare.train.situations import VARYING, Situations

Here = namedtuple("Here", VARYING)  # type: ignore[misc]
"""What a position brings, one row or one per answer: the arrays of `Situations`."""
Claim = namedtuple("Claim", CLAIMED)  # type: ignore[misc]
"""What is claimed: the arrays of `Equilibria`."""


def arrays_of(situations: Situations, answers: Equilibria) -> tuple[Any, Any]:
    """Return situations and claims as tuples."""
    here = Here(*(_array(getattr(situations, name)) for name in VARYING))
    return here, Claim(*(_array(array) for array in answers.arrays))


def _array(array: Array) -> Array:
    """Return an array of the one kind that code is compiled for."""
    if array.flags.carray and array.dtype == np.float64:
        return array
    return np.require(array, np.float64, ["C", "W"])
