"""A linear rule that names, from a sample's numbers, the set of contacts that it will end on.

It is learnt from samples that were solved: whether a contact acts follows from the sign of a linear
function of what varies, by least squares on ±1, and of the sets that were met the one is taken that
fits these signs best. A wrong name costs a visit or two, and never an answer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.loading import Loading
from loadshare.scene.scene import Array
from loadshare.settings import RULE
from loadshare.solver.hot.exchange import States


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
    named: NDArray[np.intp]


def rule_of(loading: Loading, part: slice, states: States, share: Array) -> Rule | None:
    """Learn from the first samples of a part how all of it begins; None where there is one set.

    Parameters
    ----------
    loading : Loading
    part : slice
        Of its samples.
    states : ndarray of int8, shape (T, rows)
        Sets that the first T of them ended on.
    share : ndarray, shape (T, m)
        Their forces, in shares of the load.
    """
    # As strings of bytes, which NumPy sorts fifteen times as fast as rows of an array.
    rows = np.ascontiguousarray(states).view(f"V{states.shape[1]}").ravel()
    _, first, which, times = np.unique(
        rows, return_index=True, return_inverse=True, return_counts=True
    )
    met = states[first]
    if len(met) == 1:
        return None
    kept = np.argsort(-times, kind="stable")[: RULE.sets]
    numbers = _varying(loading, part, len(states))
    if not numbers.shape[1]:
        return None
    taught = numbers[: len(states)]
    mean, spread = taught.mean(axis=0), taught.std(axis=0)
    scaled = (taught - mean) / spread
    signs = np.where(met[kept] != 0, 1.0, -1.0)
    differing = (signs != signs[:1]).any(axis=0)
    wanted = np.where(states[:, differing] != 0, 1.0, -1.0)
    square = scaled.T @ scaled
    square[np.diag_indices(len(square))] += RULE.ridge * len(states)
    # Numbers are centred on the samples taught, so that the constant is the mean of the signs.
    by_number = np.linalg.solve(square, scaled.T @ wanted) / spread[:, None]
    constant = wanted.mean(axis=0) - mean @ by_number
    signs = signs[:, differing]
    fit = numbers @ (by_number @ signs.T) + constant @ signs.T
    shares = np.array([share[which == k].mean(axis=0) for k in kept])
    return Rule(met[kept], shares, fit.argmax(axis=1))


def _varying(loading: Loading, part: slice, taught: int) -> Array:
    """Numbers of the samples of a part that vary among the first of them, (S, numbers)."""
    found = []
    for name in ("load", "gap", "bending", "hertz", "shift", "clearance", "radial"):
        table = getattr(loading, name)
        if len(table) > 1:
            table = table[part].reshape(part.stop - part.start, -1)
            first = table[:taught]
            found.append(table[:, np.isfinite(first).all(axis=0) & (np.ptp(first, axis=0) > 0.0)])
    return np.concatenate(found, axis=1) if found else np.zeros((part.stop - part.start, 0))
