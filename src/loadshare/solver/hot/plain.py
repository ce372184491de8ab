"""Plain sets: what `lanes` is told of a set and of the samples.

A set is plain if all that can act is a spring, a flank with a linear or a power law, a stop or an
arc, and springs are the same in all samples.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.scene.data import Data
from loadshare.scene.elements import Elements
from loadshare.scene.scene import Array
from loadshare.scene.statics import Basis
from loadshare.solver.hot.places import OPEN

Rows = NDArray[np.intp]
Codes = NDArray[np.int8]


class Plain(NamedTuple):
    """Numbers of a plain set and of the samples.

    k elements act on n coordinates with r redundants. The s springs among them never change, so
    that what they add is written down once; a of the others are arcs, p have a power law.
    """

    contacts: Rows  # (k − s,): columns of what is not a spring, first those with a power law
    particular: Array  # (n, k), transposed
    redundant: Array  # (k, r)
    inverse: Array  # (r, r) of the redundants' matrix where it never changes, else (0, 0)
    yields: Array  # (s,): compliances of the springs
    springs_matrix: Array  # (r, r): what the springs add to the redundants' matrix
    springs_moved: Array  # (n, r + t): displacements that the springs add, per redundant and load
    across: Array  # (r, k): the redundants, transposed
    products: Array  # (r, r, k − s): of the redundants at the contacts
    turned: Array  # (k, t): forces per turned load
    loose: Array  # (n, l)
    arcs: Rows  # (a, 2): acting contact, number of the arc
    turning: Rows  # coordinates that acting arcs know of
    open_arcs: Rows  # numbers of the arcs that do not act
    starts: Rows  # of the rows that do not act: CSR of A, first the rows' own numbers
    open_rows: Rows
    coordinates: Rows
    entries: Array
    arc_starts: Rows  # coordinates that an arc knows of
    arc_coordinates: Rows
    base: Array  # (a, n): rows of A of the acting arcs
    code: Codes
    powers: int  # p
    springs: int
    flanks: int  # rows before the first arc
    loaded: Rows  # coordinates with a load
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array


def is_plain(elements: Elements, data: Data) -> bool:
    """Whether all sets of some samples are plain."""
    constant = data.steady[: elements.springs].all()
    return bool(elements.switches == elements.rows and constant and (data.tabulated < 0).all())


def plain_set(elements: Elements, data: Data, basis: Basis, code: Codes) -> Plain:
    """Arrays of a set; what does not vary from sample to sample is kept for the next block."""
    key = ("plain", code.tobytes(), data.laws)
    known = elements.kept.get(key)
    if known is None:
        known = elements.keep(key, _structure(elements, data, basis, code))
    return Plain._make(
        (
            *known,
            data.loaded,
            data.load,
            data.gap,
            data.bending,
            data.hertz,
            data.nominal,
            data.shift,
            data.clearance,
            data.relative,
        )
    )


def _structure(elements: Elements, data: Data, basis: Basis, code: Codes) -> tuple[Any, ...]:
    """The first fields of `Plain`."""
    springs, flanks = elements.springs, elements.flat
    curved = data.curved[basis.columns[springs:]]
    powers = int(curved.sum())
    order = np.append(np.arange(springs), springs + np.argsort(~curved, kind="stable"))
    columns, particular = basis.columns[order], basis.particular[order]
    n = basis.redundant[order]
    first_arc = springs + flanks
    contacts = columns[springs:]
    acting = np.flatnonzero(contacts >= first_arc)
    arcs = np.stack([acting, contacts[acting] - first_arc], axis=1).astype(np.intp)
    idle = np.flatnonzero(code == OPEN)
    open_rows, open_arcs = idle[idle < flanks], idle[idle >= flanks] - flanks
    entries = elements.vectors[springs + open_rows]
    row, coordinates = np.nonzero(entries)
    known = (data.relative != 0.0).any(axis=1)
    known |= elements.vectors[first_arc : first_arc + len(known)] != 0.0
    arc, arc_coordinates = np.nonzero(known)
    turning = np.flatnonzero(known[arcs[:, 1]].any(axis=0))
    yields = np.array(data.bending[0, :springs])
    inverse = np.zeros((0, 0))
    if not powers and data.steady[columns].all() and n.shape[1]:
        inverse = np.linalg.pinv(n.T * data.bending[0, columns] @ n)
    held = particular[:springs].T * yields
    touching = n[springs:]
    parts = (
        contacts,
        particular.T,
        n,
        inverse,
        yields,
        n[:springs].T * yields @ n[:springs],
        np.hstack([held @ n[:springs], (held @ particular[:springs])[:, turning]]),
        n.T,
        (touching[:, :, None] * touching[:, None, :]).T,
        particular[:, turning],
        basis.loose,
        arcs,
        turning,
        open_arcs,
        np.searchsorted(row, np.arange(len(open_rows) + 1)),
        open_rows,
        coordinates,
        entries[row, coordinates],
        np.searchsorted(arc, np.arange(len(known) + 1)),
        arc_coordinates,
        basis.directions[order][springs + acting],
        np.array(code),
    )
    # Numba compiles anew for every layout.
    return (*(np.ascontiguousarray(part) for part in parts), powers, springs, flanks)
