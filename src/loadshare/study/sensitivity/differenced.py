"""One-sided differences of certified solves, where no active set could be proved.

The difference quotient over a step, a quarter of it, and so on converges as the step or as its
square root (a law that is soft at first). Two successive quotients give the limit and its error.
"""

from __future__ import annotations

from itertools import combinations, pairwise

import numpy as np

from loadshare.array_types import Array
from loadshare.errors import CaseError, Refused
from loadshare.settings import SENSITIVITY
from loadshare.study.sensitivity.variation import Variation, torques_of
from loadshare.train import Train
from loadshare.train.equilibrium import Equilibrium


class NoDifference(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """There is no certified equilibrium on a side; the message says why."""


def differenced(
    here: Equilibrium, varied: Variation, sign: float, step: float | None
) -> tuple[Array, Array]:
    """Return one-sided derivatives and their errors: of torques, then of displacements.

    Parameters
    ----------
    here : Equilibrium
        At the value itself.
    varied : Variation
    sign : float
    step : float or None
        Step [SI] that the input is known to be able to take.

    Raises
    ------
    NoDifference
        If there is no certified equilibrium on that side, however near.
    """
    start = _stacked(varied.setting(0.0).train, here)
    first = (
        4.0 * step
        if step is not None
        else SENSITIVITY.first * (abs(varied.value.si) or SENSITIVITY.least_value)
    )
    slopes: list[tuple[Array, Array]] = []
    why = ""
    for k in range(SENSITIVITY.most):
        if k >= SENSITIVITY.steps and not _unsettled(slopes[-SENSITIVITY.settled :]):
            break
        amount = first * 0.25**k
        try:
            there = _stacked(varied.setting(sign * amount).train, varied.answer(sign * amount))
        except (Refused, CaseError, ValueError) as fault:
            why = str(fault)
            slopes.clear()
            continue
        count = len(there) - 2 * len(varied.setting(0.0).train.gears)
        noise = np.maximum(_sizes(start, count), _sizes(there, count))
        noise *= SENSITIVITY.solved / amount
        slopes.append(((there - start) * sign / amount, noise))
    if len(slopes) < 3:
        raise NoDifference(why or "its equilibrium cannot be distinguished at such small steps")
    return _limit(slopes)


def _unsettled(slopes: list[tuple[Array, Array]]) -> bool:
    """Return whether any of these slopes differed more, beyond noise, as steps shrank."""
    for far, middle, near in zip(slopes[:-2], slopes[1:-1], slopes[2:], strict=True):
        apart = np.abs(near[0] - middle[0])
        noise = near[1] + middle[1]
        if ((apart > np.abs(middle[0] - far[0])) & (apart > noise)).any():
            return True
    return False


def _limit(slopes: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Extrapolate every pair of successive slopes; take, figure by figure, that of least error.

    A limit that one from smaller steps contradicts is not used: there is an event between them.
    """
    limits = [
        ((4.0 * near - far) / 3.0, (4.0 * noise + coarse) / 3.0)
        for (far, coarse), (near, noise) in pairwise(slopes)
    ]
    values = np.array([value for value, _ in limits[1:]])
    errors = np.array([SENSITIVITY.safe * np.abs(b[0] - a[0]) + b[1] for a, b in pairwise(limits)])
    for far, near in combinations(range(len(values)), 2):
        apart = np.abs(values[far] - values[near])
        errors[far] = np.where(apart > errors[far] + errors[near], np.inf, errors[far])
    chosen = errors.argmin(axis=0)
    each = np.arange(values.shape[1])
    return values[chosen, each], errors[chosen, each]


def _stacked(train: Train, found: Equilibrium) -> Array:
    """Return torques, then displacements in every gear's frame, in one array."""
    moved = [gear.plane @ found.displacement[name] for name, gear in train.gears.items()]
    return np.concatenate([torques_of(train, found).net[0], *moved])


def _sizes(stacked: Array, torques: int) -> Array:
    """Return, for every entry, the largest torque (these come first) or displacement."""
    sizes = np.abs(stacked)
    sizes[:torques] = sizes[:torques].max(initial=0.0)
    sizes[torques:] = sizes[torques:].max(initial=0.0)
    return sizes
