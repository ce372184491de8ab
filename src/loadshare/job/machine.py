"""A machine that is reduced once and solved for many samples: the first rung of the ladder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TypeVar, cast

import numpy as np

from loadshare import compilation
from loadshare.array_types import Flags, Numbers, States
from loadshare.certify import Judge, Verdicts
from loadshare.certify.validity import Measuring
from loadshare.job.judging import Judging
from loadshare.job.ways import (
    Start,
    Way,
    by_any_way,
    by_rule,
    from_near,
    learned_rule,
    search_all,
    start_of,
    take_over,
    ways_from_rest,
)
from loadshare.scene.loading import Loading, loading_of
from loadshare.scene.structure import Structure, structure_of
from loadshare.settings import CERTIFY, JOB
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.answer import pin, without_noise
from loadshare.solver.hot.determined import determined
from loadshare.solver.hot.exchange import Engine
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.rule import Rule, samples_to_learn
from loadshare.train import Train
from loadshare.train.equilibria import Equilibria
from loadshare.train.placed import train_at
from loadshare.train.samples import Samples
from loadshare.train.situations import Situations, situation_of, situations_of, stack

Outcome = TypeVar("Outcome")


def _compiling(engine: Engine, act: Callable[[Engine], Outcome]) -> Outcome:
    """Call `act` with an engine, or with the vectorised one if that engine does not compile."""
    try:
        return act(engine)
    except Exception as error:
        if not compilation.is_failure(error):
            raise
        compilation.give_up(f"it does not compile ({compilation.words_of(error)})")
    compilation.log_why_not()
    return act(vectorised.settle)


@dataclass(frozen=True, eq=False)
class Answers:
    """Answers of the fast method to many samples.

    Attributes
    ----------
    loading : Loading
        The numbers of the samples.
    iterate : Iterate
        Where the solver ended.
    equilibria : Equilibria
    verdicts : Verdicts
    passed : ndarray of bool, shape (S,)
        Whether the answer is certified.
    states : ndarray of int8, shape (S, switches)
        Which elements act.
    turns : ndarray of int, shape (S,)
        Number of active sets visited.
    searched : ndarray of bool, shape (S,)
        Whether exchange alone found nothing, so that the proximal method went ahead.
    determine : callable
        Returns `determined`.
    """

    loading: Loading
    iterate: Iterate
    equilibria: Equilibria
    verdicts: Verdicts
    passed: Flags
    states: States
    turns: Numbers
    searched: Flags
    determine: Callable[[], Flags]

    @cached_property
    def determined(self) -> Flags:
        """Whether the forces determine every displacement of a sample, shape (S,).

        If they do not, the displacements given are one possible choice.
        """
        return self.determine()


class Machine:
    """A train reduced by the force method.

    Parameters
    ----------
    train : Train
    near : Machine, optional
        Machine of a similar case: if it has the same elements, samples begin at its solutions,
        provided that it solved as many.
    """

    def __init__(self, train: Train, near: Machine | None = None) -> None:
        self.train = train
        self._near: tuple[tuple[str, ...], Start] | None = None
        if near is not None and near._last is not None:
            # Not the machine itself: along a sweep each would keep all earlier ones in memory.
            self._near = near._names, near._last
        self._last: Start | None = None
        self._starts: dict[int, Start | None] = {}
        self._own: tuple[tuple[int, ...], Situations] | None = None
        self._placed: dict[int, Machine] = {}
        self._like: Machine | None = None
        self._rule: Rule | None = None

    @cached_property
    def structure(self) -> Structure:
        """Statics of the train."""
        return structure_of(self.train)

    @cached_property
    def judge(self) -> Judge:
        """Judge of its answers."""
        return Judge(self.train)

    @property
    def measuring(self) -> Measuring:
        """Measures of the displacements of its answers."""
        return self.judge.measuring

    @property
    def together(self) -> int:
        """Number of equilibria solved together: no more than fit into memory that is reused."""
        widest = max(len(self.at(1).structure.names), 3 * len(self.train.gears))
        return min(JOB.together, JOB.allocated // (8 * widest))

    def share(self, other: Machine) -> None:
        """Take over structure and judge of a machine that differs in its situations only."""
        self._like = other
        if self.train.is_placed_anew:
            return
        self.__dict__["structure"], self.__dict__["judge"] = other.structure, other.judge

    def at(self, index: int) -> Machine:
        """Return the machine of a position (1-based): itself, unless its train is placed anew."""
        if index not in self._placed:
            train = train_at(self.train, index)
            if train is self.train:
                return self
            machine = self._placed[index] = Machine(train)
            if self._like is not None:
                machine.share(self._like.at(index))
        return self._placed[index]

    def situations(self, indices: Sequence[int]) -> Situations:
        """Return the train's own situations at some positions, cached."""
        key = tuple(indices)
        if self._own is None or self._own[0] != key:
            self._own = key, situations_of(self.train, key)
        return self._own[1]

    @property
    def first_situation(self) -> Situations:
        """The train's own situation at position 1, from those of all positions if they are few."""
        if self.train.count > JOB.each:
            return situation_of(self.train, 1)
        return self.situations(range(1, self.train.count + 1)).take(slice(0, 1))

    def answer(
        self,
        situations: Situations,
        tolerance: float,
        engine: Engine,
        starts: Sequence[int] = (),
    ) -> Answers:
        """Solve and certify samples.

        Parameters
        ----------
        situations : Situations
        tolerance : float
            Largest scaled residual of a certified answer.
        engine : Engine
            If it does not compile, the vectorised one takes its place.
        starts : sequence of int, optional
            Positions (1-based) of equal parts of the samples, which begin at the train's own
            solution there.
        """
        return _compiling(
            engine, lambda engine: self._answer(situations, tolerance, engine, starts)
        )

    def learn(self, samples: Samples, positions: Sequence[int], engine: Engine) -> None:
        """Learn from some of many samples, over all positions, where all of them begin."""
        if self.train.is_placed_anew:
            for position in positions:
                self.at(position).learn(samples, [position], engine)
            return
        at, rows = np.divmod(samples_to_learn(samples.count * len(positions)), samples.count)
        if not len(rows):
            return
        situations = [
            samples.take(rows[at == k]).situations(positions[k]) for k in np.unique(at).tolist()
        ]
        loading = loading_of(self.structure, stack(situations))
        self._rule = _compiling(
            engine, lambda engine: learned_rule(self.structure, loading, engine)
        )

    def _answer(
        self, situations: Situations, tolerance: float, engine: Engine, starts: Sequence[int]
    ) -> Answers:
        loading, quick = loading_of(self.structure, situations), engine is not vectorised.settle
        ways, rule_first = self._ways(loading, engine, starts)
        iterate, found = ways[0](loading, np.arange(loading.count))
        left = ~found.solved
        tries = np.ones(loading.count, dtype=np.intp)
        searched, led = np.zeros((2, loading.count), dtype=bool)
        judging = Judging(self.structure, self.judge, situations, iterate, tolerance, quick)
        # Answers on the verge, which a rule may lead to, take long to bound; other ways may avoid
        # them.
        at_once = rule_first and quick and self.judge.compiles
        while True:
            found.solved[left] = False
            renewed = ~found.solved
            for number, way in enumerate(ways):
                fresh = np.flatnonzero(~found.solved & ~searched & (tries == number))
                if len(fresh):
                    take_over(iterate, found, fresh, *way(loading.take(fresh), fresh))
                    tries[fresh] += 1
            if not (starts or searched.any()) and found.solved.all():
                self._last = start_of(self.structure, loading, iterate, found)
            rows = np.flatnonzero(~found.solved & ~searched)
            some = search_all(self.structure, loading, iterate, found, rows, led, tolerance, engine)
            searched[some] = True
            pin(self.structure, loading, iterate, found.states)
            verdicts = judging.renewed(renewed, bounded=not at_once)
            unproved = found.solved & ~verdicts.passed & (verdicts.worst <= tolerance)
            if at_once and unproved.any():
                left, at_once = unproved, False
                continue
            if unproved.any() and without_noise(self.structure, iterate, unproved, searched):
                verdicts = judging.renewed(unproved)
            left = found.solved & ~verdicts.passed & ~searched
            if not left.any():
                break
        return Answers(
            loading,
            iterate,
            judging.answers,
            verdicts,
            found.solved & verdicts.passed,
            found.states,
            found.turns,
            searched,
            partial(determined, self.structure, loading, iterate, found.states, found.held, quick),
        )

    def _ways(
        self, loading: Loading, engine: Engine, starts: Sequence[int]
    ) -> tuple[list[Way], bool]:
        """Return the ways to solve some of the samples, in order, and whether a rule is first.

        If a start or compiled code fails, samples are solved once more from rest, then with NumPy,
        at last by exchanging one element at a time.
        """
        rule = self._rule if starts else None
        if starts and rule is None:
            some = samples_to_learn(loading.count)
            rule = learned_rule(self.structure, loading.take(some), engine) if len(some) else None
        ways: list[Way] = []
        if rule is not None:
            ways.append(lambda some, _: by_rule(self.structure, some, engine, rule))
        # Solving the train itself takes as long as a few samples.
        if loading.count > len(starts) > 0 or self._beside(loading.count) is not None:
            near = partial(self._near_ones, loading.count, starts, engine)
            ways.append(lambda some, rows: from_near(self.structure, some, engine, near(rows)))
        return ways + ways_from_rest(self.structure, engine), rule is not None

    def _at_starts(self, indices: Sequence[int], engine: Engine) -> list[Start | None]:
        """Return the train's own solutions at some positions; None where there is none."""
        new = [index for index in indices if index not in self._starts]
        if new:
            loading = loading_of(self.structure, self.situations(new))
            iterate, found = by_any_way(self.structure, loading, engine, CERTIFY.tolerance)
            every = start_of(self.structure, loading, iterate, found)
            for k, index in enumerate(new):
                start = every.of(k)
                self._starts[index] = start if found.solved[k] else None
        return [self._starts[index] for index in indices]

    def _near_ones(
        self, count: int, starts: Sequence[int], engine: Engine, rows: Numbers
    ) -> list[tuple[Numbers, Start]]:
        """Return starts of some of `count` samples, each with the numbers (in `rows`) it is for."""
        if not starts:
            every = cast(Start, self._beside(count))
            return [(np.arange(len(rows)), every.of(rows))]
        which, known = rows // (count // len(starts)), self._at_starts(starts, engine)
        parts = ((np.flatnonzero(which == k), start) for k, start in enumerate(known))
        return [(part, start) for part, start in parts if start is not None]

    def _beside(self, count: int) -> Start | None:
        """Return the start that a similar machine gives as many samples; None if it has none."""
        if self._near is None:
            return None
        names, start = self._near
        return start if names == self._names and len(start.states) == count else None

    @property
    def _names(self) -> tuple[str, ...]:
        """Names of contacts and kinds of forces, in order."""
        return (*self.structure.row_names, *self.structure.kinds)
