"""The involute function and its inverse."""

from __future__ import annotations

import math

from scipy.optimize import brentq


def inv(angle: float) -> float:
    """Involute of a pressure angle [rad]: tan α − α."""
    return math.tan(angle) - angle


def inverse_inv(value: float) -> float:
    """Pressure angle [rad] of an involute value, 0 ≤ α < π/2.

    Parameters
    ----------
    value : float
        inv α, not negative.

    Raises
    ------
    ValueError
        If `value` is negative: no involute reaches inside its base circle.
    """
    if value < 0.0:
        raise ValueError(f"inv α = {value:.6g} is negative; no pressure angle has it")
    # In t = tan α the equation is t − atan t = value; both bounds on the root lie above it.
    highest = value + math.pi / 2 if value > 1.0 else (3.0 * value) ** (1 / 3) * (1.0 + value)
    highest *= 2.0  # beyond round-off
    found = brentq(lambda t: t - math.atan(t) - value, 0.0, highest, xtol=1e-300, rtol=1e-15)
    return math.atan(found)
