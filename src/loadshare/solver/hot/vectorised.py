"""All samples of one set together, with NumPy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import HOT
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot import passes, signs
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.on_set import OnSet


def settle(
    structure: Structure,
    loading: Loading,
    sets: States,
    parts: Sequence[Numbers],
    iterate: Iterate,
    one_only: Flags,
) -> tuple[States, States]:
    """Solve samples, each on its set, and propose another set where signs are wrong.

    Parameters
    ----------
    structure : Structure
    loading : Loading
    sets : ndarray of int8, shape (G, switches)
    parts : sequence of ndarray of int
        Samples to solve on each of them, k in all.
    iterate : Iterate
        Coordinates and forces of each sample; updated in place.
    one_only : ndarray of bool, shape (S,)
        Exchange only one element of these samples.

    Returns
    -------
    verdict : ndarray of int8, shape (k,)
        DONE, OTHER or FAILED.
    proposal : ndarray of int8, shape (k, switches)
        Set to try next.
    """
    with np.errstate(all="ignore"):
        found = [
            _settle_set(OnSet(structure, loading, states, rows, iterate), iterate, one_only[rows])
            for states, rows in zip(sets, parts, strict=True)
        ]
    verdicts, proposals = zip(*found, strict=True)
    return np.concatenate(verdicts), np.concatenate(proposals)


def _settle_set(on: OnSet, iterate: Iterate, single: Flags) -> tuple[States, States]:
    """Solve samples on one set and propose another where signs are wrong."""
    rows, states = on.rows, on.states
    drift = signs.drift(on)
    drifting = (drift != 0.0).any(axis=1)
    passes.run(on, single | drifting)
    start = iterate.x[rows]
    far = iterate.stays[rows] & (size_of(on.x - start) > HOT.far * (1.0 + size_of(start)))
    if far.any():
        # A move that almost nothing resists has run away from its start.
        drift[far], drifting = (on.x - start)[far], drifting | far
        on.x[far] = start[far]
    wrong, moved = signs.wrong_elements(on, HOT.sign)
    staying = iterate.stays[rows] & wrong.any(axis=1)
    if staying.any():
        wrong, moved = signs.left_in_place(on, iterate.x[rows], staying, wrong, moved)
    gross = on.gross.any(axis=1)
    wrong[gross] = on.gross[gross]
    moved[gross] = on.gross_to[gross]
    if drifting.any():
        # Only the element that stops the drift is of interest.
        stopping, other = signs.stopped_by(on, drift)
        wrong[drifting], moved[drifting] = stopping[drifting], other[drifting]
        on.settled &= ~drifting
        on.refused &= ~drifting
    if on.basis.loose.shape[1]:
        for k in np.flatnonzero(single & on.settled & wrong.any(axis=1)).tolist():
            wrong[k] &= not signs.rests(on, k, wrong[k])
    on.store(iterate)
    first = np.zeros_like(wrong)
    first[np.arange(len(rows)), wrong.argmax(axis=1)] = True
    wrong &= first | ~single[:, None]
    verdict = np.where(on.settled, at.DONE, at.FAILED)
    verdict[wrong.any(axis=1)] = at.OTHER
    verdict[on.refused] = at.FAILED
    return verdict.astype(np.int8), np.where(wrong, moved, states).astype(np.int8)


def size_of(vectors: Array) -> Array:
    """Return the size of the largest entry of every row."""
    return np.asarray(np.abs(vectors).max(axis=1, initial=0.0))
