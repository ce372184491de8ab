"""Critical values: where along a parameter the active set changes (issue of exact thresholds).

On one active set the equilibrium follows smooth equations. They are followed until an element's
gauge (an approach, a force, a radius) turns negative; the zero of that gauge is found by Brent's
method on the branch, not read off a grid. Beyond it a certified solve tells the next set. Where the
set at the far end is not the one that was followed, the interval is halved until every set between
is found.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path as FilePath

from scipy.optimize import brentq, minimize_scalar

from loadshare.case import Case
from loadshare.errors import CaseError, Problem, Refused
from loadshare.job import Progress
from loadshare.job.positions import wanted_positions
from loadshare.scene.scene import Array
from loadshare.study.branch import ActiveSet
from loadshare.study.branch.system import BranchLost, Gauge
from loadshare.study.event import Event, told
from loadshare.study.parameter import RANGE, STUDY, Parameter, grid, named, read_parameter
from loadshare.study.path import End, Path, Trains
from loadshare.study.positions import alike, loaded

SAMPLES = 16
"""Points at which a branch is looked at, besides the zeros of its gauges."""
ASIDE = 1e-6
"""Distance of the certified solves from an event, relative to the interval."""
NEAREST = 1e-11
"""Least such distance: closer, forces and gaps are round-off."""
ZERO = 1e-9
"""Gauge that counts as zero at an event, in deflections or loads."""
DEPTH = 40
"""Halvings of an interval before its events are told as unresolved."""

Gauges = dict[tuple[str, str], Gauge]


@dataclass(frozen=True, slots=True)
class Critical:
    """Events along a parameter.

    Attributes
    ----------
    parameter : Parameter
    start, stop : float
        In the parameter's unit.
    events : tuple of Event
        By position, then by value.
    """

    parameter: Parameter
    start: float
    stop: float
    events: tuple[Event, ...]

    def marks(self, position: int | None = None) -> tuple[tuple[float, str], ...]:
        """Values and words for a picture; what happens at one value stands in one line.

        Parameters
        ----------
        position : int, optional
            1-based; the first one found by default.
        """
        here = [e for e in self.events if e.position == (position or self.events[0].position)]
        words: dict[float, dict[str, None]] = {}
        for event in here:
            what = f"gear {event.gear}" if event.gear else event.element
            told = f"{what}: {event.kind}"
            words.setdefault(event.value, {})[told] = None
        return tuple((value, "; ".join(told)) for value, told in words.items())

    def of(self, kind: str = "", gear: str | None = None) -> tuple[Event, ...]:
        """Events of a kind, of a gear, or both."""
        return tuple(e for e in self.events if kind in e.kind and (gear is None or e.gear == gear))


def critical(
    case: Case | str | FilePath,
    key: str | Sequence[str],
    start: object,
    stop: object,
    *,
    positions: Iterable[int] | None = None,
    progress: Progress | None = None,
) -> Critical:
    """Find every change of the active set along a parameter, with its exact value.

    Parameters
    ----------
    case : Case or path
    key : str or sequence of str
        Input to vary, such as ``"rings.4.float"``; with a star (``"rings.*.float"``) or as several
        keys, all of them take the same value.
    start, stop : physical value or number
        Ends of the interval, such as ``"0 um"`` and ``"12 um"``.
    positions : iterable of int, optional
        1-based positions; all by default. Positions that differ in nothing are solved once.
    progress : Progress, optional
        Called after every position.

    Returns
    -------
    Critical
        The events. The zero of an event's gauge is found to round-off, about 1e-12 of the value;
        each is confirmed by certified solves on both sides.

    Raises
    ------
    CaseError
        If the key or the values cannot be used.
    Refused
        If an end of the interval has no certified equilibrium, or an event cannot be resolved.

    Examples
    --------
    >>> import loadshare as ls
    >>> found = ls.critical("cases/fgfbstts/limit_ring.toml", "rings.*.float", "0 um", "12 um",
    ...                     positions=[1])
    >>> {event.gear: f"{event.value:.2f} um" for event in found.of("leaves boundary")}
    {'5': '2.98 um', '4': '8.35 um'}
    """
    case = loaded(case)
    numbers, unit = grid([start, stop], "start, stop", RANGE)
    low, high = numbers
    if not low < high:
        message = f"start {low:g} {unit} is not below stop {high:g} {unit}"
        raise CaseError([Problem(STUDY, named(key), "", message, "start below stop")])
    parameter = read_parameter(case, key, unit)
    trains = Trains(case, parameter)
    events: list[Event] = []
    chosen = wanted_positions(trains.at(low), positions)
    done = 0
    for group in alike((trains.at(low), trains.at(high)), chosen):
        found = list(_Search(Path(trains, group[0], low), low, high).events())
        events += [replace(event, position=position) for position in group for event in found]
        done += len(group)
        if progress is not None:
            progress(done, len(chosen))
    events.sort(key=lambda e: (e.position, e.value))
    return Critical(parameter, low, high, tuple(events))


class _Search:
    """The events of one path between two values."""

    def __init__(self, path: Path, low: float, high: float) -> None:
        self.path, self.low, self.high = path, low, high
        self.span = high - low

    def events(self) -> Iterator[Event]:
        """Yield the events in order."""
        # At the very ends an element may stand on the verge, such as a ring without any float.
        aside = ASIDE * self.span
        first, last = self._end(self.low + aside), self._end(self.high - aside)
        yield from self._between(first, last, 0)

    def _end(self, value: float, near: End | None = None, due: Iterable[Gauge] = ()) -> End:
        """Return the certified end at a value, near one where some elements are due to change."""
        guesses = []
        if near is not None:
            sets = [near.active, *(near.active.switched(g.element, g.to) for g in due)]
            both = near.active
            for g in due:
                both = both.switched(g.element, g.to)
            sets.append(both)
            guesses = [(active, near.z) for active in sets]
        try:
            return self.path.settled(value, guesses)
        except BranchLost as lost:
            raise Refused(
                f"at {self._shown(value)}: the active set cannot be told: {lost}"
            ) from lost

    def _shown(self, value: float) -> str:
        parameter = self.path.parameter
        return f"{parameter.name} = {value:.12g} {parameter.unit}".rstrip()

    def _between(self, first: End, last: End, depth: int) -> Iterator[Event]:
        """Yield the events between two certified ends, followed from the lower one."""
        while first.value < last.value:
            found = self._exit(first, last.value)
            if found is None:
                if first.active != last.active:
                    yield from self._backward(first, last, depth)
                return
            beyond = self._beyond(first, *found, last)
            if beyond is None:
                yield from self._halved(first, last, depth)
                return
            yield from self._told(first, found[0], beyond)
            first = beyond

    def _backward(self, first: End, last: End, depth: int) -> Iterator[Event]:
        """Yield the events between two ends, the last one followed from the upper end.

        An idle body's own contacts have no gauge from below: where it rests is not determined. The
        force with which it is taken along has one from above.
        """
        found = self._exit(last, first.value)
        beyond = self._beyond(last, *found, first) if found is not None else None
        if found is None or beyond is None:
            yield from self._halved(first, last, depth)
            return
        yield from self._between(first, beyond, depth)
        yield from self._told(last, found[0], beyond)

    def _halved(self, first: End, last: End, depth: int) -> Iterator[Event]:
        middle = 0.5 * (first.value + last.value)
        if depth >= DEPTH or not first.value < middle < last.value:
            changed = ", ".join(first.active.changes(last.active)) or "nothing"
            raise Refused(
                f"between {self._shown(first.value)} and {self._shown(last.value)} the active set "
                f"changes in a way that could not be resolved: {changed}"
            )
        between = self._end(middle)
        yield from self._between(first, between, depth + 1)
        yield from self._between(between, last, depth + 1)

    def _exit(self, first: End, stop: float) -> tuple[float, Array] | None:
        """Return the first value on the way at which a gauge of the branch turns negative.

        None if there is none up to `stop`, which may lie on either side.
        """
        step = (stop - first.value) / SAMPLES
        known: list[tuple[float, Gauges, Array]] = []
        z = first.z
        for k in range(SAMPLES + 1):
            value = stop if k == SAMPLES else first.value + k * step
            try:
                gauges, z = self.path.gauges(first.active, value, z)
            except BranchLost:
                # The branch ends between the last point and here: approach its end by halves.
                return self._lost(first.active, known[-1], value) if known else None
            known.append((value, gauges, z))
            negative = [key for key, g in gauges.items() if g.value < 0.0]
            if negative and k > 0:
                return self._first_zero(first.active, known[-2], known[-1], negative)
            dipped = self._dip(first.active, known)
            if dipped is not None:
                return dipped
        return None

    def _lost(
        self, active: ActiveSet, good: tuple[float, Gauges, Array], bad: float
    ) -> tuple[float, Array] | None:
        """Return where a gauge turns negative before its branch is lost, if one does."""
        for _ in range(60):
            middle = 0.5 * (good[0] + bad)
            if middle in (good[0], bad):
                break
            try:
                gauges, z = self.path.gauges(active, middle, good[2])
            except BranchLost:
                bad = middle
                continue
            here = (middle, gauges, z)
            negative = [key for key, g in gauges.items() if g.value < 0.0]
            if negative:
                return self._first_zero(active, good, here, negative)
            good = here
        return None

    def _first_zero(
        self,
        active: ActiveSet,
        left: tuple[float, Gauges, Array],
        right: tuple[float, Gauges, Array],
        negative: list[tuple[str, str]],
    ) -> tuple[float, Array]:
        """Return the smallest zero of gauges that are positive on the left and negative here."""
        zeros = [self._zero(active, key, left, right) for key in negative]
        value = min(zeros, key=lambda zero: abs(zero - left[0]))
        gauges, z = self.path.gauges(active, value, left[2])
        earlier = [k for k, g in gauges.items() if g.value < -ZERO and k not in negative]
        if earlier:
            return self._first_zero(active, left, (value, gauges, z), earlier)
        return value, z

    def _zero(
        self,
        active: ActiveSet,
        key: tuple[str, str],
        left: tuple[float, Gauges, Array],
        right: tuple[float, Gauges, Array],
    ) -> float:
        if key in left[1] and left[1][key].value <= 0.0:
            return left[0]

        def gauge(value: float) -> float:
            here, _ = self.path.gauges(active, value, left[2])
            # A graph that has no end there cannot be left there.
            return here[key].value if key in here else 1.0

        # The absolute part is far below round-off of the interval; the relative one is the least.
        return float(brentq(gauge, left[0], right[0], xtol=1e-16 * self.span, rtol=8.9e-16))

    def _dip(
        self, active: ActiveSet, known: list[tuple[float, Gauges, Array]]
    ) -> tuple[float, Array] | None:
        """Return the first zero of a gauge that falls, turns and rises again within two steps."""
        if len(known) < 3:
            return None
        left, middle, right = known[-3:]
        for key, gauge in middle[1].items():
            sides = [side[1].get(key) for side in (left, right)]
            if not _may_dip([gauge.value, *(s.value for s in sides if s is not None)]):
                continue

            def at(value: float, key: tuple[str, str] = key) -> float:
                here, _ = self.path.gauges(active, value, middle[2])
                return here[key].value if key in here else 1.0

            bounds = (min(left[0], right[0]), max(left[0], right[0]))
            lowest = minimize_scalar(at, bounds=bounds, method="bounded")
            if lowest.fun < 0.0:
                gauges, z = self.path.gauges(active, float(lowest.x), middle[2])
                return self._first_zero(active, left, (float(lowest.x), gauges, z), [key])
        return None

    def _beyond(self, first: End, value: float, z: Array, last: End) -> End | None:
        """Return a certified end just beyond an event, as close as tells it from the next one."""
        sign = 1.0 if last.value > first.value else -1.0
        gauges = self._due(first.active, value, z, sign)
        due = {g.element for g in gauges}
        aside = ASIDE * self.span
        while aside >= NEAREST * self.span:
            there = value + sign * aside
            end = (
                last
                if (there - last.value) * sign >= 0.0
                else self._end(there, replace(first, z=z), gauges)
            )
            changed = set(first.active.changes(end.active))
            if changed and changed <= due:
                return end
            aside *= 0.1
        return None

    def _due(self, active: ActiveSet, value: float, z: Array, sign: float) -> list[Gauge]:
        """Gauges that are zero at a value, or jump below zero there."""
        gauges, z = self.path.gauges(active, value, z)
        due = [g for g in gauges.values() if abs(g.value) <= ZERO]
        try:
            gauges, _ = self.path.gauges(active, value + sign * NEAREST * self.span, z)
        except BranchLost:
            return due
        known = {g.element for g in due}
        return due + [g for g in gauges.values() if g.value < 0.0 and g.element not in known]

    def _told(self, first: End, value: float, beyond: End) -> Iterator[Event]:
        """Yield the elements that change at a value, confirmed on the near side as well."""
        sign = 1.0 if beyond.value > value else -1.0
        aside = min(abs(beyond.value - value), 0.5 * abs(value - first.value))
        near = self._end(value - sign * max(aside, NEAREST * self.span), first)
        confirmed = near.active == first.active
        lower, upper = (near, beyond) if sign > 0.0 else (beyond, near)
        worst = max(near.worst, beyond.worst)
        scene = self.path.scene(value)
        before, after = (
            (first.active, beyond.active) if sign > 0.0 else (beyond.active, first.active)
        )
        changed = before.changes(after)
        for element in changed:
            kind, gear = told(scene, element, before, after)
            yield Event(
                value=value,
                unit=self.path.parameter.unit,
                position=self.path.position,
                element=element,
                gear=gear,
                kind=kind,
                before=before.state(element),
                after=after.state(element),
                together=len(changed),
                confirmed=confirmed,
                worst=worst,
                apart=max(value - lower.value, upper.value - value),
            )


def _may_dip(values: list[float]) -> bool:
    """Whether a gauge could turn negative near its lowest of three points, given first.

    The parabola through the points tells how much deeper it goes; half of the way is allowed for.
    """
    if len(values) < 3:
        return False
    middle, left, right = values
    if not middle < min(left, right):
        return False
    bend = left + right - 2.0 * middle
    return middle - (right - left) ** 2 / (8.0 * bend) < 0.5 * middle
