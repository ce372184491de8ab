"""A machine reduced once, and solved for many samples: the first rung of the ladder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TypeVar, cast

import numpy as np

from loadshare import compilation
from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.certify import Judge, Verdicts
from loadshare.certify.validity import Measuring
from loadshare.job.judging import Judging
from loadshare.scene.loading import Loading, loading_of
from loadshare.scene.structure import Structure, structure_of
from loadshare.settings import JOB
from loadshare.solver.balance import is_unbalanced
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.answer import pin, without_noise
from loadshare.solver.hot.determined import determined
from loadshare.solver.hot.exchange import Engine, Found, exchange, first_sets
from loadshare.solver.hot.iterate import Iterate, at_rest, pushes
from loadshare.solver.hot.proximal import search
from loadshare.solver.hot.rule import Rule, rule_of, samples_to_learn
from loadshare.train import Train
from loadshare.train.equilibria import Equilibria
from loadshare.train.placed import train_at
from loadshare.train.samples import Samples
from loadshare.train.situations import Situations, situation_of, situations_of, stack

Way = Callable[[Loading, Numbers], tuple[Iterate, Found]]
"""How some samples are solved, given with their numbers."""
Outcome = TypeVar("Outcome")


def _compiling(engine: Engine, act: Callable[[Engine], Outcome]) -> Outcome:
    """Act with an engine, or with the vectorised one in place of one that does not compile."""
    try:
        return act(engine)
    except Exception as error:
        if not compilation.is_failure(error):
            raise
        compilation.give_up(f"it does not compile ({compilation.words_of(error)})")
    compilation.tell_why_not()
    return act(vectorised.settle)


@dataclass(frozen=True, eq=False)
class Answers:
    """What the hot path makes of many samples.

    Attributes
    ----------
    loading : Loading
        The numbers of the samples.
    equilibria : Equilibria
    verdicts : Verdicts
    passed : ndarray of bool, shape (S,)
        Certified.
    states : ndarray of int8, shape (S, switches)
        Which elements act.
    turns : ndarray of int, shape (S,)
        Sets visited.
    searched : ndarray of bool, shape (S,)
        Whether exchange alone found nothing, and the proximal method went ahead.
    determine : callable
        Returns `determined`.
    """

    loading: Loading
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

        Where they do not, the place given is one possible choice.
        """
        return self.determine()


@dataclass(frozen=True, slots=True, eq=False)
class _Start:
    """Where samples begin: contacts and forces as in an equilibrium that is near.

    One row for all samples, or one for each. Radial elements begin on their first piece all the
    same: a slip is found from stick more surely than from another sample's slip.
    """

    states: States
    share: Array


