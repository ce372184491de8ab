"""All samples of one set together, with NumPy or another array library.

Everything from `OnSet` on is written in the array API standard: given a library, samples are
settled with its arrays and on its device. Which sets to try, and places for bodies that nothing
holds, is decided by NumPy on the host.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from loadshare.array_library import largest, to_numpy
from loadshare.array_types import Flags, Numbers, States
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
    library: Any = np,
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
    library : module
        Array library with which to compute: NumPy, or any that keeps to the array API standard.

    Returns
    -------
    verdict : ndarray of int8, shape (k,)
        DONE, OTHER or FAILED.
    proposal : ndarray of int8, shape (k, switches)
        Set to try next.
    """
    verdicts, proposals = [], []
    with np.errstate(all="ignore"):
        for states, rows in zip(sets, parts, strict=True):
            on = OnSet(structure, loading, states, rows, iterate, library)
            verdict, proposal = _settle_set(on, iterate, library.asarray(one_only[rows]))
            verdicts.append(to_numpy(verdict))
            proposals.append(to_numpy(proposal))
    return np.concatenate(verdicts), np.concatenate(proposals)


def _settle_set(on: OnSet, iterate: Iterate, single: Flags) -> tuple[States, States]:
    """Solve samples on one set and propose another where signs are wrong."""
    xp, start = on.library, on.x
    may_stay = xp.asarray(iterate.stays[on.rows])
    drift = signs.drift(on)
    drifting = xp.any(drift != 0.0, axis=1)
    passes.run(on, single | drifting)
    far = may_stay & (largest(on.x - start) > HOT.far * (1.0 + largest(start)))
    # A move that almost nothing resists has run away from its start.
    drift = xp.where(far[:, None], on.x - start, drift)
    drifting, on.x = drifting | far, xp.where(far[:, None], start, on.x)
    wrong, moved = signs.wrong_elements(on, HOT.sign)
    staying = may_stay & xp.any(wrong, axis=1)
    if xp.any(staying):
        wrong, moved = signs.left_in_place(on, start, staying, wrong, moved)
    gross = xp.any(on.gross, axis=1)[:, None]
    wrong, moved = xp.where(gross, on.gross, wrong), xp.where(gross, on.gross_to, moved)
    if xp.any(drifting):
        # Only the element that stops the drift is of interest.
        stopping, other = signs.stopped_by(on, drift)
        wrong = xp.where(drifting[:, None], stopping, wrong)
        moved = xp.where(drifting[:, None], other, moved)
        on.settled, on.refused = on.settled & ~drifting, on.refused & ~drifting
    if on.basis.loose.shape[1]:
        wrong = _without_overlaps(on, wrong, single)
    on.store(iterate)
    numbers = xp.asarray(np.arange(wrong.shape[1]), device=wrong.device)
    first = numbers == xp.argmax(xp.astype(wrong, xp.int8), axis=1)[:, None]
    wrong = wrong & (first | ~single[:, None])
    failed = xp.full_like(moved[:, 0], at.FAILED)
    verdict = xp.where(on.settled, at.DONE, failed)
    verdict = xp.where(xp.any(wrong, axis=1), at.OTHER, verdict)
    return xp.where(on.refused, at.FAILED, verdict), xp.where(
        wrong, moved, xp.asarray(on.states, device=wrong.device)
    )


def _without_overlaps(on: OnSet, wrong: Flags, single: Flags) -> Flags:
    """Find places for bodies that nothing holds; return what is wrong besides them."""
    some = to_numpy(single & on.settled & on.library.any(wrong, axis=1))
    if not some.any():
        return wrong
    left = np.array(to_numpy(wrong))
    for k in np.flatnonzero(some).tolist():
        left[k] &= not signs.rests(on, k, left[k])
    found: Flags = on.library.asarray(left, device=wrong.device)
    return found
