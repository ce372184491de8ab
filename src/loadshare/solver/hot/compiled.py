"""Samples of a set side by side, compiled with Numba (`kernel`).

What is out of the ordinary (a singular matrix, forces without bound, a law without meaning, passes
that do not settle) is left to `vectorised`.

The compiled code is kept on disk, so that only the first use of a new version waits for it. It
holds no lock of the interpreter: threads share the samples.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.loading import Loading
from loadshare.scene.statics import Basis
from loadshare.scene.structure import Structure
from loadshare.settings import ABREAST
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.kernel.conclude import conclude
from loadshare.solver.hot.kernel.fill import fill
from loadshare.solver.hot.kernel.options import cached
from loadshare.solver.hot.kernel.passes import give_up, run
from loadshare.solver.hot.kernel.set_arrays import Rows, States, packed_set, unpacked
from loadshare.solver.hot.kernel.work import work_for

UNDECIDED = -1
"""Verdict on a sample that is left to `vectorised`."""


def settle(
    structure: Structure,
    loading: Loading,
    basis: Basis,
    states: States,
    rows: Rows,
    iterate: Iterate,
    one_only: NDArray[np.bool_],
) -> tuple[States, States]:
    """Solve samples on one set and say what has the wrong sign.

    Parameters and return values are those of :func:`loadshare.solver.hot.vectorised.settle`, which
    solves what is left undecided here. A proposal is written where the verdict asks for one.
    """
    verdict = np.empty(len(rows), dtype=np.int8)
    proposal = np.empty((len(rows), len(states)), dtype=np.int8)
    _settle_all(
        packed_set(structure, loading, basis, states),
        rows,
        iterate.x,
        iterate.force,
        iterate.root,
        iterate.floor,
        one_only,
        verdict,
        proposal,
        next((width for width in ABREAST.widths if width >= len(rows)), ABREAST.widths[-1]),
    )
    left = (verdict == UNDECIDED).nonzero()[0]
    if len(left):
        verdict[left], proposal[left] = vectorised.settle(
            structure, loading, basis, states, rows[left], iterate, one_only
        )
    return verdict, proposal


@cached
def _settle_all(  # type: ignore[no-untyped-def]
    packed, rows, xs, forces, roots, floors, one_only, verdict, proposal, widest
):
    """Settle every sample of `rows`, at most `widest` side by side."""
    s = unpacked(packed)
    work = work_for(s, xs.shape[1], widest)
    verdict[:] = UNDECIDED
    waiting = np.arange(rows.shape[0])
    total = rows.shape[0]
    for number in range(ABREAST.rounds):
        slow = 0
        last = number == ABREAST.rounds - 1 or total <= widest
        for first in range(0, total, widest):
            count = min(widest, total - first)
            width = count if count <= ABREAST.fewest else min(widest, (count + 7) // 8 * 8)
            fill(s, work, rows, waiting, first, count, width, xs, forces, roots, floors, one_only)
            run(s, work, one_only, 0 if last else int(ABREAST.few * count), width)
            if last:
                give_up(work, count)
            conclude(s, work, count, width, xs, forces, roots, one_only, verdict, proposal)
            for m in range(count):
                if work.live[m] > 0.0:
                    waiting[slow] = work.at_row[m]
                    slow += 1
        total = slow
        if total == 0:
            break
