"""Every change of the set along a parameter: stretches are proved, or halved until they are.

A stretch between two certified points that stand on one set is proved to hold no event. One whose
ends differ is cut at the value where a gauge of either end vanishes: its two parts are proved on
their own sets, up to the event itself. Whatever is not proved is cut again, down to a width at
which it is named. Nothing depends on where the range ends.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from loadshare.errors import Refused
from loadshare.scene.scene import Array
from loadshare.solver.hot import places as at
from loadshare.study.follow.active import ActiveSet, Codes, read_pieces
from loadshare.study.follow.centre import centred
from loadshare.study.follow.equations import Equations
from loadshare.study.follow.gauges import gauges_at
from loadshare.study.follow.line import Line, Solved
from loadshare.study.follow.numbers import Numbers
from loadshare.study.follow.proof import VERGE, prove
from loadshare.study.follow.ranges import NODES, Flags
from loadshare.study.follow.stretches import Stretches
from loadshare.study.follow.zero import first_zero

FIRST = 8
"""Stretches at the beginning."""
CUT = 0.4877
"""Where a stretch is cut: no simple fraction, for those are where thresholds stand."""
BESIDE = 0.05
"""Distance from an event at which a stretch is cut, over its width."""
LEAST = 1e-10
"""Width of a stretch that is not cut any more, over the largest value."""
MOST = 2000
"""Stretches of a position; what is left then is named as not proved."""
IDLE = 1e-11
"""Force and compression, over load and deflection, at which a closed contact carries nothing."""
UNREAD = "the active set of its equilibrium could not be told"
"""Why a certified answer is no point."""
SECTIONS = 9
"""Values between two ends at which the gauges of one are looked at."""
GRADE = 0.5
"""Ratio of stretches that shrink towards an event."""
RESOLVED = 1e-9
"""Distance from an event that counts as the event itself, over its value."""


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """A certified point on a set.

    Attributes
    ----------
    value : float
    active : ActiveSet
    z : ndarray
    worst : float
        Worst scaled residual of its certificate.
    """

    value: float
    active: ActiveSet
    z: Array
    worst: float


@dataclass(frozen=True, slots=True)
class Change:
    """A change of the set.

    Attributes
    ----------
    value : float
    before, after : ActiveSet
    confirmed : bool
        Whether both sides were proved up to it.
    worst : float
        Larger one of the worst residuals on both sides.
    apart : float
        Distance of the certified points on both sides.
    """

    value: float
    before: ActiveSet
    after: ActiveSet
    confirmed: bool
    worst: float
    apart: float


@dataclass(frozen=True, slots=True)
class Gap:
    """An interval in which nothing was proved, why, and what stands at its ends."""

    start: float
    stop: float
    why: str
    first: Point | str
    last: Point | str


Stretch = tuple[Point | str, Point | str, float, float]


class Search:
    """The changes of one position between two values.

    Parameters
    ----------
    line : Line
    position : int
        1-based.
    low, high : float
    """

    def __init__(self, line: Line, position: int, low: float, high: float) -> None:
        self.line, self.position, self.low, self.high = line, position, low, high
        # Which contacts are rigid or curved anywhere on the way.
        self._anywhere = line.numbers(position, np.linspace(low, high, 3))
        self.least = LEAST * max(abs(low), abs(high))
        self.changes: list[Change] = []
        self.gaps: list[Gap] = []
        self._equations: dict[ActiveSet, Equations] = {}
        self._hints: dict[tuple[float, float], float] = {}
        self._sharp: dict[float, bool] = {}

    def run(self) -> None:
        """Find all changes, by value, and what could not be proved.

        Raises
        ------
        Refused
            If an end has no certified equilibrium.
        """
        values = np.linspace(self.low, self.high, FIRST + 1)
        points = self.points(values)
        for end, point in ((self.low, points[0]), (self.high, points[-1])):
            if isinstance(point, str) and point != UNREAD:
                parameter = self.line.parameter
                shown = f"{parameter.name} = {end:.12g} {parameter.unit}".rstrip()
                raise Refused(f"at {shown}: {point}")
        ends = values.tolist()
        stretches = list(zip(points[:-1], points[1:], ends[:-1], ends[1:], strict=True))
        count = 0
        while stretches:
            count += len(stretches)
            left = [s for s in stretches if not self._settled(s)]
            left = self._proved_alike(left)
            left = [s for s in left if not self._crossed(s)] if count <= MOST else left
            if count > MOST:
                for stretch in left:
                    self._give_up(stretch, "too many stretches")
                break
            stretches = self._cut(left)
        self.gaps = merged(self.gaps)
        self.changes += [c for c in map(self._unconfirmed, self.gaps) if c is not None]
        self.changes.sort(key=lambda c: c.value)

    # --- Points ---------------------------------------------------------------------------------

    def points(self, values: Array) -> list[Point | str]:
        """Return certified points, or why there is none."""
        found: list[Point | str] = []
        groups: dict[tuple[int, ...], list[int]] = {}
        for k, solved in enumerate(self.line.solved(self.position, values)):
            found.append(solved if isinstance(solved, str) else UNREAD)
            if isinstance(solved, Solved):
                groups.setdefault(tuple(solved.code.tolist()), []).append(k)
                found[k] = solved  # type: ignore[call-overload]
        for code, rows in groups.items():
            known = [found[k] for k in rows]
            for k, point in zip(rows, self._read(code, known), strict=True):  # type: ignore[arg-type]
                found[k] = point
        return found

    def _read(self, code: tuple[int, ...], solved: list[Solved]) -> list[Point | str]:
        """Solve points of one code to round-off, on the set of what carries."""
        numbers = self.line.numbers(self.position, np.array([s.value for s in solved]))
        found: list[Point | str] = [UNREAD] * len(solved)
        waiting = [(k, code, s.x) for k, s in enumerate(solved)]
        for _ in range(3):
            groups: dict[ActiveSet, list[tuple[int, Array]]] = {}
            for k, own, x in waiting:
                active = self._set(own, x, numbers.take(slice(k, k + 1)))
                groups.setdefault(active, []).append((k, x))
            waiting = []
            for active, members in groups.items():
                rows = np.array([k for k, _ in members])
                some = numbers.take(rows)
                equations = self.equations(active)
                z = equations.start(np.array([x for _, x in members]), some)
                z, good = equations.solve(z, some)
                carries = self._carrying(equations, z, some)
                z = centred(equations, z, some)
                for i, k in enumerate(rows.tolist()):
                    x, own = z[i, : equations.n], tuple(carries[i].tolist())
                    if not good[i]:
                        continue
                    if self._set(own, x, numbers.take(slice(k, k + 1))) == active:
                        found[k] = Point(solved[k].value, active, z[i], solved[k].worst)
                    else:
                        waiting.append((k, own, x))
        return found

    def _set(self, code: tuple[int, ...], x: Array, numbers: Numbers) -> ActiveSet:
        """Active set of a code at one value."""
        pieces = read_pieces(self.line.elements, numbers, code, x)
        return ActiveSet(code, pieces)

    def _carrying(self, equations: Equations, z: Array, numbers: Numbers) -> Codes:
        """Codes (S, switches) of the elements that carry something at points z."""
        code = np.repeat(equations.code[None], len(z), axis=0)
        state = equations.state(z, numbers)
        push = np.abs(numbers.load).max(axis=1, initial=0.0)
        band = IDLE * np.where(push > 0.0, push, 1.0)
        springs = equations.elements.springs
        columns = np.arange(springs, equations.scalars)
        moved = np.abs(state.approach[:, columns])
        moved[:, np.isin(columns, equations.rigid)] = 0.0
        idle = (np.abs(state.force[:, columns]) <= band[:, None]) & (moved <= IDLE)
        code[:, : len(columns)][idle] = at.OPEN
        for k, where in equations.polar_at.items():
            loose = np.abs(state.polars[k].size) <= band
            if k in equations.arcs and where is None:
                loose &= np.abs(state.margin[k]) <= IDLE
            elif k in equations.radials and equations.code[k] != at.WALL:
                # Whether it slips or sticks hangs on rounding once its friction is gone.
                loose &= np.abs(state.laws[k].bound) <= band
            code[loose, k] = at.OPEN
        return code

    def equations(self, active: ActiveSet) -> Equations:
        """Return the equations of a set, set up once."""
        if active not in self._equations:
            self._equations[active] = Equations(self.line.elements, active, self._anywhere)
        return self._equations[active]

    # --- Proofs ---------------------------------------------------------------------------------

    def _settled(self, stretch: Stretch) -> bool:
        """Give up a stretch that is not worth cutting."""
        first, last, low, high = stretch
        if isinstance(first, str) and isinstance(last, str):
            self._give_up(stretch, first)
            return True
        if high - low <= self.least:
            self._give_up(stretch, "nothing could be proved however near")
            return True
        return False

    def _give_up(self, stretch: Stretch, why: str) -> None:
        """Name a stretch as not proved."""
        first, last, low, high = stretch
        self.gaps.append(Gap(low, high, why, first, last))

    def _unconfirmed(self, gap: Gap) -> Change | None:
        """Return the change between the ends of what is not proved, if there is one."""
        first, last = gap.first, gap.last
        if not (isinstance(first, Point) and isinstance(last, Point)):
            return None
        if first.active.code == last.active.code:
            return None
        # What was found last was found from nearest.
        value = 0.5 * (gap.start + gap.stop)
        for hint in self._hints.values():
            value = hint if gap.start <= hint <= gap.stop else value
        apart = max(value - gap.start, gap.stop - value)
        return Change(value, first.active, last.active, False, max(first.worst, last.worst), apart)

    def _stretches(
        self, equations: Equations, ends: list[tuple[float, float, Array, Array]]
    ) -> Stretches:
        """Set up stretches (low, high, z at both) of one set."""
        tau = np.linspace(0.0, 1.0, NODES)
        values = np.concatenate([low + tau * (high - low) for low, high, *_ in ends])
        numbers = self.line.numbers(self.position, values)
        return Stretches(equations, np.array([[a, b] for _, _, a, b in ends]), numbers)

    def _proved_alike(self, stretches: list[Stretch]) -> list[Stretch]:
        """Prove those whose ends stand on one set, and return the others."""
        groups: dict[ActiveSet, list[Stretch]] = {}
        left: list[Stretch] = []
        for stretch in stretches:
            first, last, *_ = stretch
            if isinstance(first, Point) and isinstance(last, Point) and first.active == last.active:
                groups.setdefault(first.active, []).append(stretch)
            else:
                left.append(stretch)
        for active, group in groups.items():
            ends = [(low, high, a.z, b.z) for a, b, low, high in group]  # type: ignore[union-attr]
            holds = prove(self._stretches(self._equations[active], ends)).holds
            failed = [s for s, good in zip(group, holds, strict=True) if not good]
            left += [s for s in failed if not self._hidden(active, s)]
        return left

    def _hidden(self, active: ActiveSet, stretch: Stretch) -> bool:
        """Give up a stretch at both ends of which round-off alone leaves no enclosure."""
        if any(self._is_sharp(active, p) for p in stretch[:2] if isinstance(p, Point)):
            return False
        self._give_up(stretch, "round-off hides what holds its bodies")
        return True

    def _is_sharp(self, active: ActiveSet, point: Point) -> bool:
        """Whether a point is enclosed by itself."""
        if point.value not in self._sharp:
            ends = [(point.value, point.value, point.z, point.z)]
            enclosed = prove(self._stretches(self._equations[active], ends)).enclosed
            self._sharp[point.value] = bool(enclosed[0])
        return self._sharp[point.value]

    def _crossed(self, stretch: Stretch) -> bool:
        """Find and prove the change between two ends; on failure note where it may stand."""
        first, last, low, high = stretch
        if (
            not (isinstance(first, Point) and isinstance(last, Point))
            or first.active == last.active
        ):
            return False
        # Where a body comes to float, room is exacter than forces that vanish all together.
        ways = [(first, last), (last, first)]
        ways.sort(key=lambda way: not self._equations[way[0].active].floats)
        value = self._exit(*ways[0])
        if value is None:
            value = self._exit(*ways[1])
        if value is None:
            return False
        self._hints[low, high] = value
        if not all(self._reaches(point, value) for point in (first, last)):
            return False
        apart = float(max(value - low, high - value))
        worst = max(first.worst, last.worst)
        if first.active.code != last.active.code:
            self.changes.append(Change(value, first.active, last.active, True, worst, apart))
        return True

    def _reaches(self, point: Point, value: float) -> bool:
        """Whether a point's set is proved to hold up to an event at a value."""
        if value == point.value:
            return True
        equations = self._equations[point.active]
        z, good = self._solved(equations, np.array([value]), point.z[None])
        if good[0] and self._proved(equations, [point.value, value], np.array([point.z, z[0]])):
            return True
        # Bodies active by vanishing forces alone: their equations become singular at the event, so
        # stretches shrink towards it, down to what counts as the event itself.
        parts = [(value - point.value) * GRADE**k for k in range(200)]
        near = RESOLVED * max(abs(value), abs(value - point.value))
        values = np.array([value - part for part in parts if abs(part) > near])
        if len(values) < 2:
            return True
        z, good = self._solved(equations, values, np.repeat(point.z[None], len(values), axis=0))
        return bool(good.all()) and self._proved(equations, values.tolist(), z)

    def _proved(self, equations: Equations, values: list[float], z: Array) -> bool:
        """Whether a set is proved to hold between neighbouring values."""
        pairs = list(zip(values[:-1], values[1:], z[:-1], z[1:], strict=True))
        ends = [(a, b, p, q) if a < b else (b, a, q, p) for a, b, p, q in pairs]
        return bool(prove(self._stretches(equations, ends)).holds.all())

    def _solved(self, equations: Equations, values: Array, near: Array) -> tuple[Array, Flags]:
        """Solve a set at values (S,), from unknowns near by; what nothing holds is centred."""
        numbers = self.line.numbers(self.position, values)
        z, good = equations.solve(near, numbers)
        return centred(equations, z, numbers), good

    def _gauges(self, equations: Equations, values: Array, near: Array) -> tuple[Array, Flags]:
        """Gauges (S, gauges) of a set at values, and whether it has a solution there."""
        numbers = self.line.numbers(self.position, values)
        z, good = equations.solve(near, numbers)
        z = centred(equations, z, numbers)
        with np.errstate(all="ignore"):
            found = gauges_at(Stretches.at_points(equations, z, numbers))
            return np.stack([gauge.first for gauge in found], axis=1), good

    def _exit(self, near: Point, far: Point) -> float | None:
        """Value at which the first gauge of one end's set vanishes on the way to the other."""
        equations = self._equations[near.active]
        values = np.linspace(near.value, far.value, SECTIONS)
        found = self._sections(equations, values, near.z)
        if found is None:
            return None
        values, gauges = found
        negative = gauges < 0.0
        negative[0] &= gauges[0] < -VERGE
        if negative[0].any():
            return float(near.value)
        beyond = np.flatnonzero(negative.any(axis=1))
        if not len(beyond):
            return None
        due = np.flatnonzero(negative[beyond[0]])
        least = gauges[:, due]
        if least[beyond[0] - 1].min() <= VERGE:
            return float(values[beyond[0] - 1])

        def asked(inner: Array) -> Array | None:
            inner = inner if far.value > near.value else inner[::-1]
            found = self._sections(equations, inner, near.z)
            if found is None or len(found[0]) < len(inner):
                return None
            here = found[1][:, due]
            return here if far.value > near.value else here[::-1]

        return first_zero(asked, values, least, int(beyond[0]))

    def _sections(
        self, equations: Equations, values: Array, near: Array
    ) -> tuple[Array, Array] | None:
        """Gauges of a set at values, up to the first at which it has no solution."""
        start = np.repeat(near[None], len(values), axis=0)
        gauges, good = self._gauges(equations, values, start)
        count = len(values) if good.all() else int(np.argmin(good))
        return (values[:count], gauges[:count]) if count else None

    # --- Cuts -----------------------------------------------------------------------------------

    def _cut(self, stretches: list[Stretch]) -> list[Stretch]:
        """Cut stretches, beside an event where one is expected."""
        cuts: list[list[float]] = []
        for _, _, low, high in stretches:
            width, hint = high - low, self._hints.get((low, high))
            inner = [low + CUT * width]
            if hint is not None:
                inner = [hint - BESIDE * width, hint + BESIDE * width]
            cuts.append([v for v in inner if low + 0.01 * width < v < high - 0.01 * width])
        flat = np.array([v for some in cuts for v in some])
        points = iter(self.points(flat) if len(flat) else [])
        found: list[Stretch] = []
        for (first, last, low, high), some in zip(stretches, cuts, strict=True):
            ends = [(low, first), *((v, next(points)) for v in some), (high, last)]
            for (a, one), (b, other) in pairwise(ends):
                found.append((one, other, a, b))
        return found


def merged(gaps: Iterable[Gap]) -> list[Gap]:
    """Join gaps that touch."""
    found: list[Gap] = []
    for gap in sorted(gaps, key=lambda g: g.start):
        if found and gap.start <= found[-1].stop:
            found[-1] = replace(found[-1], stop=gap.stop, last=gap.last)
        else:
            found.append(gap)
    return found
