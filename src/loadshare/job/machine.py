"""A machine reduced once, and solved for many samples: the first rung of the ladder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from loadshare import compilation
from loadshare.certify import Judge, Verdicts
from loadshare.certify.validity import Measuring, measuring
from loadshare.scene.loading import Loading, loading_of
from loadshare.scene.structure import Structure, structure_of
from loadshare.settings import JOB, RULE
from loadshare.solver.balance import is_unbalanced
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.answer import equilibria, pin, without_noise
from loadshare.solver.hot.determined import determined
from loadshare.solver.hot.exchange import Engine, Found, States, exchange, first_sets
from loadshare.solver.hot.iterate import Iterate, at_rest, pushes
from loadshare.solver.hot.proximal import search
from loadshare.solver.hot.rule import rule_of
from loadshare.train import Train
from loadshare.train.equilibria import Equilibria
from loadshare.train.placed import standing
from loadshare.train.situations import Situations, situations_of


def _parts(count: int, parts: int) -> list[slice]:
    """Equal parts of so many samples."""
    each = count // max(parts, 1)
    return [slice(k * each, k * each + each) for k in range(parts)]


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
    passed: NDArray[np.bool_]
    states: States
    turns: NDArray[np.intp]
    searched: NDArray[np.bool_]
    determine: Callable[[], NDArray[np.bool_]]

    @cached_property
    def determined(self) -> NDArray[np.bool_]:
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
    share: NDArray[np.float64]


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

    @cached_property
    def structure(self) -> Structure:
        """Statics of the train."""
        return structure_of(self.train)

    @cached_property
    def judge(self) -> Judge:
        """Its certificate."""
        return Judge(self.train)

    @cached_property
    def measuring(self) -> Measuring:
        """What is measured on the displacements of its answers."""
        return measuring(self.train)

    def share(self, other: Machine) -> None:
        """Take over what is reduced of a machine that differs in its situations only."""
        self._like = other
        if self.train.is_placed_anew:
            return
        self.__dict__["structure"], self.__dict__["judge"] = other.structure, other.judge
        self.__dict__["measuring"] = other.measuring

    def at(self, index: int) -> Machine:
        """Return the machine of a position (1-based): itself, unless its train is placed again."""
        if index not in self._placed:
            train = standing(self.train, index)
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
        try:
            return self._answer(situations, tolerance, engine, starts)
        except Exception as error:
            if not compilation.is_failure(error):
                raise
            compilation.give_up(f"it does not compile ({compilation.words_of(error)})")
        compilation.tell_why_not()
        return self._answer(situations, tolerance, vectorised.settle, starts)

    def _answer(
        self, situations: Situations, tolerance: float, engine: Engine, starts: Sequence[int]
    ) -> Answers:
        loading = loading_of(self.structure, situations)
        iterate, states = at_rest(self.structure, loading), first_sets(self.structure, loading)
        beside = None if starts else self._beside(loading.count)
        if beside is not None:
            self._begin(slice(None), beside, loading, iterate, states)
        parts = _parts(loading.count, len(starts))
        many = bool(parts) and parts[0].stop >= JOB.worth * JOB.trial_samples
        for part, begin in zip(parts, self._at_starts(starts, engine), strict=True):
            if begin is not None:
                first = slice(part.start, part.start + JOB.trial_samples) if many else part
                self._begin(first, begin, loading, iterate, states)
        found = self._trial_samples(parts, loading, iterate, states, engine) if many else None
        if found is not None and parts[0].stop >= RULE.worth * RULE.taught:
            found = self._taught(parts, loading, iterate, states, engine, found)
        more = exchange(
            self.structure, loading, iterate, engine, states, only=~found.solved if found else None
        )
        found = found.completed(more) if found else more
        started = bool(starts) or beside is not None
        left = ~found.solved
        quick = engine is not vectorised.settle
        numpy = vectorised.settle
        attempts = (engine, False), (numpy, False), (numpy, True)
        tries = np.full(loading.count, 2 - started - quick)
        searched = np.zeros(loading.count, dtype=bool)
        while True:
            found = found.without(left)
            for number, (other, singly) in enumerate(attempts):
                # A beginning or compiled code that fails: once more from rest, then with
                # NumPy, at last by one element after another.
                fresh = ~found.solved & ~searched & (tries == number)
                if fresh.any():
                    rest = at_rest(self.structure, loading)
                    more = exchange(self.structure, loading, rest, other, only=fresh, singly=singly)
                    iterate, found = (
                        iterate.completed(rest, fresh & more.solved),
                        found.completed(more),
                    )
                    tries[fresh] += 1
            if not (starts or searched.any()) and found.solved.all():
                self._last = self._as_start(loading, iterate, found)
            left = ~found.solved & ~searched
            found = self._search(loading, iterate, found, left, tolerance)
            searched |= left
            pin(self.structure, loading, iterate, found.states)
            answers, verdicts = self._judged(situations, iterate, tolerance, engine)
            unproved = found.solved & ~verdicts.passed & (verdicts.worst <= tolerance)
            if unproved.any() and without_noise(self.structure, iterate, unproved):
                answers, verdicts = self._judged(situations, iterate, tolerance, engine)
            left = found.solved & ~verdicts.passed & ~searched
            if not left.any():
                break
        return Answers(
            loading,
            answers,
            verdicts,
            found.solved & verdicts.passed,
            found.states,
            found.turns,
            searched,
            partial(determined, self.structure, loading, iterate, found.states, found.held, quick),
        )

    def _judged(
        self, situations: Situations, iterate: Iterate, tolerance: float, engine: Engine
    ) -> tuple[Equilibria, Verdicts]:
        quick = engine is not vectorised.settle
        answers = equilibria(self.structure, iterate, quick)
        return answers, self.judge.judge(situations, answers, tolerance, compiled=quick)

    def _search(
        self,
        loading: Loading,
        iterate: Iterate,
        found: Found,
        rows: NDArray[np.bool_],
        tolerance: float,
    ) -> Found:
        """Search an equilibrium of single samples by the proximal method."""
        for row in np.flatnonzero(rows).tolist():
            alone = loading.one(row)
            if is_unbalanced(self.structure, alone.load[0], tolerance):
                continue
            one, more = search(self.structure, alone)
            if more.solved[0]:
                iterate.put(row, one)
                found = found.replaced(row, more)
        return found

    def _begin(
        self, part: slice, begin: _Start, loading: Loading, iterate: Iterate, states: States
    ) -> None:
        states[part, : self.structure.rows] = begin.states
        iterate.begin(part, begin.share, loading)

    def _trial_samples(
        self,
        parts: Sequence[slice],
        loading: Loading,
        iterate: Iterate,
        states: States,
        engine: Engine,
    ) -> Found:
        """Solve the first samples of every part; the others begin where most of these stand."""
        trial_samples = np.concatenate(
            [np.arange(p.start, p.start + JOB.trial_samples) for p in parts]
        )
        some = np.zeros(loading.count, dtype=bool)
        some[trial_samples] = True
        found = exchange(self.structure, loading, iterate, engine, states, only=some)
        trial_samples = trial_samples[found.solved[trial_samples]]
        if len(trial_samples):
            # The set from which it takes the fewest changes to all the others.
            closed = found.states[trial_samples, : self.structure.rows].astype(float)
            apart = closed.sum(axis=1) - 2.0 * closed @ closed.mean(axis=0)
            middle = trial_samples[apart.argmin()]
            alike = trial_samples[(found.states[trial_samples] == found.states[middle]).all(axis=1)]
            share = np.abs(iterate.force[alike]) / pushes(loading)[alike, None]
            begin = _Start(found.states[middle, : self.structure.rows], share.mean(axis=0))
            for part in parts:
                self._begin(
                    slice(part.start + JOB.trial_samples, part.stop),
                    begin,
                    loading,
                    iterate,
                    states,
                )
        return found

    def _taught(
        self,
        parts: Sequence[slice],
        loading: Loading,
        iterate: Iterate,
        states: States,
        engine: Engine,
        found: Found,
    ) -> Found:
        """Solve more of every part; the others begin where a rule says, which these teach."""
        some = np.zeros(loading.count, dtype=bool)
        for part in parts:
            some[part.start : part.start + RULE.taught] = True
        some &= ~found.solved
        found = found.completed(
            exchange(self.structure, loading, iterate, engine, states, only=some)
        )
        rows, push = self.structure.rows, pushes(loading)
        for part in parts:
            first = slice(part.start, part.start + RULE.taught)
            if not found.solved[first].all():
                continue
            share = np.abs(iterate.force[first]) / push[first, None]
            rule = rule_of(loading, part, found.states[first, :rows], share)
            if rule is not None:
                named = rule.named[RULE.taught :]
                others = slice(first.stop, part.stop)
                states[others, :rows] = rule.states[named]
                iterate.begin(others, rule.share, loading, named)
        return found

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
