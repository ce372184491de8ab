"""Situations and claims as compiled code reads them: tuples of arrays of one kind.

There is one such tuple of each: Numba takes two that are alike for the same, and looks at all types
again in every call that it took for the other.
"""

from __future__ import annotations

import math
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
    """Return situations and claims as tuples, the vectors of gears one after another in rows."""
    here = Here(*(_array(name, getattr(situations, name)) for name in VARYING))
    return here, Claim(*(_array(name, getattr(answers, name)) for name in CLAIMED))


def _array(name: str, array: Array) -> Array:
    """Return an array of the one kind that code is compiled for."""
    if not (array.flags.carray and array.dtype == np.float64):
        array = np.require(array, np.float64, ["C", "W"])
    return array.reshape(len(array), math.prod(array.shape[1:])) if name in _OF_GEARS else array


_OF_GEARS = {"offset", "push", "displacement", "support_force"}
