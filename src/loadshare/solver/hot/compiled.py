"""Samples of a set side by side, compiled with Numba (`kernel`).

Samples that are out of the ordinary (a singular matrix, forces without bound, a law without
meaning, passes that do not settle) are left to `vectorised`.

The compiled code is kept on disk, so that only the first use of a new version waits for it. It
does not hold the lock of the interpreter, so that threads can share the samples.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from loadshare.array_types import Flags, Numbers, States
from loadshare.by_reference import by_reference, set_apart
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import SIDE_BY_SIDE
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.kernel.conclude import conclude
from loadshare.solver.hot.kernel.fill import fill
from loadshare.solver.hot.kernel.options import bare, cached
from loadshare.solver.hot.kernel.passes import give_up, run
from loadshare.solver.hot.kernel.set_arrays import SampleArrays, packed_sets, unpacked
from loadshare.solver.hot.kernel.work import Given, work_for

UNDECIDED = -1
"""Verdict on a sample that is left to `vectorised`."""


def settle(
    structure: Structure,
    loading: Loading,
    sets: States,
    parts: Sequence[Numbers],
    iterate: Iterate,
    one_only: Flags,
) -> tuple[States, States]:
    """Solve samples, each on its set, and propose another set where signs are wrong.

    Parameters and return values are those of :func:`loadshare.solver.hot.vectorised.settle`, which
    solves what is left undecided here. A proposal is only written where the verdict asks for one.
    """
    rows = np.concatenate(parts)
    ends = np.cumsum([len(part) for part in parts])
    verdict = np.full(len(rows), UNDECIDED, dtype=np.int8)
    proposal = np.empty((len(rows), sets.shape[1]), dtype=np.int8)
    state = iterate.x, iterate.force, iterate.root, iterate.floor
    _settle_all(
        *packed_sets(structure, loading, sets),
        sets,
        SampleArrays._make(getattr(loading, name) for name in SampleArrays._fields),
        Given(rows, *state, one_only, verdict, proposal),
        ends,
        SIDE_BY_SIDE.widest,
    )
    left = (verdict == UNDECIDED).nonzero()[0]
    if len(left):
        which = np.searchsorted(ends, left, side="right")
        met = np.unique(which)
        some = [rows[left[which == g]] for g in met.tolist()]
        verdict[left], proposal[left] = vectorised.settle(
            structure, loading, sets[met], some, iterate, one_only
        )
    return verdict, proposal


@cached
def _settle_all(floats, numbers, begins, sets, samples, given, ends, widest):  # type: ignore[no-untyped-def]
    """Settle every sample of every set, at most `widest` side by side."""
    first, waiting = 0, np.arange(given.rows.shape[0])
    for g in range(ends.shape[0]):
        place, some = begins[g], waiting[first : ends[g]]
        s = unpacked(floats[place[0] :], numbers[place[1] :], sets[g], samples)
        width = min(widest, (some.shape[0] + 7) // 8 * 8)
        work = work_for(s, given.xs.shape[1], width)
        _settle_set(by_reference(s), by_reference(work), by_reference(given), some, width)
        first = ends[g]


@bare
def _settle_set(s, work, given, waiting, widest):  # type: ignore[no-untyped-def]
    """Settle samples of one set; slow ones are put off, and start again side by side."""
    set_apart()
    total = waiting.shape[0]
    for number in range(SIDE_BY_SIDE.rounds):
        slow = 0
        last = number == SIDE_BY_SIDE.rounds - 1 or total <= widest
        for first in range(0, total, widest):
            count = min(widest, total - first)
            width = count if count <= SIDE_BY_SIDE.fewest else min(widest, (count + 7) // 8 * 8)
            fill(s, work, given, waiting, first, count, width)
            run(s, work, given.one_only, 0 if last else int(SIDE_BY_SIDE.few * count), width)
            if last:
                give_up(work, count)
            conclude(s, work, given, count, width)
            for m in range(count):
                if work.live[m] > 0.0:
                    waiting[slow] = work.at_row[m]
                    slow += 1
        total = slow
        if total == 0:
            break
