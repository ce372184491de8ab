"""The involute function and its inverse."""

from __future__ import annotations

import math


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
    if value == 0.0:
        return 0.0
    # In t = tan α the equation t − atan t = value is convex and rising, so that Newton's method
    # comes down to the root from any start above it; both bounds on the start lie above.
    tangent = value + math.pi / 2 if value > 1.0 else (3.0 * value) ** (1 / 3) * (1.0 + value)
    for _ in range(60):
        step = (tangent - math.atan(tangent) - value) * (1.0 + tangent**2) / tangent**2
        tangent -= step
        if abs(step) <= 4e-16 * tangent:
            break
    return math.atan(tangent)