class Machine:
    """A train reduced by the force method.

    Parameters
    ----------
    train : Train
    near : Machine, optional
        Of a case that differs little: where it has the same elements, positions begin at what it
        found for as many.
    """

    def __init__(self, train: Train, near: Machine | None = None) -> None:
        self.train = train
        self._near: tuple[tuple[str, ...], _Start] | None = None
        if near is not None and near._last is not None:
            # Not the machine itself: along a sweep each would hold all those before it.
            self._near = near._names, near._last
        self._last: _Start | None = None
        self._starts: dict[int, _Start | None] = {}
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
        """Its certificate."""
        return Judge(self.train)

    @property
    def measuring(self) -> Measuring:
        """What is measured on the displacements of its answers."""
        return self.judge.measuring

    @property
    def together(self) -> int:
        """Equilibria that are solved together: no more than memory is used again for."""
        widest = max(len(self.at(1).structure.names), 3 * len(self.train.gears))
        return min(JOB.together, JOB.allocated // (8 * widest))

    def share(self, other: Machine) -> None:
        """Take over what is reduced of a machine that differs in its situations only."""
        self._like = other
        if self.train.is_placed_anew:
            return
        self.__dict__["structure"], self.__dict__["judge"] = other.structure, other.judge

    def at(self, index: int) -> Machine:
        """Return the machine of a position (1-based): itself, unless its train is placed again."""
        if index not in self._placed:
            train = train_at(self.train, index)
            if train is self.train:
                return self
            machine = self._placed[index] = Machine(train)
            if self._like is not None:
                machine.share(self._like.at(index))
        return self._placed[index]

    def situations(self, indices: Sequence[int]) -> Situations:
        """Return the train's own situations at some positions, kept for the next time."""
        key = tuple(indices)
        if self._own is None or self._own[0] != key:
            self._own = key, situations_of(self.train, key)
        return self._own[1]

    @property
    def first_situation(self) -> Situations:
        """The train's own situation at the first position: one of all, where these are few."""
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
            Where it does not compile, the vectorised one takes its place.
        starts : sequence of int, optional
            Positions (1-based) at which equal parts of the samples begin where the train itself
            stands.
        """
        return _compiling(
            engine, lambda engine: self._answer(situations, tolerance, engine, starts)
        )

    def learn(self, samples: Samples, positions: Sequence[int], engine: Engine) -> None:
        """Learn from some of many samples, over all positions, where all begin."""
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
        self._rule = _compiling(engine, lambda engine: self._taught(loading, engine))

    def _answer(
        self, situations: Situations, tolerance: float, engine: Engine, starts: Sequence[int]
    ) -> Answers:
        loading, quick = loading_of(self.structure, situations), engine is not vectorised.settle
        ways, by_rule = self._ways(loading, engine, starts)
        iterate, found = ways[0](loading, np.arange(loading.count))
        left = ~found.solved
        tries = np.ones(loading.count, dtype=np.intp)
        searched, led = np.zeros((2, loading.count), dtype=bool)
        judging = Judging(self.structure, self.judge, situations, iterate, tolerance, quick)
        # What a rule has end on the verge takes long to bound; another way may end clear of it.
        at_once = by_rule and quick and self.judge.compiles(situations)
        while True:
            found.solved[left] = False
            renewed = ~found.solved
            for number, way in enumerate(ways):
                fresh = np.flatnonzero(~found.solved & ~searched & (tries == number))
                if len(fresh):
                    other, more = way(loading.take(fresh), fresh)
                    found.put(fresh, more)
                    better = np.flatnonzero(more.solved)
                    iterate.put(fresh[better], other.take(better))
                    tries[fresh] += 1
            if not (starts or searched.any()) and found.solved.all():
                self._last = self._as_start(loading, iterate, found)
            rows = np.flatnonzero(~found.solved & ~searched)
            searched[self._search(loading, iterate, found, rows, led, tolerance, engine)] = True
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
        """Ways to solve some of the samples, one after another; whether a rule is the first.

        A beginning or compiled code that fails: once more from rest, then with NumPy, at last by
        one element after another.
        """
        rule, numpy = self._rule if starts else None, vectorised.settle
        if starts and rule is None:
            some = samples_to_learn(loading.count)
            rule = self._taught(loading.take(some), engine) if len(some) else None
        ways: list[Way] = []
        if rule is not None:
            ways.append(lambda some, _: self._by_rule(some, engine, rule))
        # To find where the train itself stands takes as long as a few samples.
        if loading.count > len(starts) > 0 or self._beside(loading.count) is not None:
            near = partial(self._near_ones, loading.count, starts, engine)
            ways.append(lambda some, rows: self._from_near(some, engine, near(rows)))
        ways.append(lambda some, _: self._from_rest(some, engine))
        if engine is not numpy:
            ways.append(lambda some, _: self._from_rest(some, numpy))
        ways.append(lambda some, _: self._from_rest(some, numpy, singly=True))
        return ways, rule is not None

    def _from_rest(
        self, loading: Loading, engine: Engine, singly: bool = False
    ) -> tuple[Iterate, Found]:
        iterate = at_rest(self.structure, loading)
        return iterate, exchange(self.structure, loading, iterate, engine, singly=singly)

    def _from_near(
        self, loading: Loading, engine: Engine, near: Sequence[tuple[Numbers, _Start]]
    ) -> tuple[Iterate, Found]:
        """Let samples begin where the train itself stands, or a machine that differs little."""
        iterate, states = at_rest(self.structure, loading), first_sets(self.structure, loading)
        for rows, start in near:
            states[rows, : self.structure.rows] = start.states
            iterate.begin(rows, start.share, loading)
        return iterate, exchange(self.structure, loading, iterate, engine, states)

    def _taught(self, loading: Loading, engine: Engine) -> Rule | None:
        """Return the rule that samples teach; None if none of them is solved."""
        iterate, found = self._from_rest(loading, engine)
        if 2 * np.count_nonzero(found.solved) < loading.count:
            iterate, found = self._from_rest(loading, vectorised.settle, singly=True)
        known = np.flatnonzero(found.solved)
        if not len(known):
            return None
        return rule_of(
            self.structure, loading.take(known), found.states[known], iterate.take(known)
        )

    def _by_rule(self, loading: Loading, engine: Engine, rule: Rule) -> tuple[Iterate, Found]:
        """Let samples begin where a rule says."""
        states, iterate = rule.start(self.structure, loading)
        return iterate, exchange(self.structure, loading, iterate, engine, states)

    def _search(
        self,
        loading: Loading,
        iterate: Iterate,
        found: Found,
        rows: Numbers,
        led: Flags,
        tolerance: float,
        engine: Engine,
    ) -> Numbers:
        """Search equilibria of some samples by the proximal method, one by one.

        Others mostly end on the same set: they begin there, as long as that leads some of them to
        an answer. What was led and comes back was no equilibrium, and is searched for.

        Parameters
        ----------
        rows : ndarray of int
            Numbers of the samples.
        led : ndarray of bool, shape (S,)
            Which samples were led; renewed in place.

        Returns
        -------
        ndarray of int
            Which samples were searched for.
        """
        searched: list[int] = []
        left, leads = rows, True
        while len(left):
            row, left = left[:1], left[1:]
            searched += row.tolist()
            alone = loading.take(row)
            if is_unbalanced(self.structure, alone.load[0], tolerance):
                continue
            one, more = search(self.structure, alone)
            if not more.solved[0]:
                continue
            iterate.put(row, one)
            found.put(row, more)
            some = left[~led[left]]
            if leads and len(some):
                start = self._as_start(alone, one, more)
                every = np.arange(len(some))
                one, more = self._from_near(loading.take(some), engine, [(every, start)])
                better = np.flatnonzero(more.solved)
                iterate.put(some[better], one.take(better))
                found.put(some[better], more.take(better))
                leads = len(better) * JOB.led >= len(some)
                led[some[better]] = True
                left = np.setdiff1d(left, some[better], assume_unique=True)
        return np.array(searched, dtype=np.intp)

    def _at_starts(self, indices: Sequence[int], engine: Engine) -> list[_Start | None]:
        """What the train itself does at some positions; None if the hot path does not know."""
        new = [index for index in indices if index not in self._starts]
        if new:
            loading = loading_of(self.structure, self.situations(new))
            iterate = at_rest(self.structure, loading)
            found = exchange(self.structure, loading, iterate, engine)
            every = self._as_start(loading, iterate, found)
            for k, index in enumerate(new):
                start = _Start(every.states[k], every.share[k])
                self._starts[index] = start if found.solved[k] else None
        return [self._starts[index] for index in indices]

    def _near_ones(
        self, count: int, starts: Sequence[int], engine: Engine, rows: Numbers
    ) -> list[tuple[Numbers, _Start]]:
        """Where some of so many samples begin: numbers among them, and a start for these."""
        if not starts:
            every = cast(_Start, self._beside(count))
            return [(np.arange(len(rows)), _Start(every.states[rows], every.share[rows]))]
        which, known = rows // (count // len(starts)), self._at_starts(starts, engine)
        parts = ((np.flatnonzero(which == k), start) for k, start in enumerate(known))
        return [(part, start) for part, start in parts if start is not None]

    def _beside(self, count: int) -> _Start | None:
        """What a machine near by did in as many samples; None if nothing is known."""
        if self._near is None:
            return None
        names, start = self._near
        return start if names == self._names and len(start.states) == count else None

    def _as_start(self, loading: Loading, iterate: Iterate, found: Found) -> _Start:
        share = np.abs(iterate.force) / pushes(loading)[:, None]
        return _Start(found.states[:, : self.structure.rows], share)

    @property
    def _names(self) -> tuple[str, ...]:
        """Contacts and forces, in order."""
        return (*self.structure.row_names, *self.structure.kinds)
