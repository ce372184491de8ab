"""Types of arrays, by their content."""

from __future__ import annotations

from numbers import Real
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]
Numbers: TypeAlias = NDArray[np.intp]
"""Indices of elements, samples or places in another array."""
States: TypeAlias = NDArray[np.int8]
"""Contact states of elements, one small integer each (`contact_states`)."""


def floats(given: Any) -> Any:
    """Return numbers as an array of floats, and anything else as no array, for a check to reject.

    None counts as NaN. Complex numbers, times and masked values, which conversion would strip of
    what makes them so, are no numbers; nor is a text that looks like one.
    """
    try:
        array = np.asarray(given)
        kind = array.dtype.kind
        numbers = kind in "biuf" or (
            kind == "O" and all(isinstance(value, Real | None) for value in array.flat)
        )
        if numbers and not np.ma.is_masked(given):
            return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        pass
    return given.tolist() if isinstance(given, np.ndarray) else given


def shaped(what: str, given: Any, shape: tuple[int, ...]) -> Array:
    """Return finite numbers as an array of floats of a shape.

    Raises
    ------
    ValueError
        If they are no finite numbers or have another shape.
    """
    array = floats(given)
    if not isinstance(array, np.ndarray) or array.shape != shape:
        has = f"shape {np.shape(array)}" if isinstance(given, np.ndarray) else repr(given)
        raise ValueError(f"{what}: an array of numbers of shape {shape} is needed, not {has}")
    if not np.isfinite(array).all():
        raise ValueError(f"{what}: contains a number that is not finite, so it is no answer")
    return array
