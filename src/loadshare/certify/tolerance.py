"""The tolerance of a certificate: what may be asked for."""

from __future__ import annotations

import math
from numbers import Real

TOLERANCE = 1e-9
"""Largest scaled residual of a certified answer."""
BAND = 1e-9
"""Band in which a margin counts as none, in deflections of the case."""
LARGEST = 1e-3
"""Largest tolerance: an answer that misses by more than a thousandth is not certified, it is
guessed, and Ω is read to three digits behind the point."""


def checked_tolerance(given: object) -> float:
    """Return a tolerance that a certificate can be judged by.

    Parameters
    ----------
    given : object
        What a user asks for.

    Raises
    ------
    ValueError
        If it is no number above 0 and up to `LARGEST`.
    """
    if isinstance(given, Real) and not isinstance(given, bool):
        value = float(given)
        if math.isfinite(value) and 0.0 < value <= LARGEST:
            return value
    raise ValueError(
        f"tolerance {given!r} cannot be certified by; allowed: a number above 0 and up to "
        f"{LARGEST:g}, such as 1e-9"
    )
