"""Arrays of sets of acting elements and of samples, as the compiled kernel reads them.

Passing an array costs a tenth of a microsecond, so all sets of a call are packed into two.

Springs that are the same in all samples never change from pass to pass: what they add to the
redundants' matrix is computed once. All other columns, `contacts` here, are in the order in which
the passes treat them: the two columns of every radial element whose direction turns, flanks with a
power law, with a table, linear rows, and last the linear columns that are not rows (springs that
differ from sample to sample, radial elements on their first piece or pinned).
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.scene.loading import Loading
from loadshare.scene.statics import Basis
from loadshare.scene.structure import Structure
from loadshare.solver.hot.contact_states import OPEN, PINNED, SLIP, STICK
from loadshare.solver.hot.kernel.options import allocating
from loadshare.solver.hot.kernel.redundants import eliminated, full, local
from loadshare.solver.hot.products import SparseRows, rows_of


class SampleArrays(NamedTuple):
    """Arrays of the samples, as in `Loading`."""

    follows: Flags
    loaded: Numbers
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    tables: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array
    radial: Array


class SetArrays(NamedTuple):
    """Arrays of a set and of the samples.

    The set has r redundants on n coordinates. s of its elements are springs that never change and c
    are contacts, the first q of which are renewed from pass to pass; j radial elements in all, t of
    them turn; acting arcs turn with u coordinates.
    """

    particular: Array  # (n, c)
    particular_springs: Array  # (n, s)
    redundant: Array  # (c, r)
    redundant_springs: Array  # (s, r)
    across: Array  # (r, c): the redundants, transposed
    across_springs: Array  # (r, s)
    inverse: Array  # (r, r) of the redundants' matrix where it never changes, else (0, 0)
    springs_matrix: Array  # (r, r): what the springs add to the redundants' matrix
    products: Array  # of two redundants at a contact that is renewed; only those that are not zero
    products_still: Array  # (matrix entries, c − q): at the others
    springs_entries: Array  # (matrix entries,): what the springs add to each
    turned: Array  # (c, u): forces per turned load
    turned_springs: Array  # (s, u)
    turned_gap: Array  # (r, u): what the springs open per turned load
    moved: Array  # (u, c): turning coordinates per length of the contacts
    moved_springs: Array  # (u, s): per length of the springs
    moved_redundant: Array  # (u, r): as the springs yield to a redundant
    moved_turned: Array  # (u, u): to a turned load
    compliances: Array  # (s,): of the springs
    loose: Array  # (n, l)
    entries: Array
    base: Array  # (acting arcs, n): rows of A
    carried: Array  # (j, c): torque that each radial element carries per force of the contacts
    springs: Numbers  # (s,): their columns
    contacts: Numbers  # (c,): columns of all others
    switches: Numbers  # (rows that act,): their numbers in the set
    arc_contacts: Numbers  # (acting arcs,)
    arcs: Numbers  # (acting arcs,): their numbers
    turning: Numbers  # (u,): coordinates on which acting arcs depend
    open_arcs: Numbers  # numbers of the arcs that do not act
    open_rows: Numbers  # numbers of the other rows that do not act
    starts: Numbers  # CSR of A
    coordinates: Numbers
    arc_starts: Numbers  # where the coordinates on which each arc depends begin
    arc_coordinates: Numbers
    radial_at: Numbers  # (j,): first contact of each radial element, −1 where it does not act
    turning_radials: Numbers  # (t,): numbers of the radial elements whose direction turns
    borders: Numbers  # (t,): number of the border of each that slips, −1 for the others
    tables_of: Numbers  # numbers of the tables of the flanks that have one
    below_starts: Numbers  # (r and borders + 1,): where the rows of each column of the factor begin
    below: Numbers  # rows below the diagonal that are not zero, those of the borders last
    product_starts: Numbers  # where the products of each matrix entry begin
    product_contacts: Numbers  # the contact of each
    powers: int  # flanks with a power law
    first_row: int  # first contact that is a row, 2t
    end_row: int  # first contact after the rows
    first_column: int  # column of the first row, whether it acts or not
    first_radial: int  # column of the first radial element
    flanks: int  # rows before the first arc
    states: States
    follows: Flags  # (j,): whether friction follows the torque in some sample
    loaded: Numbers  # coordinates with a load
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    tables: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array
    radial: Array


_TABLES = SetArrays._fields.index("springs")
_LISTS = SetArrays._fields.index("powers") - _TABLES
_NUMBERS = SetArrays._fields.index("states") - _TABLES - _LISTS
_FRONT = 3 * (_TABLES + _LISTS)
"""Where the numbers of a set begin; before them come three numbers for every table and list."""


def packed_sets(
    structure: Structure, loading: Loading, sets: States
) -> tuple[Array, Numbers, Numbers]:
    """Pack sets one after another; each packed set is kept for the next time.

    Returns
    -------
    floats, numbers : ndarray
        Tables of the sets; their lists and numbers, with where each begins at the front.
    begins : ndarray of int, shape (sets, 2)
        Where each set begins in both.
    """
    found = [
        structure.cached(
            ("compiled", states.tobytes(), loading.laws), partial(_pack, structure, loading, states)
        )
        for states in sets
    ]
    begins = np.zeros((len(sets), 2), dtype=np.intp)
    if len(found) == 1:
        return *found[0], begins
    floats, numbers = zip(*found, strict=True)
    for k, every in enumerate((floats, numbers)):
        np.cumsum([len(one) for one in every[:-1]], out=begins[1:, k])
    return np.concatenate(floats), np.concatenate(numbers), begins


def _pack(structure: Structure, loading: Loading, states: States) -> tuple[Array, Numbers]:
    """Return one array of all tables, and one of all lists and numbers."""
    tables, lists, numbers = _structure(structure, loading, structure.basis(states), states)
    front, start = [], 0
    for table in tables:
        front += [start, *table.shape]
        start += table.size
    start = _FRONT + _NUMBERS
    for one in lists:
        front += [start, len(one), 1]
        start += len(one)
    rows = np.concatenate([np.array(front + numbers, dtype=np.intp), *lists])
    return np.concatenate([np.ravel(table) for table in tables]), rows


@allocating
def _table(floats, place):  # type: ignore[no-untyped-def]
    """Return a table of a packed set; `place` is where it begins, its rows and its columns."""
    return floats[place[0] : place[0] + place[1] * place[2]].reshape((place[1], place[2]))


@allocating
def _list(rows, place):  # type: ignore[no-untyped-def]
    """Return a list of a packed set; `place` is where it begins and how long it is."""
    return rows[place[0] : place[0] + place[1]]


@allocating
def unpacked(floats, rows, states, samples):  # type: ignore[no-untyped-def]
    """Return the arrays of a packed set and of samples, in the order of `SetArrays`."""
    return SetArrays(
        _table(floats, rows[0:]),
        _table(floats, rows[3:]),
        _table(floats, rows[6:]),
        _table(floats, rows[9:]),
        _table(floats, rows[12:]),
        _table(floats, rows[15:]),
        _table(floats, rows[18:]),
        _table(floats, rows[21:]),
        _table(floats, rows[24:])[0],
        _table(floats, rows[27:]),
        _table(floats, rows[30:])[0],
        _table(floats, rows[33:]),
        _table(floats, rows[36:]),
        _table(floats, rows[39:]),
        _table(floats, rows[42:]),
        _table(floats, rows[45:]),
        _table(floats, rows[48:]),
        _table(floats, rows[51:]),
        _table(floats, rows[54:])[0],
        _table(floats, rows[57:]),
        _table(floats, rows[60:])[0],
        _table(floats, rows[63:]),
        _table(floats, rows[66:]),
        _list(rows, rows[69:]),
        _list(rows, rows[72:]),
        _list(rows, rows[75:]),
        _list(rows, rows[78:]),
        _list(rows, rows[81:]),
        _list(rows, rows[84:]),
        _list(rows, rows[87:]),
        _list(rows, rows[90:]),
        _list(rows, rows[93:]),
        _list(rows, rows[96:]),
        _list(rows, rows[99:]),
        _list(rows, rows[102:]),
        _list(rows, rows[105:]),
        _list(rows, rows[108:]),
        _list(rows, rows[111:]),
        _list(rows, rows[114:]),
        _list(rows, rows[117:]),
        _list(rows, rows[120:]),
        _list(rows, rows[123:]),
        _list(rows, rows[126:]),
        rows[129],
        rows[130],
        rows[131],
        rows[132],
        rows[133],
        rows[134],
        states,
        samples.follows,
        samples.loaded,
        samples.load,
        samples.gap,
        samples.bending,
        samples.hertz,
        samples.tables,
        samples.nominal,
        samples.shift,
        samples.clearance,
        samples.relative,
        samples.radial,
    )


def _structure(
    structure: Structure, loading: Loading, basis: Basis, states: States
) -> tuple[list[Array], list[Numbers], list[int]]:
    """Return the fields of `SetArrays` that all samples share: tables, lists, numbers."""
    first, flanks, first_radial = structure.springs, structure.flat, structure.radial_column(0)
    order, (springs, turned, powers, tables, rows) = _order(structure, loading, basis, states)
    columns, particular, n = basis.columns[order], basis.particular[order], basis.redundant[order]
    renewed = turned + powers + tables
    inverse = np.zeros((0, 0)) if renewed else _inverse(structure, loading, columns, n, states)
    turning_radials = (columns[springs : springs + turned : 2] - first_radial) // 2
    slips = states[structure.rows + turning_radials] == SLIP
    borders = int(slips.sum())
    if n.shape[1] and not len(inverse):
        key = "local", basis.columns.tobytes()
        particular, n = (table[order] for table in structure.cached(key, partial(local, basis)))
        n, factor = eliminated(n, n[springs : springs + turned], borders)
    else:
        factor = full(n.shape[1], borders)
    contacts, row_end = columns[springs:], renewed + rows
    arcs = contacts - first - flanks
    acting = np.flatnonzero((arcs >= 0) & (contacts < first_radial))
    open_rows = np.flatnonzero(states[:flanks] == OPEN)
    open_arcs = np.flatnonzero(states[flanks : structure.rows] == OPEN)
    every_set = structure.cached(("every set",), partial(_every_set, structure))
    known, (arc_starts, arc_coordinates, _), (starts, coordinates, entries) = every_set
    turning = np.flatnonzero(known[arcs[acting]].any(axis=0))
    compliances = np.array(loading.bending[0, columns[:springs]])
    held, of_springs, touching = particular[:springs], n[:springs], n[springs:]
    yields = held[:, turning].T * compliances
    by_springs = of_springs.T * compliances @ of_springs
    products = (touching[:, factor.rows] * touching[:, factor.columns]).T
    product_starts, product_contacts, product_values = rows_of(products[:, :renewed])
    arrays = [
        particular[springs:].T,
        held.T,
        touching,
        of_springs,
        touching.T,
        of_springs.T,
        inverse,
        by_springs,
        product_values[None],
        products[:, renewed:],
        by_springs[factor.rows, factor.columns][None],
        particular[springs:, turning],
        held[:, turning],
        (yields @ of_springs).T,
        particular[springs:, turning].T,
        held[:, turning].T,
        yields @ of_springs,
        yields @ held[:, turning],
        compliances[None],
        basis.loose,
        entries[None],
        basis.directions[order][springs + acting],
        loading.carried[:, contacts],
    ]
    lists = [
        columns[:springs],
        contacts,
        contacts[turned:row_end] - first,
        acting,
        arcs[acting],
        turning,
        open_arcs,
        open_rows,
        starts,
        coordinates,
        arc_starts,
        arc_coordinates,
        _radial_at(structure, contacts),
        turning_radials,
        np.where(slips, np.cumsum(slips) - 1, -1),
        loading.tabulated[contacts[turned + powers : renewed]],
        factor.starts,
        factor.below,
        product_starts,
        product_contacts,
    ]
    return arrays, lists, [powers, turned, row_end, first, first_radial, flanks]


def _every_set(structure: Structure) -> tuple[Flags, SparseRows, SparseRows]:
    """Return what is the same in every set.

    Returns
    -------
    known : ndarray of bool, shape (arcs, n)
        Coordinates on which the arcs depend.
    of_arcs, by_rows : tuple of ndarray
        The same, and A, row by row.
    """
    arcs, first = len(structure.relative), structure.springs + structure.flat
    known = (structure.relative != 0.0).any(axis=1)
    known |= structure.vectors[first : first + arcs] != 0.0
    return known, rows_of(known.astype(float)), rows_of(structure.vectors)


def _radial_at(structure: Structure, contacts: Numbers) -> Numbers:
    """Return the first contact of each radial element, −1 where it does not act."""
    at = {column: k for k, column in enumerate(contacts.tolist())}
    radials = range(structure.switches - structure.rows)
    return np.array([at.get(structure.radial_column(j), -1) for j in radials], dtype=np.intp)


def _order(
    structure: Structure, loading: Loading, basis: Basis, states: States
) -> tuple[Numbers, tuple[int, ...]]:
    """Return the order of the acting columns, and the number of each sort but the last."""
    columns = basis.columns
    is_spring = columns < structure.springs
    is_radial = columns >= structure.springs + structure.rows
    # Columns of radial elements come in pairs, all others before them one by one.
    number = np.where(is_radial, (columns - structure.springs + structure.rows) // 2, 0)
    place = np.where(is_radial, np.append(states, OPEN)[number], OPEN)
    # Later assignments override earlier ones.
    sort = np.where(loading.curved[columns], 2, 4)
    sort[loading.tabulated[columns] >= 0] = 3
    sort[is_radial | is_spring] = 5
    sort[is_radial & (place != STICK) & (place != PINNED)] = 1
    sort[is_spring & loading.steady[columns]] = 0
    counts = np.bincount(sort, minlength=6)[:5].tolist()
    return np.argsort(sort, kind="stable"), tuple(counts)


def _inverse(
    structure: Structure, loading: Loading, columns: Numbers, n: Array, states: States
) -> Array:
    """Return the inverse of the redundants' matrix of linear elements; empty if samples differ."""
    compliance, steady = np.array(loading.bending[0]), np.array(loading.steady)
    for j in np.flatnonzero(states[structure.rows :] == STICK).tolist():
        pair = slice(structure.radial_column(j), structure.radial_column(j) + 2)
        first = loading.radial[:, j, 0]
        compliance[pair], steady[pair] = 1.0 / first[0], (first == first[0]).all()
    if not steady[columns].all() or not n.shape[1]:
        return np.zeros((0, 0))
    return np.asarray(np.linalg.pinv(n.T * compliance[columns] @ n))
