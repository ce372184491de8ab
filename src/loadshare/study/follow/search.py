"""Search for all changes of the set along a parameter: stretches are proved, or cut until they are.

A stretch between two certified points on one set is proved to hold no event. One whose ends have
different sets is cut at the value where a gauge of either end vanishes: its two parts are proved on
their own sets, up to the event itself. Where more points may help, a stretch is cut again, down to
a width at which it is listed as not proved; where round-off hides what holds a body, they do not
help, and it is listed at once. Nothing depends on where the range ends.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import compress, pairwise

import numpy as np

from loadshare.array_types import Array, Flags, States
from loadshare.errors import Refused
from loadshare.settings import FOLLOW
from loadshare.solver.hot import contact_states as at
from loadshare.study.follow.active import WorkingSet, set_of
from loadshare.study.follow.centre import centred
from loadshare.study.follow.changes import (
    Change,
    Gap,
    PathPoint,
    Stretch,
    change_between,
    distinct,
    merged,
)
from loadshare.study.follow.equations import Equations
from loadshare.study.follow.gauges import gauges_at
from loadshare.study.follow.line import Line, Missing, SolvedValue
from loadshare.study.follow.numbers import Numbers
from loadshare.study.follow.parts import HIDDEN, Prover, between
from loadshare.study.follow.stretches import Stretches
from loadshare.study.follow.zero import first_zero

UNREAD = "the active set of its equilibrium could not be identified"
"""Why a certified answer is not a point."""


class ChangeSearch:
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
        # Decides which contacts are rigid or curved anywhere in the range.
        self._anywhere = line.numbers(position, np.linspace(low, high, 3))
        self.least = FOLLOW.least * max(abs(low), abs(high))
        self.prover = Prover(line, position, self.least)
        self.changes: list[Change] = []
        self.gaps: list[Gap] = []
        self._equations: dict[WorkingSet, Equations] = {}
        self._hints: dict[tuple[float, float], float] = {}

    def run(self) -> None:
        """Find all changes, by value, and the gaps that could not be proved.

        Raises
        ------
        Refused
            If an end has no certified equilibrium.
        """
        values = np.linspace(self.low, self.high, FOLLOW.first + 1)
        points = self.points(values)
        for point in (points[0], points[-1]):
            if isinstance(point, Missing) and point.why != UNREAD:
                parameter = self.line.parameter
                shown = f"{parameter.name} = {point.value:.12g} {parameter.unit}".rstrip()
                raise Refused(f"at {shown}: {point.why}")
        stretches = list(pairwise(points))
        count = generation = 0
        while stretches:
            count, generation = count + len(stretches), generation + 1
            left = [s for s in stretches if not self._settled(s)]
            left = self.proved_alike(left)
            left = [s for s in left if not self._crossed(s)] if count <= FOLLOW.most else left
            if count > FOLLOW.most:
                self.gaps += [Gap(*stretch, "it needs too many parts") for stretch in left]
                break
            stretches = self._cut(
                self._hopeful(left, values) if generation > FOLLOW.hopeful else left
            )
        self.gaps = merged(self.gaps)
        self.changes += [c for c in map(self._unconfirmed, self.gaps) if c is not None]
        self.changes = distinct(self.changes, self.least)

    # --- Points ---------------------------------------------------------------------------------

    def points(self, values: Array) -> list[PathPoint | Missing]:
        """Return certified points, solved to round-off on the set of elements that carry."""
        answers, structure = self.line.solved(self.position, values), self.line.structure
        solved = {k: a for k, a in enumerate(answers) if isinstance(a, SolvedValue)}
        found: list[PathPoint | Missing] = [
            Missing(a.value, UNREAD) if isinstance(a, SolvedValue) else a for a in answers
        ]
        waiting = [(k, tuple(s.states.tolist()), s.x) for k, s in solved.items()]
        # Idle contacts may have to open one at a time.
        for _ in range(structure.switches + 1):
            if not waiting:
                break
            groups: dict[WorkingSet, list[tuple[int, Array]]] = {}
            for k, states, x in waiting:
                numbers = self.line.numbers(self.position, values[[k]])
                groups.setdefault(set_of(structure, numbers, states, x), []).append((k, x))
            waiting = []
            for active, members in groups.items():
                rows = [k for k, _ in members]
                numbers = self.line.numbers(self.position, values[rows])
                equations = self.equations(active)
                z = equations.start(np.array([x for _, x in members]), numbers)
                z, good = equations.solve(z, numbers)
                carries = self._carrying(equations, z, numbers)
                z = centred(equations, z, numbers)
                for i in np.flatnonzero(good).tolist():
                    k, x, states = rows[i], z[i, : equations.n], tuple(carries[i].tolist())
                    if set_of(structure, numbers.row(i), states, x) == active:
                        found[k] = PathPoint(solved[k].value, active, z[i], solved[k].worst)
                    else:
                        waiting.append((k, states, x))
        return found

    def _carrying(self, equations: Equations, z: Array, numbers: Numbers) -> States:
        """Return the contact states (S, switches) at points z, idle elements open."""
        states = np.repeat(equations.states[None], len(z), axis=0)
        state = equations.state(z, numbers)
        push = np.abs(numbers.load).max(axis=1, initial=0.0)
        band = FOLLOW.idle * np.where(push > 0.0, push, 1.0)
        springs = equations.structure.springs
        columns = np.arange(springs, equations.scalars)
        moved = np.abs(state.approach[:, columns])
        moved[:, np.isin(columns, equations.rigid)] = 0.0
        # An idle body may touch: an error of its displacement is no compression.
        lengths = equations.lengths(np.abs(z[:, : equations.n]), numbers)
        rounding = FOLLOW.rounded * np.finfo(float).eps * lengths[:, columns]
        light = np.maximum(band[:, None], state.slope[:, columns] * rounding)
        idle = np.abs(state.force[:, columns]) <= light
        idle &= moved <= np.maximum(FOLLOW.idle, rounding)
        states[:, : len(columns)][idle] = at.OPEN
        for k, where in equations.polar_at.items():
            loose = np.abs(state.polars[k].size) <= band
            if k in equations.arcs and where is None:
                loose &= np.abs(state.margin[k]) <= FOLLOW.idle
            elif k in equations.radials and equations.states[k] != at.WALL:
                # Once its friction is gone, whether it slips or sticks depends on rounding.
                loose &= np.abs(state.laws[k].bound) <= band
            states[loose, k] = at.OPEN
        return states

    def equations(self, active: WorkingSet) -> Equations:
        """Return the equations of a set, set up once."""
        if active not in self._equations:
            self._equations[active] = Equations(self.line.structure, active, self._anywhere)
        return self._equations[active]

    # --- Proofs ---------------------------------------------------------------------------------

    def _settled(self, stretch: Stretch) -> bool:
        """Return whether a stretch is not worth cutting; it is then given up."""
        first, last = stretch
        if isinstance(first, Missing) and isinstance(last, Missing):
            self.gaps.append(Gap(first, last, first.why))
            return True
        if last.value - first.value <= self.least:
            self.gaps.append(Gap(first, last, "no proof was found, however narrow"))
            return True
        return False

    def _hopeful(self, stretches: list[Stretch], values: Array) -> list[Stretch]:
        """Give up stretches between two of the first values if no part there was proved so far."""
        width = np.array([last.value - first.value for first, last in stretches])
        middle = np.array([0.5 * (first.value + last.value) for first, last in stretches])
        of = np.searchsorted(values, middle) - 1
        left = np.bincount(of, width, len(values) - 1)
        hopeless = np.isclose(left, np.diff(values))[of]
        self.gaps += [Gap(*s, "no part of it was proved") for s in compress(stretches, hopeless)]
        return list(compress(stretches, ~hopeless))

    def _unconfirmed(self, gap: Gap) -> Change | None:
        """Return the change between the ends of a gap, if there is one."""
        first, last = gap.first, gap.last
        if not (isinstance(first, PathPoint) and isinstance(last, PathPoint)):
            return None
        if first.active.states == last.active.states:
            return None
        # The last hint was found from the nearest points.
        value = 0.5 * (first.value + last.value)
        for hint in self._hints.values():
            value = hint if first.value <= hint <= last.value else value
        if first.value <= 0.0 <= last.value and abs(value) < self.least:
            value = 0.0
        return change_between(first, last, value)

    def proved_alike(self, stretches: list[Stretch]) -> list[Stretch]:
        """Prove stretches whose ends have the same set, and return the others."""
        groups: dict[WorkingSet, list[tuple[PathPoint, PathPoint]]] = {}
        left: list[Stretch] = []
        for first, last in stretches:
            if (
                isinstance(first, PathPoint)
                and isinstance(last, PathPoint)
                and first.active == last.active
            ):
                groups.setdefault(first.active, []).append((first, last))
            else:
                left.append((first, last))
        for active, group in groups.items():
            ends = [(a.value, b.value, a.z, b.z) for a, b in group]
            parts = self.prover.unproved(self._equations[active], ends)
            lost = {part.number for part in parts if not part.why}
            left += [group[k] for k in sorted(lost)]
            for k, (low, high, p, q), why in parts:
                if k not in lost:
                    worst = max(point.worst for point in group[k])
                    first, last = (PathPoint(v, active, z, worst) for v, z in ((low, p), (high, q)))
                    self.gaps.append(Gap(first, last, why))
        return left

    def _crossed(self, stretch: Stretch) -> bool:
        """Find and prove the change between two ends; if that fails, note where it may be."""
        first, last = stretch
        if isinstance(first, Missing) or isinstance(last, Missing) or first.active == last.active:
            return False
        # Where a body begins to float, its room is more exact than forces that all vanish there.
        ways = [(first, last), (last, first)]
        ways.sort(key=lambda way: not self._equations[way[0].active].floats)
        exits = ((self.exit(*way), *way) for way in ways)
        value, near, far = next((e for e in exits if e[0] is not None), (None, first, last))
        if value is None:
            return False
        self._hints[first.value, last.value] = value
        # If there are several changes between the ends, the far end's set does not hold here.
        beyond = self._reached(far, value)
        before = self._reached(near, value) if beyond else None
        if not (before and beyond):
            return False
        low, high = sorted((before, beyond), key=lambda point: point.value)
        if low.value < high.value:
            self.gaps.append(Gap(low, high, HIDDEN))
        elif first.active.states != last.active.states:
            self.changes.append(change_between(first, last, value, confirmed=True))
        return True

    def _reached(self, point: PathPoint, value: float) -> PathPoint | None:
        """Return how far a point's set is proved to hold towards an event at a value, as a point.

        It is short of the event only where round-off hides everything nearer; None where more
        points may help.
        """
        if value == point.value:
            return point
        equations = self._equations[point.active]
        # Where bodies are held by vanishing forces alone, the equations become singular at the
        # event, so stretches shrink towards it, down to what counts as the event itself.
        steps = [(value - point.value) * FOLLOW.grade**k for k in range(200)]
        near = FOLLOW.resolved * max(abs(value), abs(value - point.value))
        values = [value - step for step in steps if abs(step) > near]
        two = np.array([value, values[-1] if values else value])
        z, good, _ = self._solved(equations, two, point.z)
        event = replace(point, value=value, z=z[0])
        whole = between([point.value, value], [point.z, z[0]])
        if good[0] and self.prover.proof(equations, whole).holds[0]:
            return event
        if len(values) < 2:
            return event
        last = self.prover.proof(equations, [(values[-1], values[-1], z[1], z[1])])
        if not good[1] or (last.enclosed[0] and not last.holds[0]):
            return None
        z, good, _ = self._solved(equations, np.array(values), point.z)
        if not good.all():
            return None
        left = self.prover.unproved(equations, between(values, z))
        if not left:
            return event
        proved = min(part.number for part in left)
        beyond = self.prover.proof(
            equations, [(values[k], values[k], z[k], z[k]) for k in range(proved + 1, len(values))]
        )
        # The set is not left on the way: it holds where that can be decided; at the end it cannot.
        hidden = not beyond.enclosed[-1] and (beyond.holds == beyond.enclosed).all()
        return replace(point, value=values[proved], z=z[proved]) if hidden else None

    def _solved(
        self, equations: Equations, values: Array, near: Array
    ) -> tuple[Array, Flags, Numbers]:
        """Solve a set at values (S,) from nearby unknowns; bodies that float free are centred."""
        numbers = self.line.numbers(self.position, values)
        z, good = equations.solve(np.repeat(near[None], len(values), axis=0), numbers)
        return centred(equations, z, numbers), good, numbers

    def exit(self, near: PathPoint, far: PathPoint) -> float | None:
        """Return the value at which a set is left on the way to another, None if it is not found.

        This is where the first gauge of the near end's set vanishes.
        """
        equations = self._equations[near.active]
        values = np.linspace(near.value, far.value, FOLLOW.sections)
        found = self._sections(equations, values, near.z)
        if found is None:
            return None
        values, gauges = found
        negative = gauges < 0.0
        negative[0] &= gauges[0] < -FOLLOW.verge
        if negative[0].any():
            return float(near.value)
        beyond = np.flatnonzero(negative.any(axis=1))
        if not len(beyond):
            return None
        due = np.flatnonzero(negative[beyond[0]])
        least = gauges[:, due]
        if least[beyond[0] - 1].min() <= FOLLOW.verge:
            return float(values[beyond[0] - 1])

        def due_gauges(inner: Array) -> Array | None:
            inner = inner if far.value > near.value else inner[::-1]
            found = self._sections(equations, inner, near.z)
            if found is None or len(found[0]) < len(inner):
                return None
            here = found[1][:, due]
            return here if far.value > near.value else here[::-1]

        return first_zero(due_gauges, values, least, int(beyond[0]))

    def _sections(
        self, equations: Equations, values: Array, near: Array
    ) -> tuple[Array, Array] | None:
        """Return the gauges of a set at values, up to the first at which it has no solution."""
        z, good, numbers = self._solved(equations, values, near)
        with np.errstate(all="ignore"):
            found = gauges_at(Stretches.at_points(equations, z, numbers))
            gauges = np.stack([gauge.first for gauge in found], axis=1)
        count = len(values) if good.all() else int(np.argmin(good))
        return (values[:count], gauges[:count]) if count else None

    # --- Cuts -----------------------------------------------------------------------------------

    def _cut(self, stretches: list[Stretch]) -> list[Stretch]:
        """Cut stretches, next to an event where one is expected."""
        cuts: list[list[float]] = []
        for first, last in stretches:
            low, width = first.value, last.value - first.value
            hint = self._hints.get((first.value, last.value))
            inner = [low + FOLLOW.cut * width]
            if hint is not None:
                inner = [hint - FOLLOW.beside * width, hint + FOLLOW.beside * width]
            cuts.append([v for v in inner if low + 0.01 * width < v < last.value - 0.01 * width])
        flat = np.array([v for some in cuts for v in some])
        points = iter(self.points(flat) if len(flat) else [])
        found: list[Stretch] = []
        for (first, last), some in zip(stretches, cuts, strict=True):
            found += pairwise([first, *(next(points) for _ in some), last])
        return found
