"""Derivatives of the train's own equations with respect to an input of the case.

The equations are smooth in every input, and no solve lies between: a central difference at two
steps, extrapolated (Richardson), leaves an error of fourth order in the step, and the two
differences tell its size. At a bound of an input the same is done on one side.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from loadshare.errors import CaseError
from loadshare.scene.scene import Array
from loadshare.study.branch.system import BranchLost
from loadshare.study.parameter import Value

STEP = 1e-4
"""Step relative to the input's value."""
LEAST = {
    "": 1e-5,
    "m": 1e-7,
    "rad": 1e-5,
    "rad/s": 1e-2,
    "W": 1.0,
    "N*m": 1e-2,
    "N": 1e-2,
    "N/m": 1.0,
    "N*m/rad": 1.0,
    "rad/(N*m)": 1e-13,
    "rad/(N*m)^(2/3)": 1e-12,
}
"""Least step of every kind of input, in its SI unit: for inputs that are zero."""
# Weights of f(0), f(h), f(2h), f(4h) times 1/h: the forward difference of third order and, without
# the last point, of second order.
_FORWARD = np.array([-21.0, 32.0, -12.0, 1.0]) / 12.0
_FORWARD_CHECK = np.array([-1.5, 2.0, -0.5, 0.0])


@dataclass(frozen=True, slots=True, eq=False)
class Derivative:
    """A derivative with respect to an input, per SI unit.

    Attributes
    ----------
    value : ndarray
    error : ndarray
        Estimate of its error, from the differences at two steps.
    sides : tuple of bool
        Whether the input can be lowered, and raised.
    step : float
        In SI units.
    """

    value: Array
    error: Array
    sides: tuple[bool, bool]
    step: float


def differentiate(of: Callable[[float], Array], value: Value) -> Derivative:
    """Differentiate a smooth function of an input.

    Parameters
    ----------
    of : callable
        The function, of the input's number in its unit. It may raise `CaseError`, `ValueError` or
        `BranchLost` where the input cannot be.
    value : Value
        Where.

    Raises
    ------
    CaseError
        If the input can be varied on neither side.
    """
    least = LEAST[value.si_unit] / value.factor
    h = max(STEP * abs(value.number), least)
    offsets = (-2.0, -1.0, 1.0, 2.0)
    points = [_tried(of, value.number + k * h) for k in offsets]
    scale = 1.0 / (h * value.factor)
    low2, low1, high1, high2 = (p if not isinstance(p, Exception) else None for p in points)
    sides = (low1 is not None, high1 is not None)
    if low2 is not None and low1 is not None and high1 is not None and high2 is not None:
        near, far = (high1 - low1) / 2.0, (high2 - low2) / 4.0
        central = (4.0 * near - far) / 3.0
        return Derivative(central * scale, np.abs(near - far) * scale, sides, h * value.factor)
    for sign, one, two, able in ((1.0, high1, high2, sides[1]), (-1.0, low1, low2, sides[0])):
        four = _tried(of, value.number + sign * 4.0 * h) if able else None
        if one is None or two is None or four is None or isinstance(four, Exception):
            continue
        values = np.array([of(value.number), one, two, four])
        found, check = (sign * np.tensordot(w, values, 1) for w in (_FORWARD, _FORWARD_CHECK))
        return Derivative(found * scale, np.abs(found - check) * scale, sides, h * value.factor)
    raise next(p for p in points if isinstance(p, Exception))


def _tried(of: Callable[[float], Array], number: float) -> Array | Exception:
    try:
        return of(number)
    except (CaseError, ValueError, BranchLost) as error:
        return error
