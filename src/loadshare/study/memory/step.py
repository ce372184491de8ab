"""One certified step with memory: the order in which methods are tried."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import combinations, islice, product

import numpy as np

from loadshare.array_types import Array
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.ladder import rungs
from loadshare.settings import MARCH
from loadshare.study.memory.fallbacks import alternating, negligible_friction, searched
from loadshare.study.memory.held import if_certified, slip_at_end, with_slips_held
from loadshare.study.positions import BACKEND, certified
from loadshare.train.situations import situation_of
from loadshare.train.train import Train

_ENDLESS = math.inf, math.inf
"""Limits on the Newton steps, in all and of every plan: none."""


@dataclass(slots=True)
class StepHistory:
    """The method that solved the previous step, which is tried first at the next.

    Attributes
    ----------
    held : dict of tuple of str to tuple of str
        Gears whose slip was held, by those whose slip was at the end of its clearance.
    bounds : dict of gear to float
        Friction bounds [N] that agreed with the torques, where they were found by iteration.
    """

    held: dict[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)
    bounds: dict[str, float] = field(default_factory=dict)


def stepped(train: Train, index: int, history: StepHistory | None = None) -> Answer:
    """Solve and certify a position of a train whose splines remember their slip.

    Parameters
    ----------
    train : Train
        One that remembers slip (`Train.remembering`).
    index : int
        1-based.
    history : StepHistory, optional
        Of the previous step; updated in place.

    Raises
    ------
    Refused
        If the position has no certified equilibrium.
    """
    if not train.splines:
        # Without splines there is no slip to remember.
        return certified(replace(train, slip=None), index)
    assert train.slip is not None
    # A slip at the end of its clearance mostly stays there.
    ends = tuple(g for g, s in train.splines.items() if slip_at_end(s, train.slip[g]))
    follows = any(s.friction_force is None for s in train.splines.values())
    history = history or StepHistory()
    # Where friction follows the torque, iteration on fixed bounds finds those of the torques.
    if history.bounds and (answer := _followed(train, index, history)) is not None:
        return answer
    sets = sorted((*_subsets(ends), ()), key=lambda gears: gears != history.held.get(ends))
    # If a plan finds no answer soon, a wider one or another set of held slips mostly does.
    limits = ((MARCH.quick, math.inf),) if follows else ((math.inf, MARCH.quick_plan), _ENDLESS)
    for (steps, each), gears in product(limits, sets):
        answer = with_slips_held(train, index, gears, islice(rungs(BACKEND), 1), steps, (each,))
        if answer is not None:
            history.held[ends] = gears
            return answer
    followed = partial(_followed, history=history)
    for other in (followed,) if follows else (negligible_friction, searched, alternating):
        answer = other(train, index)
        if answer is not None:
            return answer
    try:
        return certified(train, index)
    except Refused:
        for gears in _subsets([*train.splines]):
            answer = with_slips_held(train, index, gears, rungs(BACKEND))
            if answer is not None:
                return answer
        raise


def _subsets(gears: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Yield all non-empty sets of gears, the largest first."""
    for count in range(len(gears), 0, -1):
        yield from combinations(gears, count)


def _followed(train: Train, index: int, history: StepHistory) -> Answer | None:
    r"""Return a certified answer where friction follows the torque, by iteration on fixed bounds.

    With fixed bounds F the step is convex and its torques T are unique, so continuous in F. They
    stay bounded as F grows, since a spline that sticks does not depend on its bound. So
    :math:`F = \tau \lvert T(F)\rvert/r` has a solution (Brouwer), which Broyden's method finds.
    """
    gears = [g for g, s in train.splines.items() if s.friction_force is None]
    rate = np.array([train.splines[g].friction_per_torque for g in gears])
    drive = float(np.abs(situation_of(train, index).torque).max(initial=0.0))
    bounds = np.array([history.bounds.pop(g, 0.0) for g in gears])
    inverse, least = np.eye(len(gears)), math.inf
    before: tuple[Array, Array] | None = None
    for _ in range(MARCH.passes):
        try:
            fixed = _bounded(train, dict(zip(gears, bounds.tolist(), strict=True)))
            answer = stepped(fixed, index, history)
        except Refused:
            return None
        found = answer.equilibrium
        torque = [train.transmitted(g, found.flank_force) for g in gears]
        off = rate * np.abs(torque) - bounds
        far = float(np.abs(off).max())
        # A mismatch this small that no longer shrinks is the round-off of the torques.
        as_close = far <= MARCH.close * float(bounds.max()) and far > 0.5 * least
        if as_close or far <= MARCH.settled * float(rate.max()) * drive:
            break
        least = min(least, far)
        if before is not None:
            inverse = _broyden(inverse, bounds - before[0], off - before[1])
        before = bounds, off
        bounds = np.maximum(bounds + inverse @ off, 0.0)
    followed = if_certified(train, found, answer.record, f"{answer.rung}, friction followed")
    if followed is not None:
        history.bounds.update(zip(gears, bounds.tolist(), strict=True))
    return followed


def _bounded(train: Train, bounds: Mapping[str, float]) -> Train:
    """Return the train with some friction bounds [N] fixed."""
    fixed = {g: replace(train.splines[g], friction_force=b) for g, b in bounds.items()}
    return replace(train, splines={**train.splines, **fixed})


def _broyden(inverse: Array, step: Array, change: Array) -> Array:
    """Return the inverse of −Jacobian, updated by the last step and its change of the mismatch."""
    moved = -inverse @ change
    along = float(step @ moved)
    if abs(along) <= MARCH.singular * float(step @ step):
        return inverse
    return np.asarray(inverse + np.outer(step - moved, step @ inverse) / along)
