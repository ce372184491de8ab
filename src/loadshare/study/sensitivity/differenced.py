"""One-sided differences of certified solves, where no active set could be proved.

The difference over a step, a quarter of it, and so on converges as the step or as its square root
(a law that is soft at first). Two neighbours give the limit and tell what is left.
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
    """There is no certified equilibrium to a side; the message says why."""


def differenced(
    here: Equilibrium, varied: Variation, sign: float, step: float | None
) -> tuple[Array, Array]:
    """Return derivatives to one side, and their errors: of torques, then of displacements.

    Parameters
    ----------
    here : Equilibrium
        At the value itself.
    varied : Variation
    sign : float
    step : float or None
        Step [SI] that the input can take for certain.

    Raises
    ------
    NoDifference
        If there is no certified equilibrium to that side, however near.
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
        raise NoDifference(why or "its equilibrium cannot be distinguished at steps that small")
    return _limit(slopes)


def _unsettled(slopes: list[tuple[Array, Array]]) -> bool:
    """Whether slopes differed the more the nearer they were, beyond their noise, until lately."""
    for far, middle, near in zip(slopes[:-2], slopes[1:-1], slopes[2:], strict=True):
        apart = np.abs(near[0] - middle[0])
        noise = near[1] + middle[1]
        if ((apart > np.abs(middle[0] - far[0])) & (apart > noise)).any():
            return True
    return False


def _limit(slopes: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Extrapolate every pair of neighbours; take, figure by figure, the least error.

    A limit that a nearer one contradicts is none: an event stands between them.
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
    """Torques, then displacements in every gear's frame, side by side."""
    moved = [gear.plane @ found.displacement[name] for name, gear in train.gears.items()]
    return np.concatenate([torques_of(train, found).net[0], *moved])


def _sizes(stacked: Array, torques: int) -> Array:
    """Largest of the torques, which come first, and of the displacements."""
    sizes = np.abs(stacked)
    sizes[:torques] = sizes[:torques].max(initial=0.0)
    sizes[torques:] = sizes[torques:].max(initial=0.0)
    return sizes
