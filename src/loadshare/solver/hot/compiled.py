"""Samples of a set side by side, compiled with Numba (`lanes`).

What is out of the ordinary (a singular matrix, forces without bound, a law without meaning, passes
that do not settle) is left to `vectorised`.

The compiled code is kept on disk, so that only the first use of a new version waits for it. It
holds no lock of the interpreter: threads share the samples.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.data import Data
from loadshare.scene.elements import Elements
from loadshare.scene.statics import Basis
from loadshare.settings import LANES
from loadshare.solver.hot import vectorised
from loadshare.solver.hot.lanes.conclude import conclude
from loadshare.solver.hot.lanes.fill import fill
from loadshare.solver.hot.lanes.options import kept
from loadshare.solver.hot.lanes.passes import run
from loadshare.solver.hot.lanes.set_arrays import Codes, Rows, packed_set, unpacked
from loadshare.solver.hot.lanes.work import work_for
from loadshare.solver.hot.state import State

WIDTHS = (8, 16, 32, 64)
"""Samples side by side: the first number that is enough, or the last."""
UNDECIDED = -1
"""Verdict on a sample that is left to `vectorised`."""


def settle(
    elements: Elements,
    data: Data,
    basis: Basis,
    code: Codes,
    rows: Rows,
    state: State,
    one_only: NDArray[np.bool_],
) -> tuple[Codes, Codes]:
    """Solve samples on one set and say what has the wrong sign.

    Parameters and return values are those of :func:`loadshare.solver.hot.vectorised.settle`, which
    solves what is left undecided here. A proposal is written where the verdict asks for one.
    """
    verdict = np.empty(len(rows), dtype=np.int8)
    proposal = np.empty((len(rows), len(code)), dtype=np.int8)
    _settle_all(
        packed_set(elements, data, basis, code),
        rows,
        state.x,
        state.force,
        state.root,
        state.floor,
        one_only,
        verdict,
        proposal,
        next((width for width in WIDTHS if width >= len(rows)), WIDTHS[-1]),
    )
    left = (verdict == UNDECIDED).nonzero()[0]
    if len(left):
        verdict[left], proposal[left] = vectorised.settle(
            elements, data, basis, code, rows[left], state, one_only
        )
    return verdict, proposal


@kept
def _settle_all(  # type: ignore[no-untyped-def]
    packed, rows, xs, forces, roots, floors, one_only, verdict, proposal, lanes
):
    """Settle every sample of `rows`, `lanes` at a time."""
    s = unpacked(packed)
    work = work_for(s, xs.shape[1], lanes)
    verdict[:] = UNDECIDED
    waiting = np.arange(rows.shape[0])
    total = rows.shape[0]
    for number in range(LANES.rounds):
        slow = 0
        last = number == LANES.rounds - 1 or total <= lanes
        for first in range(0, total, lanes):
            count = min(lanes, total - first)
            width = count if count <= LANES.fewest else min(lanes, (count + 7) // 8 * 8)
            fill(s, work, rows, waiting, first, count, width, xs, forces, roots, floors, one_only)
            run(s, work, one_only, 0 if last else int(LANES.few * count), width)
            if last:
                for m in range(count):
                    work.live[m] = 0.0
            conclude(s, work, count, width, xs, forces, roots, one_only, verdict, proposal)
            for m in range(count):
                if work.live[m] > 0.0:
                    waiting[slow] = work.at_row[m]
                    slow += 1
        total = slow
        if total == 0:
            break
