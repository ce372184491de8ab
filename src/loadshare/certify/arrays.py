"""Situations and claims as compiled code reads them: tuples of arrays of one kind.

Each has one such type: Numba takes two types that are alike for the same one, and examines all
types again in every call with the other.
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
"""The arrays of `Situations`, with one row or one per answer."""
Claim = namedtuple("Claim", (*CLAIMED, "flank_root"))  # type: ignore[misc]
"""The arrays of `Equilibria`, and the cube roots of the forces of flanks, (S or 1, flanks)."""


def arrays_of(situations: Situations, answers: Equilibria) -> tuple[Any, Any]:
    """Return situations and claims as tuples, with the vectors of all gears in one row."""
    here = Here(*(_array(name, getattr(situations, name)) for name in VARYING))
    claim = {name: _array(name, getattr(answers, name)) for name in CLAIMED}
    # NumPy finds many roots several times as fast as compiled code, which finds one by one.
    force = claim["flank_force"] if situations.hertz.any() else claim["flank_force"][:1]
    return here, Claim._make([*claim.values(), np.cbrt(np.maximum(force, 0.0))])


def _array(name: str, array: Array) -> Array:
    """Return an array of the kind for which code is compiled."""
    if not (array.flags.carray and array.dtype == np.float64):
        array = np.require(array, np.float64, ["C", "W"])
    return array.reshape(len(array), math.prod(array.shape[1:])) if name in _OF_GEARS else array


_OF_GEARS = {"offset", "push", "displacement", "support_force"}
