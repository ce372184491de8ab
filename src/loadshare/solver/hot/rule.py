"""A linear rule that names, from a sample's numbers, the set of contacts that it will end on.

It is learnt from samples that were solved, those of all positions together. Whether a contact acts
follows from the sign of a linear function of what varies, by least squares on ±1. Of the sets that
were met the one is taken that fits these signs best, or the one to which numbers of such values
most likely belong (Fisher's discriminant): whichever names more of the samples solved. A wrong name
costs a visit or two, and never an answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.loading import Loading
from loadshare.scene.scene import Array
from loadshare.settings import RULE
from loadshare.solver.hot.exchange import States

Rows = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """Sets that were met, and which of them each of some samples is to begin with.

    Attributes
    ----------
    states : ndarray of int8, shape (sets, rows)
    share : ndarray, shape (sets, m)
        Mean forces on each, in shares of the load.
    named : ndarray of int, shape (S,)
    """

    states: States
    share: Array
    named: Rows


def samples_to_learn(count: int) -> Rows:
    """Return numbers of the samples, of so many, from which a rule is learnt; none of few.

    Spread evenly over all of them, and over those of each position (multiples of the golden ratio).
    """
    taught = min(RULE.taught, count // RULE.worth)
    ratio = 0.5 * (np.sqrt(5.0) - 1.0)
    multiples = np.arange(taught if taught >= RULE.fewest else 0) * ratio
    return np.unique((multiples % 1.0 * count).astype(np.intp))


def rule_of(loading: Loading, taught: Rows, states: States, share: Array) -> Rule:
    """Learn from some samples how all begin.

    Parameters
    ----------
    loading : Loading
        S samples.
    taught : ndarray of int, shape (T,)
        Numbers of those that were solved.
    states : ndarray of int8, shape (T, rows)
        Sets that these ended on.
    share : ndarray, shape (T, m)
        Their forces, in shares of the load.
    """
    # As strings of bytes, which NumPy sorts fifteen times as fast as rows of an array.
    rows = np.ascontiguousarray(states).view(f"V{states.shape[1]}").ravel()
    _, first, every, times = np.unique(
        rows, return_index=True, return_inverse=True, return_counts=True
    )
    kept = np.argsort(-times, kind="stable")[: RULE.sets]
    number = np.full(len(times), -1)
    number[kept] = np.arange(len(kept))
    met, which = states[first[kept]], number[every]
    shares = np.array([share[which == k].mean(axis=0) for k in range(len(kept))])
    named = np.zeros(loading.count, dtype=np.intp)
    tables = _varying(loading, taught) if len(met) > 1 else []
    if tables:
        known = np.concatenate([table[taught][:, columns] for table, columns in tables], axis=1)
        weights, constant = _learnt(known, states, met, which)
        fit, start = np.tile(constant, (loading.count, 1)), 0
        for table, columns in tables:
            here = np.zeros((table.shape[1], len(met)))
            here[columns] = weights[start : start + len(columns)]
            start += len(columns)
            used = np.flatnonzero(here.any(axis=1))
            if len(used) > RULE.dense * table.shape[1] and np.isfinite(table[taught]).all():
                fit += table @ here
            else:
                fit += table[:, used] @ here[used]
        named = fit.argmax(axis=1)
    return Rule(met, shares, named)


def _learnt(numbers: Array, states: States, met: States, which: Rows) -> tuple[Array, Array]:
    """Learn weights of numbers (T, N), and constants, that are largest for the set of a sample.

    Parameters
    ----------
    numbers : ndarray, shape (T, N)
    states : ndarray of int8, shape (T, rows)
    met : ndarray of int8, shape (sets, rows)
    which : ndarray of int, shape (T,)
        Which of these each sample ended on; −1 for none of them.
    """
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
    """Weights of numbers (T, N), and constants, that give what is wanted (T, values).

    Numbers that follow from others have no weight.
    """
    from scipy.linalg import qr

    mean, spread = numbers.mean(axis=0), numbers.std(axis=0)
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


def _discriminant(values: Array, which: Rows, sets: int) -> tuple[Array, Array]:
    """Weights of values (T, V), and constants, that tell to which set these most likely belong.

    The values of every set are taken as normal, all with one spread.
    """
    known = which >= 0
    times = np.bincount(which[known], minlength=sets)
    means = np.array([values[which == k].mean(axis=0) for k in range(sets)])
    away = values[known] - means[which[known]]
    spread = away.T @ away / len(away)
    diagonal = np.diag_indices(len(spread))
    spread[diagonal] += RULE.ridge * max(spread[diagonal].mean(), np.finfo(float).tiny)
    weights = np.linalg.solve(spread, means.T)
    return weights, np.log(times) - 0.5 * (means.T * weights).sum(axis=0)


def _varying(loading: Loading, taught: Rows) -> list[tuple[Array, Rows]]:
    """What varies among some samples: tables (S, numbers) and the columns that do."""
    found = []
    for name in ("load", "gap", "bending", "hertz", "shift", "clearance", "radial"):
        table = getattr(loading, name)
        if len(table) > 1:
            table = table.reshape(len(table), -1)
            some = table[taught]
            varies = np.isfinite(some).all(axis=0) & (np.ptp(some, axis=0) > 0.0)
            if varies.any():
                found.append((table, np.flatnonzero(varies)))
    return found
