"""The findings of a search along a parameter: certified points, changes of the set, and gaps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from loadshare.array_types import Array
from loadshare.settings import FOLLOW
from loadshare.study.follow.active import WorkingSet
from loadshare.study.follow.line import Missing


@dataclass(frozen=True, slots=True, eq=False)
class PathPoint:
    """A certified point on a set, or one between two such points, found by the set's equations.

    Attributes
    ----------
    value : float
    active : WorkingSet
    z : ndarray
    worst : float
        Worst scaled residual of its certificate, or of those of the two points.
    """

    value: float
    active: WorkingSet
    z: Array
    worst: float


@dataclass(frozen=True, slots=True)
class Change:
    """A change of the set.

    Attributes
    ----------
    value : float
    before, after : WorkingSet
    confirmed : bool
        Whether both sides were proved up to the change.
    worst : float
        Larger of the worst residuals on both sides.
    apart : float
        Larger of the distances of the points on both sides.
    """

    value: float
    before: WorkingSet
    after: WorkingSet
    confirmed: bool
    worst: float
    apart: float


def change_between(
    first: PathPoint, last: PathPoint, value: float, confirmed: bool = False
) -> Change:
    """Return the change from the set of one point to that of another, which happens at a value."""
    apart = float(max(value - first.value, last.value - value))
    worst = max(first.worst, last.worst)
    return Change(value, first.active, last.active, confirmed, worst, apart)


Stretch = tuple[PathPoint | Missing, PathPoint | Missing]


@dataclass(frozen=True, slots=True)
class Gap:
    """A stretch on which nothing was proved, and why."""

    first: PathPoint | Missing
    last: PathPoint | Missing
    why: str


def distinct(changes: Iterable[Change], least: float) -> list[Change]:
    """Return changes by value, joining those that are too close together to be two events.

    Parameters
    ----------
    changes : iterable of Change
    least : float
        Distance below which two values are the same.
    """
    found: list[Change] = []
    for change in sorted(changes, key=lambda c: c.value):
        last = found[-1] if found else change
        near = max(FOLLOW.resolved * abs(change.value), least)
        apart = last is change or change.value - last.value > near
        if apart or last.before.states == change.after.states:
            found.append(change)
            continue
        found[-1] = Change(
            min(last.value, change.value, key=abs),
            last.before,
            change.after,
            last.confirmed and change.confirmed,
            max(last.worst, change.worst),
            max(last.apart, change.apart),
        )
    return found


def merged(gaps: Iterable[Gap]) -> list[Gap]:
    """Join gaps that touch."""
    found: list[Gap] = []
    for gap in sorted(gaps, key=lambda g: g.first.value):
        if found and gap.first.value <= found[-1].last.value:
            found[-1] = replace(found[-1], last=gap.last)
        else:
            found.append(gap)
    return found
