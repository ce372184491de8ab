"""Arrays by what they hold."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]
Numbers: TypeAlias = NDArray[np.intp]
"""Of elements, samples, places in another array."""
States: TypeAlias = NDArray[np.int8]
"""Of elements: how each acts, one small number (`contact_states`)."""


def floats(given: Any) -> Any:
    """Return numbers as an array of floats, and anything else as it is, for a check to name."""
    try:
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        return given
