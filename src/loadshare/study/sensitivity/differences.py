"""Derivatives of the train's own equations with respect to an input of the case.

No solve is involved, and the equations are smooth in most inputs: a central difference of fourth
order, at a step and at twice the step, gives the derivative and its error. Where the sides differ
by more than that, the equations have a kink in the input, and where the input is at a bound there
is one side only. Differences of third order are then taken on each side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.errors import CaseError
from loadshare.settings import EPS, SENSITIVITY
from loadshare.study.parameter import Value
from loadshare.study.sensitivity.branch import BranchLost

LEAST = {
    "": 1e-4,
    "m": 1e-6,
    "rad": 1e-4,
    "rad/s": 1e-1,
    "W": 1e1,
    "N*m": 1e-1,
    "N": 1e-1,
    "m/s^2": 1e-2,
    "K": 1e-1,
    "1/K": 1e-8,
    "kg": 1e-2,
    "kg/m^3": 1e1,
    "N/m": 1e1,
    "N/m^1.5": 1e3,
    "N/m^(10/9)": 1e1,
    "N*m/rad": 1e1,
    "rad/(N*m)": 1e-12,
    "rad/(N*m)^(2/3)": 1e-11,
}
"""Least step of every kind of input, in its SI unit, where the input has room for it."""
# Weights of f(0), f(h), f(2h), f(4h) times 1/h: the forward difference of third order and, without
# the last point, of second order.
_FORWARD = np.array([-21.0, 32.0, -12.0, 1.0]) / 12.0
_FORWARD_CHECK = np.array([-1.5, 2.0, -0.5, 0.0])

_AWAY = 1, 2, 4
"""Distances from the value, in steps, at which the function is evaluated."""

Points = dict[int, Array]
Group = list[Array] | Exception
"""Figures at some numbers of the input, or why it cannot take one of them."""
Function = Callable[[Sequence[Sequence[float]]], list[Group]]
"""Function that returns figures at groups of numbers, in the unit of the input."""


@dataclass(frozen=True, slots=True, eq=False)
class SideSlope:
    """A one-sided derivative, per SI unit.

    Attributes
    ----------
    value : ndarray
    error : ndarray
        Bound on its error, from differences at two steps and from round-off.
    """

    value: Array
    error: Array


@dataclass(frozen=True, slots=True, eq=False)
class Derivative:
    """Derivatives on both sides of an input's value.

    Attributes
    ----------
    falling, rising : SideSlope or Exception
        The exception says why the input cannot go to that side.
    kinked : bool
        Whether the sides differ.
    step : float
        In SI units; the input can move by four steps to every side that exists.
    """

    falling: SideSlope | Exception
    rising: SideSlope | Exception
    kinked: bool
    step: float

    def to(self, sign: float) -> SideSlope | Exception:
        """Return the derivative on the side of a sign."""
        return self.rising if sign > 0.0 else self.falling


def whole(found: Sequence[Array | Exception]) -> Group:
    """Return figures of a group, or the first reason why some are missing."""
    why = next((one for one in found if isinstance(one, Exception)), None)
    return why or [one for one in found if not isinstance(one, Exception)]


def differentiate(of: Function, value: Value, rounding: Array) -> Derivative:
    """Differentiate a function of an input on both sides of its value.

    Parameters
    ----------
    of : callable
        The function, of groups of numbers. For a group with a number that the input cannot take it
        returns a `CaseError`, a `ValueError` or a `BranchLost`.
    value : Value
        Of the input.
    rounding : ndarray
        Bound on the round-off of the function.

    Raises
    ------
    CaseError
        If the input can be varied to neither side.
    """
    usual = max(SENSITIVITY.step * abs(value.number), LEAST[value.si_unit] / value.factor)
    first = best = _differentiated(of, value, rounding, usual)
    # A shorter step leaves a smaller error unless that is round-off; then a longer one may.
    rounded = False
    for share in SENSITIVITY.other:
        least = _relative(best)
        if least <= SENSITIVITY.close or (share > 1.0 and best is not first):
            break
        if rounded and share < 1.0:
            continue
        try:
            found = _differentiated(of, value, rounding, share * usual)
        except (CaseError, ValueError, BranchLost):
            continue
        if _sides(found) != _sides(best):
            continue
        rounded = least < SENSITIVITY.regular and _relative(found) > 4.0 * least
        if _relative(found) < least:
            best = found
    return best


def _sides(found: Derivative) -> tuple[bool, bool]:
    """Return whether there is a derivative on each side."""
    return isinstance(found.falling, SideSlope), isinstance(found.rising, SideSlope)


def _relative(found: Derivative) -> float:
    """Return the largest error over the largest derivative, of the sides that exist."""
    worst = 0.0
    for side in (found.falling, found.rising):
        if isinstance(side, SideSlope):
            size = float(np.abs(side.value).max(initial=0.0))
            worst = max(worst, float(side.error.max(initial=0.0)) / size if size else 0.0)
    return worst


def _differentiated(of: Function, value: Value, rounding: Array, usual: float) -> Derivative:
    here: Array | None = None
    sides: dict[int, tuple[Points, float] | Exception] = {}
    # A value far below the least step of its kind may have no more room than its own size.
    own = SENSITIVITY.step * abs(value.number)
    shorter = [usual * share for share in SENSITIVITY.shorter]
    for h in (*shorter, own) if 0.0 < own < shorter[-1] else shorter:
        left = [sign for sign in (-1, 1) if not isinstance(sides.get(sign), tuple)]
        if not left:
            break
        beside = [[value.number + sign * k * h for k in _AWAY] for sign in left]
        alone, *found = of([[value.number], *beside])
        if isinstance(alone, Exception):
            raise alone
        here = alone[0]
        for sign, points in zip(left, found, strict=True):
            if isinstance(points, Exception):
                sides.setdefault(sign, points)
            else:
                sides[sign] = dict(zip(_AWAY, points, strict=True)), h
    assert here is not None
    below, above = sides[-1], sides[1]
    if isinstance(below, CaseError) and isinstance(above, CaseError):
        raise above
    steps = [s[1] for s in (below, above) if not isinstance(s, Exception)]
    step = min(steps, default=usual) * value.factor
    low = _forward(here, below, -1.0, value, rounding)
    high = _forward(here, above, 1.0, value, rounding)
    if isinstance(low, Exception) or isinstance(high, Exception):
        return Derivative(low, high, True, step)
    assert not isinstance(below, Exception)
    assert not isinstance(above, Exception)
    if below[1] == above[1]:
        both = _central(below[0], above[0], below[1], value, rounding)
    else:
        both = low if low.error.max(initial=0.0) < high.error.max(initial=0.0) else high
    apart = np.abs(low.value - high.value)
    size = float(np.abs(both.value).max(initial=0.0))
    kinked = (apart > 3.0 * (low.error + high.error)) & (apart > SENSITIVITY.kink * size)
    if kinked.any():
        return Derivative(low, high, True, step)
    return Derivative(both, both, False, step)


def _central(below: Points, above: Points, h: float, value: Value, rounding: Array) -> SideSlope:
    """Return the difference of fourth order; that at twice the step gives its error."""
    once, twice, four = ((above[k] - below[k]) / (2.0 * k * h * value.factor) for k in (1, 2, 4))
    near, far = (4.0 * once - twice) / 3.0, (4.0 * twice - four) / 3.0
    still = (once == 0.0) & (twice == 0.0) & (four == 0.0)
    noise = _noise(near, h, value, SENSITIVITY.central * rounding)
    return SideSlope(near, np.where(still, 0.0, np.abs(near - far) + noise))


def _forward(
    here: Array,
    side: tuple[Points, float] | Exception,
    sign: float,
    value: Value,
    rounding: Array,
) -> SideSlope | Exception:
    """Return the one-sided difference of third order; that of second order gives its error."""
    if isinstance(side, Exception):
        return side
    points, h = side
    values = np.array([here, points[1], points[2], points[4]])
    scale = sign / (h * value.factor)
    found, check = (scale * np.tensordot(w, values, 1) for w in (_FORWARD, _FORWARD_CHECK))
    still = (values == here).all(axis=0)
    noise = _noise(found, h, value, SENSITIVITY.forward * rounding)
    return SideSlope(
        np.where(still, 0.0, found), np.where(still, 0.0, np.abs(found - check) + noise)
    )


def _noise(found: Array, h: float, value: Value, rounding: Array) -> Array:
    """Return the round-off of a difference: of its terms, and of where they are evaluated."""
    of_values = 2.0 * EPS * abs(value.number) / h
    return np.asarray(rounding / (h * value.factor) + of_values * np.abs(found))
