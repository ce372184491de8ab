"""One step with memory, certified: which ways are tried, and what solved the step before first."""

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
from loadshare.study.memory.fallbacks import almost_frictionless, in_turn, searched
from loadshare.study.memory.held import if_certified, stands_at_end, with_slips_held
from loadshare.study.positions import BACKEND, certified
from loadshare.train.situations import situation_of
from loadshare.train.train import Train

_ENDLESS = math.inf, math.inf
"""Newton steps in all, and for every plan, where neither has a limit."""


@dataclass(slots=True)
class Ways:
    """What solved the step before, which is tried first at the next.

    Attributes
    ----------
    held : dict of tuple of str to tuple of str
        Gears whose slip was held, by those whose slip stood at an end.
    bounds : dict of gear to float
        Friction [N] that belonged to the torques, where it was found by way of fixed bounds.
    """

    held: dict[tuple[str, ...], tuple[str, ...]] = field(default_factory=dict)
    bounds: dict[str, float] = field(default_factory=dict)


def stepped(train: Train, index: int, ways: Ways | None = None) -> Answer:
    """Solve and certify a position of a train whose splines remember their slip.

    Parameters
    ----------
    train : Train
        One that remembers (`Train.remembering`).
    index : int
        1-based.
    ways : Ways, optional
        Of the step before, renewed.

    Raises
    ------
    Refused
        If the position has no certified equilibrium.
    """
    if not train.splines:
        # There is nothing that remembers.
        return certified(replace(train, slip=None), index)
    assert train.slip is not None
    # A slip that stood at the end of its clearance mostly stays there.
    ends = tuple(g for g, s in train.splines.items() if stands_at_end(s, train.slip[g]))
    follows, ways = any(s.friction_force is None for s in train.splines.values()), ways or Ways()
    # Where friction follows the torque, given bounds lead to those of the torques.
    if ways.bounds and (answer := _followed(train, index, ways)) is not None:
        return answer
    sets = sorted((*_subsets(ends), ()), key=lambda gears: gears != ways.held.get(ends))
    # What a plan does not find soon, a wider one mostly does, or another set.
    limits = ((MARCH.quick, math.inf),) if follows else ((math.inf, MARCH.quick_plan), _ENDLESS)
    for (steps, each), gears in product(limits, sets):
        answer = with_slips_held(train, index, gears, islice(rungs(BACKEND), 1), steps, (each,))
        if answer is not None:
            ways.held[ends] = gears
            return answer
    followed = partial(_followed, ways=ways)
    for other in (followed,) if follows else (almost_frictionless, searched, in_turn):
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
    """Yield all sets of gears but the empty one, the largest first."""
    for count in range(len(gears), 0, -1):
        yield from combinations(gears, count)


def _followed(train: Train, index: int, ways: Ways) -> Answer | None:
    r"""Return a certified answer where friction follows the torque, by way of fixed bounds.

    With bounds F that are given the step is convex and its torques T are unique, so they depend on
    F continuously. They do not grow with it either: what sticks does not ask for the bound. So
    :math:`F = \tau \lvert T(F)\rvert/r` has a solution (Brouwer), which Broyden's method finds.
    """
    gears = [g for g, s in train.splines.items() if s.friction_force is None]
    rate = np.array([train.splines[g].friction_per_torque for g in gears])
    drive = float(np.abs(situation_of(train, index).torque).max(initial=0.0))
    bounds = np.array([ways.bounds.pop(g, 0.0) for g in gears])
    inverse, least = np.eye(len(gears)), math.inf
    before: tuple[Array, Array] | None = None
    for _ in range(MARCH.passes):
        try:
            fixed = _bounded(train, dict(zip(gears, bounds.tolist(), strict=True)))
            answer = stepped(fixed, index, ways)
        except Refused:
            return None
        found = answer.equilibrium
        torque = [train.transmitted(g, found.flank_force) for g in gears]
        off = rate * np.abs(torque) - bounds
        far = float(np.abs(off).max())
        # What is that close and comes no closer is as close as rounding of the torques lets it.
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
        ways.bounds.update(zip(gears, bounds.tolist(), strict=True))
    return followed


def _bounded(train: Train, bounds: Mapping[str, float]) -> Train:
    """Return the train with some friction bounds [N] fixed."""
    fixed = {g: replace(train.splines[g], friction_force=b) for g, b in bounds.items()}
    return replace(train, splines={**train.splines, **fixed})


def _broyden(inverse: Array, step: Array, change: Array) -> Array:
    """Inverse of −Jacobian that also turns a change of what is off into the step that made it."""
    moved = -inverse @ change
    along = float(step @ moved)
    if abs(along) <= MARCH.singular * float(step @ step):
        return inverse
    return np.asarray(inverse + np.outer(step - moved, step @ inverse) / along)
