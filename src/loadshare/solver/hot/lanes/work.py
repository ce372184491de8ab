"""What the compiled kernel writes: samples side by side, the last axis along the lanes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.scene import Array
from loadshare.solver.hot.lanes.options import allocating
from loadshare.solver.hot.lanes.set_arrays import Codes, Rows


class Work(NamedTuple):
    """Samples side by side."""

    samples: Rows
    at_row: Rows
    lane: Array  # (_LANE, lanes)
    live: Array  # 1 for a lane that is not judged yet
    go: Array  # 0 for a lane that is given up and stands; what has settled is refined
    push: Array  # largest load
    floor: Array  # smallest root
    singular: Array  # 1 for a singular matrix
    mistakes: Array  # number of wrong signs
    misfit: Array
    largest: Array  # compression
    strongest: Array
    weakest: Array
    longest: Array  # passes in a row without contact, of all flanks
    waits: Array  # 1 where a flank without contact is not at its smallest root
    one: Array  # (lanes,) for passing use, as are the following
    two: Array
    three: Array
    weight: Array  # (loads, lanes)
    spring: Array  # (_SPRING, springs, lanes)
    fixed: Array  # (contacts, lanes): forces without redundants and turned loads
    gap: Array  # (contacts, lanes), as are the following
    force: Array
    tangent: Array
    shift: Array  # compression at no force
    stretch: Array  # gap and compression together
    bending: Array  # (powers, lanes), as are the following
    hertz: Array
    root: Array
    loose: Array  # passes in a row without contact
    reached: Array  # (tables, lanes): force that belongs to the compression
    radial: Array  # (turning radials, _RADIAL, lanes)
    along: Array  # (turning radials, r, lanes): redundants along the direction
    before: Array  # (arcs, lanes): forces of the pass before
    load: Array  # (turning, lanes): what the turned arcs add
    still: Array  # (turning, lanes): coordinates without redundants, contacts and turned loads
    moved: Array  # (turning, lanes): coordinates of this pass
    x: Array  # (n, lanes)
    drift: Array  # (n,): of one sample
    z: Array  # (r, lanes)
    base: Array  # (r, lanes): what the springs open without redundants and turned loads
    right: Array  # (r and borders, lanes)
    linear: Array  # (r, r, lanes): matrix of what is linear
    matrix: Array  # (r and borders, r and borders, lanes)
    normal: Array  # (3, lanes)
    wrong: NDArray[np.bool_]  # (rows, lanes)
    better: Codes  # (radials, lanes): where they should stand


BAND, PATIENT, DRIFTS, PREVIOUS, TURN = 0, 1, 2, 3, 4
"""Of a lane: band by which its signs are judged, 0 if they are not; passes that a flank may be
without contact; 1 for a drift; misfit of the pass before; what arcs still turn."""
_LANE = 5
STATICS, STILL, MOVED, TOTAL = 0, 1, 2, 3
"""Of a spring: force without redundants and turned loads, gap and compression without them, and
with them; force of the redundants and turned loads."""
_SPRING = 4
BOUND, FIRST_END, REACH, LAST = 0, 1, 2, 3
"""Of a turning radial element: friction bound, end of the first piece, S2, last stiffness."""
U, V, DU, DV = 4, 5, 6, 7
"""Its offset and its direction."""
INNER, OUTER, BEGIN, EXTRA, BEYONDS = 8, 9, 10, 11, 12
"""Compliance along and across, offset at no force, free length of a slip, passes beyond its end."""
_RADIAL = 13


@allocating
def work_for(s, n, lanes):  # type: ignore[no-untyped-def]
    """Allocate so many lanes for a set on n coordinates."""
    r, springs, contacts = s.redundant.shape[1], s.springs.shape[0], s.contacts.shape[0]
    turned, radials, turning = s.borders.shape[0], s.radial_at.shape[0], s.turning.shape[0]
    size = r
    for t in range(turned):
        size += s.borders[t] >= 0
    return Work(
        samples=np.zeros(lanes, dtype=np.int64),
        at_row=np.zeros(lanes, dtype=np.int64),
        lane=np.zeros((_LANE, lanes)),
        live=np.zeros(lanes),
        go=np.zeros(lanes),
        push=np.zeros(lanes),
        floor=np.zeros(lanes),
        singular=np.zeros(lanes),
        mistakes=np.zeros(lanes),
        misfit=np.zeros(lanes),
        largest=np.zeros(lanes),
        strongest=np.zeros(lanes),
        weakest=np.zeros(lanes),
        longest=np.zeros(lanes),
        waits=np.zeros(lanes),
        one=np.zeros(lanes),
        two=np.zeros(lanes),
        three=np.zeros(lanes),
        weight=np.zeros((s.loaded.shape[0], lanes)),
        spring=np.zeros((_SPRING, springs, lanes)),
        fixed=np.zeros((contacts, lanes)),
        gap=np.zeros((contacts, lanes)),
        force=np.zeros((contacts, lanes)),
        tangent=np.zeros((contacts, lanes)),
        shift=np.zeros((contacts, lanes)),
        stretch=np.zeros((contacts, lanes)),
        bending=np.zeros((s.powers, lanes)),
        hertz=np.zeros((s.powers, lanes)),
        root=np.zeros((s.powers, lanes)),
        loose=np.zeros((s.powers, lanes)),
        reached=np.zeros((s.tables_of.shape[0], lanes)),
        radial=np.zeros((turned, _RADIAL, lanes)),
        along=np.zeros((turned, r, lanes)),
        before=np.zeros((s.arcs.shape[0], lanes)),
        load=np.zeros((turning, lanes)),
        still=np.zeros((turning, lanes)),
        moved=np.zeros((turning, lanes)),
        x=np.zeros((n, lanes)),
        drift=np.zeros(n),
        z=np.zeros((r, lanes)),
        base=np.zeros((r, lanes)),
        right=np.zeros((size, lanes)),
        linear=np.zeros((r, r, lanes)),
        matrix=np.zeros((size, size, lanes)),
        normal=np.zeros((3, lanes)),
        wrong=np.zeros((s.code.shape[0] - radials, lanes), dtype=np.bool_),
        better=np.zeros((radials, lanes), dtype=np.int8),
    )
