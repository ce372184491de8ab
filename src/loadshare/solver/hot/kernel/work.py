"""Arrays that the compiled kernel writes: samples side by side, along the last axis."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.solver.hot.kernel.options import allocating


class Given(NamedTuple):
    """Samples to settle, their iterates and their results."""

    rows: Numbers  # (k,): their numbers
    xs: Array  # (S, n)
    forces: Array  # (S, m), as is the following
    roots: Array
    floors: Array  # (S,), as is the following
    one_only: Flags
    verdict: States  # (k,)
    proposal: States  # (k, switches)


class Work(NamedTuple):
    """Work arrays of samples side by side."""

    samples: Numbers
    at_row: Numbers
    each: Array  # (_EACH, width)
    live: Array  # 1 for a sample that is not judged yet
    go: Array  # 0 for a sample that is given up and no longer changes; settled ones are refined
    push: Array  # largest load
    floor: Array  # smallest root
    singular: Array  # 1 for a singular matrix
    mistakes: Array  # number of wrong signs
    misfit: Array
    largest: Array  # largest compression
    strongest: Array
    weakest: Array
    longest: Array  # most passes in a row without contact, over all flanks
    waits: Array  # 1 where a flank without contact is not at its smallest root
    one: Array  # (width,) for temporary use, as are the following
    two: Array
    three: Array
    weight: Array  # (loads, width)
    spring: Array  # (_SPRING, springs, width)
    fixed: Array  # (contacts, width): forces without redundants and turned loads
    gap: Array  # (contacts, width), as are the following
    force: Array
    tangent: Array
    shift: Array  # compression at no force
    stretch: Array  # gap and compression together
    bending: Array  # (powers, width), as are the following
    hertz: Array
    root: Array
    loose: Array  # passes in a row without contact
    reached: Array  # (tables, width): force that belongs to the compression
    radial: Array  # (turning radials, _RADIAL, width)
    along: Array  # (turning radials, r, width): redundants along the direction
    before: Array  # (arcs, width): forces of the pass before
    load: Array  # (turning, width): what the turned arcs add
    still: Array  # (turning, width): coordinates without redundants, contacts and turned loads
    moved: Array  # (turning, width): coordinates of this pass
    x: Array  # (n, width)
    drift: Array  # (n,): of one sample
    z: Array  # (r, width)
    base: Array  # (r, width): what the springs open without redundants and turned loads
    right: Array  # (r and borders, width)
    linear: Array  # (matrix entries, width): part of the matrix from linear elements
    matrix: Array  # (r and borders, r and borders, width)
    normal: Array  # (3, width)
    wrong: Flags  # (rows, width)
    better: States  # (radials, width): the states that they should have


BAND, PATIENT, DRIFTS, PREVIOUS, TURN, GIVEN_UP = 0, 1, 2, 3, 4, 5
"""Of a sample: band by which its signs are judged, 0 if they are not; passes that a flank may be
without contact; 1 for a drift; misfit of the previous pass; turn of the arcs in the last pass; 1
where the passes ended before it had settled."""
_EACH = 6
STATICS, STILL, MOVED, TOTAL = 0, 1, 2, 3
"""Of a spring: force without redundants and turned loads; gap and compression together without
them, and with them; force of the redundants and turned loads."""
_SPRING = 4
BOUND, FIRST_END, REACH, LAST = 0, 1, 2, 3
"""Of a turning radial element: friction bound, end of the first piece, S2, last stiffness."""
U, V, DU, DV = 4, 5, 6, 7
"""Its offset and its direction."""
INNER, OUTER, BEGIN, EXTRA, BEYONDS = 8, 9, 10, 11, 12
"""Compliance along and across, offset at no force, free length of a slip, passes beyond its end."""
_RADIAL = 13


@allocating
def work_for(s, n, width):  # type: ignore[no-untyped-def]
    """Allocate arrays for `width` samples of a set on n coordinates."""
    r, springs, contacts = s.redundant.shape[1], s.springs.shape[0], s.contacts.shape[0]
    turned, radials, turning = s.borders.shape[0], s.radial_at.shape[0], s.turning.shape[0]
    size = r
    for t in range(turned):
        size += s.borders[t] >= 0
    return Work(
        samples=np.zeros(width, dtype=np.int64),
        at_row=np.zeros(width, dtype=np.int64),
        each=np.zeros((_EACH, width)),
        live=np.zeros(width),
        go=np.zeros(width),
        push=np.zeros(width),
        floor=np.zeros(width),
        singular=np.zeros(width),
        mistakes=np.zeros(width),
        misfit=np.zeros(width),
        largest=np.zeros(width),
        strongest=np.zeros(width),
        weakest=np.zeros(width),
        longest=np.zeros(width),
        waits=np.zeros(width),
        one=np.zeros(width),
        two=np.zeros(width),
        three=np.zeros(width),
        weight=np.zeros((s.loaded.shape[0], width)),
        spring=np.zeros((_SPRING, springs, width)),
        fixed=np.zeros((contacts, width)),
        gap=np.zeros((contacts, width)),
        force=np.zeros((contacts, width)),
        tangent=np.zeros((contacts, width)),
        shift=np.zeros((contacts, width)),
        stretch=np.zeros((contacts, width)),
        bending=np.zeros((s.powers, width)),
        hertz=np.zeros((s.powers, width)),
        root=np.zeros((s.powers, width)),
        loose=np.zeros((s.powers, width)),
        reached=np.zeros((s.tables_of.shape[0], width)),
        radial=np.zeros((turned, _RADIAL, width)),
        along=np.zeros((turned, r, width)),
        before=np.zeros((s.arcs.shape[0], width)),
        load=np.zeros((turning, width)),
        still=np.zeros((turning, width)),
        moved=np.zeros((turning, width)),
        x=np.zeros((n, width)),
        drift=np.zeros(n),
        z=np.zeros((r, width)),
        base=np.zeros((r, width)),
        right=np.zeros((size, width)),
        linear=np.zeros((s.springs_entries.shape[0], width)),
        matrix=np.zeros((size, size, width)),
        normal=np.zeros((3, width)),
        wrong=np.zeros((s.states.shape[0] - radials, width), dtype=np.bool_),
        better=np.zeros((radials, width), dtype=np.int8),
    )
