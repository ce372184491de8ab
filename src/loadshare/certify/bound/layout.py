"""A train as the compiled bound reads it: numbers of elements, their arms and directions."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array, Flags, Numbers
from loadshare.certify.bound.columns import Columns
from loadshare.certify.mechanics import mechanics_of, pairs
from loadshare.certify.validity import measuring
from loadshare.settings import BOUND, CERTIFY
from loadshare.train.situations import Situations

Places = NDArray[np.uintp]


class Layout(NamedTuple):
    """A train as compiled code reads it.

    e flanks, c contacts (flanks, stops, arcs), d drums, q radial elements, k splines, m columns.
    """

    mesh: Numbers  # (e,)
    is_tabled: Flags  # (e,)
    arm: Array  # (e,)
    twin: Numbers  # (c,): opposed contact of the same ring, or −1
    drum: Numbers  # (c − e,): drum of a ring's contact
    drum_gear: Numbers  # (d,)
    nominal: Array  # (2 d, 2): vector from the neighbour
    apart: Array  # (2 d,): length of it
    spring: Numbers  # (springs, 3): column, shaft or gear, axis (2 for a shaft)
    spring_arm: Array
    pull_gear: Numbers  # (q,)
    moment: Array  # (k, e): torque over a spline per force
    rounds: int
    turn: Numbers  # (turns, 2): coordinate, gear
    turn_radius: Array
    place: Numbers  # (places, 2): first coordinate, gear
    load: Numbers  # (loads, 2): coordinate, gear
    load_radius: Array
    push_start: Places  # (3 gears + 1,): what forces from outside load; (1,) without any
    push_at: Places
    push_value: Array
    frame: Array  # (gears, 2, 3)
    radius: Array  # (gears,)
    first_stop: int
    first_arc: int
    first_pull: int
    start: Places  # (m + 1,): entries of A, row by row
    at: Places
    value: Array
    rest_start: Places  # (m + 1,): entries of clockings and offsets in lengths, row by row
    rest_at: Places
    rest_value: Array
    rest_shift: Places  # (e,): first entry that is not a clocking
    still: Numbers  # gears that cannot be displaced
    axis: Array  # (gears, 3)
    shaft: Numbers  # (shafts, 2): first and second gear
    rigid_shaft: Numbers
    held: Numbers  # gears that do not turn
    carrier: Numbers  # (gears,): carrier on which each rides; −1 without
    squeezed: Numbers  # drums with rigid arcs on neighbours that cannot move
    neighbour: Numbers  # (2 d,)
    ends: Numbers  # (e, 2): driver and driven gear
    across: Array  # (e, 3): turn of the line of action per displacement of the driver [1/m]
    line: Array  # (e,): its length [m]
    yields: Array  # (e,): one over the compression that gives a warning [1/m]
    turnable: float  # turn of a line that gives a warning


def _entries(matrix: Array) -> tuple[Places, Places, Array]:
    """Return the entries of a matrix that are not zero, row by row."""
    rows, at = np.nonzero(matrix)
    start = np.searchsorted(rows, np.arange(len(matrix) + 1))
    return start.astype(np.uintp), at.astype(np.uintp), matrix[rows, at]


def _first_from(column: int, start: Places, at: Places) -> Places:
    """Return the first entry of every row from a column on."""
    found = [np.searchsorted(at[a:b], column) + a for a, b in pairwise(start.tolist())]
    return np.array(found, dtype=np.uintp)


def springs_of(columns: Columns, situations: Situations) -> tuple[Numbers, Array]:
    """Return elastic shafts and bearings, and the arms of shafts."""
    train = columns.train
    found, arms = [], []
    shafts = list(train.shafts.values())
    for at, k in enumerate(columns.elastic_shafts, columns.shafts.start):
        found.append((at, k, 2))
        arms.append(train.gears[shafts[k].first].base_radius)
    for number, gear in enumerate(columns.places):
        for axis in (0, 1):
            if situations.support[:, columns.order[gear], axis].any():
                found.append(
                    (columns.bearings.start + 2 * number + axis, columns.order[gear], axis)
                )
                arms.append(1.0)
    return np.array(found, dtype=np.intp).reshape(-1, 3), np.array(arms)


def _twins(columns: Columns, nominal: Array, apart: Array) -> Numbers:
    """Return the opposed contact of every contact of a ring; −1 where there is none."""
    flanks, contacts = columns.flanks.stop, len(columns.contacts)
    twin = np.full(contacts + len(apart), -1, dtype=np.intp)
    for start in range(flanks, len(twin), 2):
        k = start - contacts
        if k >= 0 and not (
            columns.between_fixed[k // 2]
            and nominal[k] @ nominal[k + 1] <= -BOUND.opposed * apart[k] * apart[k + 1]
        ):
            continue
        twin[start], twin[start + 1] = start + 1, start
    return twin


def layout_of(columns: Columns, spring: Numbers, spring_arm: Array, pushed: bool) -> Layout:
    """Return the layout of a train.

    Parameters
    ----------
    columns : Columns
    spring, spring_arm : ndarray
        As `springs_of` finds them.
    pushed : bool
        Whether forces act on gears from outside.
    """
    train, order, of = columns.train, columns.order, mechanics_of(columns.train)
    gears = list(train.gears.values())
    frames = np.array([g.frame for g in gears]).reshape(-1, 2, 3)
    ways = [way @ frames[g].T for g, both in zip(of.drum, of.nominal, strict=True) for way in both]
    nominal = np.array(ways).reshape(-1, 2)
    apart = np.sqrt((nominal**2).sum(axis=1))
    drums = np.arange(len(train.drums))
    held = {g: t for g, t in columns.turns.items() if t.coordinate is not None}
    turns = [(t.coordinate or 0, order[g], t.radius) for g, t in held.items() if not t.shafts]
    loads = [(t.coordinate or 0, order[g], t.radius) for g, t in held.items()]
    gear_pairs = pairs([(order[m.driver], order[m.driven]) for m, _ in columns.all_flanks])
    size, rest = measuring(train), _entries(columns.constants.T)
    across = size.across.reshape(len(gear_pairs), -1, 3)
    return Layout(
        columns.meshes,
        np.isin(np.arange(columns.flanks.stop), columns.tabled),
        columns.arms,
        _twins(columns, nominal, apart),
        np.concatenate([np.repeat(drums, 2)] * 2),
        of.drum,
        nominal,
        apart,
        spring,
        spring_arm,
        of.pulled,
        columns.moments,
        len(train.rounds),
        pairs([t[:2] for t in turns]),
        np.array([t[2] for t in turns]),
        pairs([(at, order[g]) for g, at in columns.places.items()]),
        pairs([t[:2] for t in loads]),
        np.array([t[2] for t in loads]),
        *_entries(columns.pushed if pushed else columns.pushed[:0]),
        frames,
        of.radius,
        columns.stops.start,
        columns.arcs.start,
        columns.radials.start,
        *_entries(columns.matrix.high),
        *rest,
        _first_from(len(train.shafts), *rest[:2])[: columns.flanks.stop],
        np.setdiff1d(np.arange(len(order)), columns.moving),
        np.array([g.axis for g in gears]).reshape(-1, 3),
        of.shaft,
        np.setdiff1d(np.arange(len(train.shafts)), columns.elastic_shafts),
        np.array(of.held, dtype=np.intp),
        np.array([order.get(g.carrier or "", -1) for g in gears], dtype=np.intp),
        of.squeezed,
        of.neighbours.reshape(-1),
        gear_pairs,
        across[np.arange(len(gear_pairs)), gear_pairs[:, 0]] / size.line,
        size.line[:, 0].copy(),
        1.0 / (size.height[:, 0] * CERTIFY.compressed),
        min(CERTIFY.turned, size.vanishing),
    )
