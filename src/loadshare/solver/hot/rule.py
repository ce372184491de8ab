"""A linear rule that predicts, from a sample's numbers, the set of elements on which it will end.

It is learnt from solved samples, those of all positions together. Whether an element acts is the
sign of a linear function of the numbers that vary, fitted to ±1 by least squares. Of the sets that
were met, the rule takes the one that fits these signs best, or the one to which such values most
likely belong (Fisher's discriminant), whichever is right for more of the solved samples. A wrong
prediction costs one or two more visits of sets, and never an answer.

Elements with friction begin on the first piece of their graph all the same: a slip is found from
stick more surely than from another sample's slip. Where a gear floats, walls without friction would
be met one after the other, one visit for every wall; so they are predicted like contacts, and the
rule also predicts the place of the float and its force on the wall, whose direction that gives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import RULE
from loadshare.solver.hot.exchange import first_sets
from loadshare.solver.hot.iterate import Iterate, at_rest, pushes


class ArrayWeights(NamedTuple):
    """Weights of the numbers in one array of a loading.

    Attributes
    ----------
    name : str
        Name of the array.
    used : ndarray of int or None
        Columns with a weight; None for all, where that takes less time than picking them.
    weights : ndarray, shape (columns, sets + values)
    """

    name: str
    used: Numbers | None
    weights: Array


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """Sets that were met, weights that predict one of them, and where samples begin on it.

    Attributes
    ----------
    switches : ndarray of int, or slice
        Switches of the predicted elements: contacts, and walls without friction.
    states : ndarray of int8, shape (sets, named)
    share : ndarray, shape (sets, m)
        Mean forces on each, in shares of the load.
    constant : ndarray, shape (sets,)
    place : ndarray, shape (sets, values)
        Constants of the coordinates, and of the forces of radial elements, in the units of the
        force method; without values where no wall is predicted.
    parts : sequence of ArrayWeights
    """

    switches: Numbers | slice
    states: States
    share: Array
    constant: Array
    place: Array
    parts: Sequence[ArrayWeights] = ()

    def start(self, structure: Structure, loading: Loading) -> tuple[States, Iterate]:
        """Return the sets and the iterate with which S samples begin."""
        states, (named, place) = first_sets(structure, loading), self.named(loading)
        states[:, self.switches] = self.states[named]
        iterate = at_rest(structure, loading, self.share, named)
        if place.shape[1]:
            iterate.x[:], iterate.force[:, structure.columns.radials] = np.split(
                place, [structure.size], axis=1
            )
        return states, iterate

    def named(self, loading: Loading) -> tuple[Numbers, Array]:
        """Return the number, in `states`, of the set predicted for each of S samples; its place."""
        sets = len(self.states)
        if not self.parts:
            none = np.zeros(loading.count, dtype=np.intp)
            return none, self.place[none]
        fit = np.zeros((loading.count, sets + self.place.shape[1]))
        fit[:, :sets] = self.constant
        for name, used, weights in self.parts:
            table = getattr(loading, name)
            table = table.reshape(len(table), -1)
            # An infinite number without a weight spoils only the start of its own sample.
            with np.errstate(invalid="ignore"):
                fit += table @ weights if used is None else table[:, used] @ weights
        named = fit[:, :sets].argmax(axis=1)
        return named, fit[:, sets:] + self.place[named]


def samples_to_learn(count: int) -> Numbers:
    """Return the numbers of those among `count` samples from which a rule is learnt; none of few.

    They are spread evenly over all samples and over those of each position (multiples of the golden
    ratio).
    """
    taught = min(RULE.taught, count // RULE.worth)
    ratio = 0.5 * (np.sqrt(5.0) - 1.0)
    multiples = np.arange(taught if taught >= RULE.fewest else 0) * ratio
    return np.unique((multiples % 1.0 * count).astype(np.intp))


def rule_of(structure: Structure, loading: Loading, states: States, iterate: Iterate) -> Rule:
    """Learn from solved samples where others should begin.

    Parameters
    ----------
    structure : Structure
    loading : Loading
        T samples.
    states : ndarray of int8, shape (T, switches)
        Sets that they ended on.
    iterate : Iterate
        Where they ended.
    """
    walls, place = _walls(loading), np.zeros((len(states), 0))
    switches: Numbers | slice = slice(structure.rows)
    if len(walls):
        switches = np.concatenate([np.arange(structure.rows), structure.rows + walls])
        place = np.hstack([iterate.x, iterate.force[:, structure.columns.radials]])
    states = states[:, switches]
    # As strings of bytes, which NumPy sorts fifteen times as fast as rows of an array.
    each = np.ascontiguousarray(states).view(f"V{states.shape[1]}").ravel()
    _, first, every, times = np.unique(
        each, return_index=True, return_inverse=True, return_counts=True
    )
    kept = np.argsort(-times, kind="stable")[: RULE.sets]
    number = np.full(len(times), -1)
    number[kept] = np.arange(len(kept))
    met, which = states[first[kept]], number[every]
    share = np.abs(iterate.force) / pushes(loading)[:, None]
    shares = _means(share, which, len(met))
    tables = _varying(loading) if len(met) > 1 or len(walls) else {}
    if not tables:
        return Rule(switches, met, shares, np.zeros(len(met)), _means(place, which, len(met)))
    known = np.concatenate([table[:, columns] for table, columns in tables.values()], axis=1)
    naming, constant = _learnt(known, states, met, which)
    moving, place = _placed(known, place, which, len(met))
    weights = np.hstack([naming, moving])
    parts, start = [], 0
    for name, (table, columns) in tables.items():
        here = np.zeros((table.shape[1], weights.shape[1]))
        here[columns] = weights[start : start + len(columns)]
        start += len(columns)
        used = np.flatnonzero(here.any(axis=1))
        whole = len(used) > RULE.dense * table.shape[1] and np.isfinite(table).all()
        parts.append(
            ArrayWeights(name, None, here) if whole else ArrayWeights(name, used, here[used])
        )
    return Rule(switches, met, shares, constant, place, parts)


def _walls(loading: Loading) -> Numbers:
    """Return the radial elements without friction and without a first rise in all samples."""
    return np.flatnonzero((loading.radial[:, :, [0, 3]] == 0.0).all(axis=(0, 2)))


def _means(values: Array, which: Numbers, sets: int) -> Array:
    """Return mean values (sets, V) of the samples on each set."""
    means: Array = np.array([values[which == k].mean(axis=0) for k in range(sets)])
    return means


def _placed(numbers: Array, values: Array, which: Numbers, sets: int) -> tuple[Array, Array]:
    """Return weights of numbers (T, N), and constants of every set, that predict values (T, V)."""
    if not values.shape[1]:
        return np.zeros((numbers.shape[1], 0)), np.zeros((sets, 0))
    known = which >= 0
    others = which[known, None] == np.arange(1, sets)
    every = np.hstack([numbers[known], others])
    weights, constant = _least_squares(every, values[known])
    of_sets = constant + np.vstack([np.zeros_like(constant), weights[numbers.shape[1] :]])
    return weights[: numbers.shape[1]], of_sets


def _learnt(numbers: Array, states: States, met: States, which: Numbers) -> tuple[Array, Array]:
    """Learn weights of numbers (T, N), and constants, whose sum is largest for a sample's set.

    Parameters
    ----------
    numbers : ndarray, shape (T, N)
    states : ndarray of int8, shape (T, rows)
    met : ndarray of int8, shape (sets, rows)
    which : ndarray of int, shape (T,)
        Which of these each sample ended on; −1 for none of them.
    """
    if len(met) == 1:
        return np.zeros((numbers.shape[1], 1)), np.zeros(1)
    differing = (met != met[:1]).any(axis=0)
    signs = np.where(met[:, differing] != 0, 1.0, -1.0)
    weights, constant = _least_squares(numbers, np.where(states[:, differing] != 0, 1.0, -1.0))
    found = numbers @ weights + constant
    by_sign = signs.T, np.zeros(len(met))
    by_spread = _discriminant(found, which, len(met))
    best = max(
        (by_sign, by_spread),
        key=lambda by: int(((found @ by[0] + by[1]).argmax(axis=1) == which).sum()),
    )
    return weights @ best[0], constant @ best[0] + best[1]


def _least_squares(numbers: Array, wanted: Array) -> tuple[Array, Array]:
    """Return weights of numbers (T, N), and constants, that give wanted values (T, values).

    Numbers that follow from others have no weight.
    """
    from scipy.linalg import qr

    mean, spread = numbers.mean(axis=0), numbers.std(axis=0)
    spread[spread == 0.0] = 1.0
    scaled = (numbers - mean) / spread
    triangle, order = qr(scaled, mode="r", pivoting=True)
    size = np.abs(np.diagonal(triangle))
    used = np.sort(order[: len(size)][size > RULE.follows * size[0]])
    square = scaled[:, used].T @ scaled[:, used]
    square[np.diag_indices(len(square))] += RULE.ridge * len(numbers)
    weights = np.zeros((numbers.shape[1], wanted.shape[1]))
    weights[used] = np.linalg.solve(square, scaled[:, used].T @ wanted) / spread[used, None]
    # Numbers are centred, so that the constant is the mean of what is wanted.
    return weights, wanted.mean(axis=0) - mean @ weights


def _discriminant(values: Array, which: Numbers, sets: int) -> tuple[Array, Array]:
    """Return weights of values (T, V), and constants, whose sum is largest for the likeliest set.

    The values of every set are taken as normally distributed, all with the same covariance.
    """
    known = which >= 0
    times = np.bincount(which[known], minlength=sets)
    means = _means(values, which, sets)
    away = values[known] - means[which[known]]
    spread = away.T @ away / len(away)
    diagonal = np.diag_indices(len(spread))
    spread[diagonal] += RULE.ridge * max(spread[diagonal].mean(), np.finfo(float).tiny)
    weights = np.asarray(np.linalg.solve(spread, means.T), dtype=np.float64)
    return weights, np.log(times) - 0.5 * (means.T * weights).sum(axis=0)


def _varying(loading: Loading) -> dict[str, tuple[Array, Numbers]]:
    """Return arrays that vary among samples, by name: tables (T, numbers), and which columns do."""
    found = {}
    for name in ("load", "gap", "bending", "hertz", "shift", "clearance", "radial"):
        table = getattr(loading, name)
        if len(table) > 1:
            table = table.reshape(len(table), -1)
            # Rigid elements have infinite numbers.
            with np.errstate(invalid="ignore"):
                varies = np.isfinite(table).all(axis=0) & (np.ptp(table, axis=0) > 0.0)
            if varies.any():
                found[name] = table, np.flatnonzero(varies)
    return found
