"""Ways to solve samples of one structure: from rest, a nearby start, by a rule, by a search."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import JOB
from loadshare.solver.balance import is_unbalanced
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.exchange import Engine, ExchangeResult, exchange, first_sets
from loadshare.solver.hot.iterate import Iterate, at_rest, pushes
from loadshare.solver.hot.proximal import search
from loadshare.solver.hot.rule import Rule, rule_of

Way = Callable[[Loading, Numbers], tuple[Iterate, ExchangeResult]]
"""A way to solve some samples, given with their numbers."""


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Where samples begin: contact states and forces of a nearby equilibrium.

    It has one row for all samples, or one for each. Radial elements begin on their first piece in
    any case: slip is found more reliably from stick than from another sample's slip.
    """

    states: States
    share: Array

    def of(self, rows: Numbers | int) -> Start:
        """Return the start of some of the samples, or of one."""
        return Start(self.states[rows], self.share[rows])


def start_of(
    structure: Structure, loading: Loading, iterate: Iterate, found: ExchangeResult
) -> Start:
    """Return the solutions of samples as a start for others."""
    share = np.abs(iterate.force) / pushes(loading)[:, None]
    return Start(found.states[:, : structure.rows], share)


def from_rest(
    structure: Structure, loading: Loading, engine: Engine, singly: bool = False
) -> tuple[Iterate, ExchangeResult]:
    """Solve samples that begin without any displacement."""
    iterate = at_rest(structure, loading)
    return iterate, exchange(structure, loading, iterate, engine, singly=singly)


def ways_from_rest(structure: Structure, engine: Engine) -> list[Way]:
    """Return ways from rest: with an engine, with NumPy, at last one element after another."""
    numpy = vectorised.settle
    kinds = [(engine, False), (numpy, False), (numpy, True)]

    def way(engine: Engine, singly: bool) -> Way:
        return lambda some, _: from_rest(structure, some, engine, singly)

    return [way(*kind) for kind in kinds[engine is numpy :]]


def take_over(
    iterate: Iterate, found: ExchangeResult, rows: Numbers, other: Iterate, more: ExchangeResult
) -> Numbers:
    """Take over what another way has found of some samples; return which of these it solved."""
    found.put(rows, more)
    solved = np.flatnonzero(more.solved)
    iterate.put(rows[solved], other.take(solved))
    return solved


def from_near(
    structure: Structure, loading: Loading, engine: Engine, near: Sequence[tuple[Numbers, Start]]
) -> tuple[Iterate, ExchangeResult]:
    """Solve samples that begin at starts, each given with the numbers of its samples."""
    iterate, states = at_rest(structure, loading), first_sets(structure, loading)
    for rows, start in near:
        states[rows, : structure.rows] = start.states
        iterate.begin(rows, start.share, loading)
    return iterate, exchange(structure, loading, iterate, engine, states)


def by_rule(
    structure: Structure, loading: Loading, engine: Engine, rule: Rule
) -> tuple[Iterate, ExchangeResult]:
    """Solve samples that begin where a rule says."""
    states, iterate = rule.start(structure, loading)
    return iterate, exchange(structure, loading, iterate, engine, states)


def learned_rule(structure: Structure, loading: Loading, engine: Engine) -> Rule | None:
    """Return the rule that samples teach; None if none of them is solved."""
    iterate, found = from_rest(structure, loading, engine)
    if 2 * np.count_nonzero(found.solved) < loading.count:
        iterate, found = from_rest(structure, loading, vectorised.settle, singly=True)
    known = np.flatnonzero(found.solved)
    if not len(known):
        return None
    return rule_of(structure, loading.take(known), found.states[known], iterate.take(known))


def by_any_way(
    structure: Structure, loading: Loading, engine: Engine, tolerance: float
) -> tuple[Iterate, ExchangeResult]:
    """Solve samples from rest, by one way after another, and by a search if none of them does."""
    first, *others = ways_from_rest(structure, engine)
    iterate, found = first(loading, np.arange(loading.count))
    for way in others:
        rows = np.flatnonzero(~found.solved)
        if len(rows):
            take_over(iterate, found, rows, *way(loading.take(rows), rows))
    rows, led = np.flatnonzero(~found.solved), np.zeros(loading.count, dtype=bool)
    search_all(structure, loading, iterate, found, rows, led, tolerance, engine)
    return iterate, found


def search_all(
    structure: Structure,
    loading: Loading,
    iterate: Iterate,
    found: ExchangeResult,
    rows: Numbers,
    led: Flags,
    tolerance: float,
    engine: Engine,
) -> Numbers:
    """Search equilibria of some samples by the proximal method, one by one.

    The other samples mostly have the same active set: they are started from each answer found, as
    long as enough of them are solved that way. A sample that was solved so but comes back, since
    its answer was not certified, is searched for like the first.

    Parameters
    ----------
    rows : ndarray of int
        Numbers of the samples.
    led : ndarray of bool, shape (S,)
        Samples that were solved from the answer of another one; updated in place.

    Returns
    -------
    ndarray of int
        Numbers of the samples that were searched for.
    """
    done: list[int] = []
    left, leads = rows, True
    while len(left):
        row, left = left[:1], left[1:]
        done += row.tolist()
        alone = loading.take(row)
        if is_unbalanced(structure, alone.load[0], tolerance):
            continue
        one, more = search(structure, alone)
        if not more.solved[0]:
            continue
        take_over(iterate, found, row, one, more)
        some = left[~led[left]]
        if leads and len(some):
            start = start_of(structure, alone, one, more)
            every = np.arange(len(some))
            one, more = from_near(structure, loading.take(some), engine, [(every, start)])
            better = np.flatnonzero(more.solved)
            iterate.put(some[better], one.take(better))
            found.put(some[better], more.take(better))
            leads = len(better) * JOB.led >= len(some)
            led[some[better]] = True
            left = np.setdiff1d(left, some[better], assume_unique=True)
    return np.array(done, dtype=np.intp)
