"""The numbers of a train at a position, for many samples at once.

A tolerance study, a sweep or a march solves one machine again and again with other errors,
clearances, loads and compliances. These numbers are held in arrays whose leading axis runs over the
samples; an array with a single row holds for all of them. All that is not in the arrays (centres,
lines of action, which elements there are) is the same in every sample.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from loadshare.array_types import Array, Numbers
from loadshare.contact.arc import Arc
from loadshare.contact.law import Law, PowerLaw, TableLaw
from loadshare.train.elements import Spline
from loadshare.train.ring import DrumRing, transverse
from loadshare.train.train import Train


@dataclass(frozen=True, eq=False)
class Situations:
    """Situations of one train: S samples, or one row for all.

    Gears, shafts, splines and rings are in the order of the train, flanks in that of its meshes,
    the drive flank first; drums and round rings are counted apart.

    Attributes
    ----------
    train : Train
        The machine; gives everything that does not vary.
    count : int
        S.
    index : ndarray of int, shape (S or 1,)
        1-based position.
    offset : ndarray, shape (S or 1, gears, 3)
        Centre offsets c [m].
    torque : ndarray, shape (S or 1, gears)
        External torques [N·m].
    push : ndarray, shape (S or 1, gears, 3)
        External forces [N].
    gap : ndarray, shape (S or 1, flanks)
        Along the line of action [m], backlash included.
    bending, hertz : ndarray, shape (S or 1, flanks)
        b [m/N] and c [m/N^(2/3)] of the laws; 0 where a mesh has a table.
    table : ndarray, shape (S or 1, flanks, 2, points)
        Forces [N] and compressions [m] of tabulated laws, NaN beyond the last point of a table.
    clocking, torsion : ndarray, shape (S or 1, shafts)
        [rad], [N·m/rad].
    support : ndarray, shape (S or 1, gears, 2)
        [N/m]; 0 for a rigid bearing, which has no coordinate.
    arc_shift : ndarray, shape (S or 1, drums, 2, 3)
        What errors add to the vector from each neighbour [m].
    arc_clearance, stop : ndarray, shape (S or 1, drums, 2)
        c_x towards each neighbour; h1 and h2 [m].
    wall : ndarray, shape (S or 1, drums)
        Compliance of a drum's contacts [m/N]; 0 for a rigid ring.
    round_offset : ndarray, shape (S or 1, rounds, 3)
        Centres of round rings, bearings included, relative to O [m].
    round_radius, round_stiffness, round_power : ndarray, shape (S or 1, rounds)
        [m], [N/m^power], [-].
    spline : ndarray, shape (S or 1, splines, 5)
        K_w [N/m], S1 [m] (NaN for F_m/K_w), S2 [m], fixed F_m [N] (NaN if it follows the torque),
        τ/radius [1/m].
    """

    train: Train
    count: int
    index: Numbers
    offset: Array
    torque: Array
    push: Array
    gap: Array
    bending: Array
    hertz: Array
    table: Array
    clocking: Array
    torsion: Array
    support: Array
    arc_shift: Array
    arc_clearance: Array
    stop: Array
    wall: Array
    round_offset: Array
    round_radius: Array
    round_stiffness: Array
    round_power: Array
    spline: Array

    def take(self, rows: Numbers | slice) -> Situations:
        """Return some of the samples; an array with a single row stays as it is."""
        chosen = {
            name: value[rows] if len(value) > 1 else value for name, value in self._arrays().items()
        }
        several = range(*rows.indices(self.count)) if isinstance(rows, slice) else rows
        return replace(self, count=len(several), **chosen)

    def mapped(self, function: Callable[[Array], Array]) -> Situations:
        """Return the situations with a function applied to each array but that of positions."""
        arrays: dict[str, Any] = {name: function(getattr(self, name)) for name in VARYING}
        return replace(self, **arrays)

    @property
    def position(self) -> int:
        """Position (1-based) of the first sample."""
        return int(self.index[0])

    @property
    def torques(self) -> dict[str, float]:
        """External torques of the first sample [N·m], by gear."""
        return dict(zip(self.train.gears, self.torque[0].tolist(), strict=True))

    def offset_of(self, gear: str) -> Array:
        """Return the centre offset (3,) [m] of a gear in the first sample."""
        return np.asarray(self.offset[0, self.train.order[gear]])

    def arc(self, ring: DrumRing, side: int) -> Arc:
        """Return the exclusion arc of a drum ring towards neighbour `side`, in the first sample."""
        train = self.train
        d = [r.gear for r in train.drums].index(ring.gear)
        gear, neighbour = train.gears[ring.gear], train.gears[ring.neighbours[side]]
        return Arc(
            transverse(gear.centre - neighbour.centre, gear.axis),
            self.arc_shift[0, d, side],
            float(self.arc_clearance[0, d, side]),
        )

    def _arrays(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("index", *VARYING)}


VARYING = tuple(f.name for f in fields(Situations) if f.name not in ("train", "count", "index"))
"""Names of the arrays whose values may differ from position to position."""


@lru_cache(maxsize=64)
def situation_of(train: Train, index: int) -> Situations:
    """Return the situation of a train at position `index` (1-based), cached."""
    return situations_of(train, index)


def situations_of(train: Train, index: int | Sequence[int]) -> Situations:
    """Return the situations of a train at a position (1-based), or at several, one after another.

    At one position an array has one row for all samples, or S rows if numbers of the train are
    arrays. At several positions, for a train without arrays, it has a row for each or one for all.

    Raises
    ------
    IndexError
        If there is no such position.
    """
    several = not isinstance(index, int)
    where: Any = np.array(index, dtype=np.intp) if several else index
    rotation = train.rotations(where)
    arrays = {
        "torque": _torques(train, where),
        **_turned(train, rotation),
        **_lasting(train),
    }
    if "gap" not in arrays:
        arrays |= _of_flanks(train, train.flank_positions(where, rotation))
    count = max(map(len, arrays.values()))
    if not several:
        return Situations(train=train, count=count, index=np.array([index]), **arrays)
    return Situations(train=train, count=len(where), index=where, **arrays)


_known: WeakKeyDictionary[Train, dict[str, Array]] = WeakKeyDictionary()
_last_turned: WeakKeyDictionary[Train, tuple[tuple[Any, ...], dict[str, Array]]] = (
    WeakKeyDictionary()
)


def _turned(train: Train, rotation: Mapping[str, Any]) -> dict[str, Array]:
    """Return the arrays that turn with the gears, computed once for positions of equal rotation."""
    angles = tuple(rotation.values())
    count = max((np.size(angle) for angle in angles if isinstance(angle, np.ndarray)), default=0)
    alone = not count
    last = _last_turned.get(train)
    if alone and last is not None and last[0] == angles:
        return last[1]
    if train.stands_still:
        # One rotation for all positions; with errors, offsets have a row for each all the same.
        rotation = dict.fromkeys(rotation, 0.0)
    offset = _table([train.offset(n, rotation) for n in train.gears], 3)
    if train.stands_still and count and train.offsets:
        offset = np.repeat(offset, count, axis=0)
    found = {
        "offset": offset,
        "push": _table([train.push(n, rotation) for n in train.gears], 3),
        "arc_shift": arcs_from(train, offset),
    }
    if alone:
        _last_turned[train] = angles, found
    return found


def _lasting(train: Train) -> dict[str, Array]:
    """Return the arrays that are the same at all positions, computed once for a train."""
    if (known := _known.get(train)) is not None:
        return known
    drums, rounds = train.drums, train.rounds
    found = _known[train] = {
        "clocking": _table([s.clocking for s in train.shafts.values()]),
        "torsion": _table([s.stiffness for s in train.shafts.values()]),
        "support": _table([_support(g.support) for g in train.gears.values()], 2),
        "arc_clearance": _rows([r.clearances for r in drums], 2),
        "stop": _rows([(r.up, r.down) for r in drums], 2),
        "wall": _table([1.0 / r.stiffness for r in drums]),
        "round_offset": _table([r.offset for r in rounds], 3),
        "round_radius": _table([r.radius for r in rounds]),
        "round_stiffness": _table([r.stiffness for r in rounds]),
        "round_power": _table([r.power for r in rounds]),
        "spline": _rows([_spline(s) for s in train.splines.values()], 5),
    }
    if not any(mesh.changes for mesh in train.meshes.values()):
        found |= _of_flanks(train)
    return found


def _of_flanks(train: Train, position: Mapping[str, Any] | None = None) -> dict[str, Array]:
    """Return gaps and laws of flanks at positions of their laws; without these, their only ones."""
    flanks = [(mesh, drive) for mesh in train.meshes.values() for drive in mesh.flanks]
    where = [0 if position is None else position[mesh.flank_name(d)] for mesh, d in flanks]
    gaps = [m.gaps if d else [m.backlash + gap for gap in m.coast_gaps] for m, d in flanks]
    laws = [mesh.laws for mesh, _ in flanks]
    powers = [[law if isinstance(law, PowerLaw) else _NONE for law in every] for every in laws]
    tables = [_tables_at(*both) for both in zip(laws, where, strict=True)]
    return {
        "gap": _chosen(gaps, where),
        "bending": _chosen([[law.b for law in every] for every in powers], where),
        "hertz": _chosen([[law.c for law in every] for every in powers], where),
        "table": _tables(tables),
    }


_NONE = PowerLaw(0.0)
"""Stands for the power law of a mesh that has a table."""


def _tables_at(laws: Sequence[Law], position: Any) -> Sequence[TableLaw | None]:
    """Return the tables of a flank at the positions of its laws; only one if it holds for all."""
    tables = [law if isinstance(law, TableLaw) else None for law in laws]
    if len(tables) == 1 or not any(tables):
        return tables[:1]
    return [tables[k] for k in np.atleast_1d(position % len(tables)).tolist()]


def _chosen(values: Sequence[Sequence[Any]], where: Sequence[Any]) -> Array:
    """Return the values of every flank at its positions, from one value or one per position."""
    longest = max(map(len, values), default=1)
    if longest == 1 or not all(isinstance(at, np.ndarray) and at.ndim for at in where):
        return _table([_at(each, at) for each, at in zip(values, where, strict=True)])
    cycles = np.array([[*each] * (longest // len(each)) for each in values])
    return np.asarray(cycles[np.arange(len(cycles)), np.array(where).T % longest])


def _at(values: Sequence[Any], position: Any) -> Any:
    """Return the value at a position, or at several, from one value or one per position."""
    if len(values) == 1:
        return values[0]
    if isinstance(position, int):
        return values[position % len(values)]
    return np.array(values)[position % len(values)]


def stack(situations: Sequence[Situations]) -> Situations:
    """Put situations of one train after one another, such as all positions of a cycle."""
    first = situations[0]
    if len(situations) == 1:
        return first
    count = sum(s.count for s in situations)
    together: dict[str, Any] = {}
    every = [s._arrays() for s in situations]
    for name, value in first._arrays().items():
        parts = [arrays[name] for arrays in every]
        # Bytes are compared, since NaN must equal itself here.
        if len(value) == 1 and all(
            p is value or (p.shape == value.shape and p.tobytes() == value.tobytes()) for p in parts
        ):
            together[name] = value
            continue
        if name == "table":
            points = max(p.shape[-1] for p in parts)
            parts = [_filled(p, points) for p in parts]
        # `out` is contiguous row by row, which NumPy's own choice for broadcast rows is not.
        together[name] = np.concatenate(
            [
                np.broadcast_to(p, (s.count, *p.shape[1:]))
                for p, s in zip(parts, situations, strict=True)
            ],
            out=np.empty((count, *parts[0].shape[1:])),
        )
    return replace(first, count=count, **together)


def arcs_from(train: Train, offset: Array) -> Array:
    """Return the shifts of every drum's arcs (S or 1, drums, 2, 3) [m] at given centre offsets."""
    order = train.order
    some = any(r.with_errors for r in train.drums)
    shifts = np.zeros((len(offset) if some else 1, len(train.drums), 2, 3))
    for d, ring in enumerate(train.drums):
        gear = train.gears[ring.gear]
        for side, name in enumerate(ring.neighbours):
            if ring.with_errors:
                shift = offset[:, order[ring.gear]] - offset[:, order[name]]
                shifts[:, d, side] = shift - (shift @ gear.axis)[:, None] * gear.axis
    return shifts


def _table(values: Sequence[ArrayLike], *inner: int) -> Array:
    """Put numbers or vectors side by side, or arrays of S of them, (S or 1, values, *inner)."""
    varying = {
        k: v for k, v in enumerate(values) if isinstance(v, np.ndarray) and v.ndim > len(inner)
    }
    firsts = [varying.get(k, [v])[0] for k, v in enumerate(values)] if varying else values
    table = np.array(firsts, dtype=float).reshape(1, len(values), *inner)
    if varying:
        table = np.repeat(table, max(map(len, varying.values())), axis=0)
    for k, array in varying.items():
        table[:, k] = array
    return table


def _rows(rows: Sequence[tuple[float, ...]], length: int) -> Array:
    """Put rows of numbers of one length side by side, shape (S or 1, rows, length)."""
    table = _table([number for row in rows for number in row])
    return table.reshape(len(table), len(rows), length)


def _torques(train: Train, index: Any) -> Array:
    """Return the external torques on gears [N·m], at one position or several."""
    found: list[Any] = [train.external.get(gear, 0.0) for gear in train.gears]
    first = train.order[train.input]
    found[first] = found[first] + _at(train.input_torque, index - 1)
    return _table(found)


def _spline(spline: Spline) -> tuple[float, ...]:
    stick = math.nan if spline.stick_limit is None else spline.stick_limit
    friction = math.nan if spline.friction_force is None else spline.friction_force
    per_torque = spline.friction_per_torque
    return spline.bending_stiffness, stick, spline.clearance, friction, per_torque


def _support(support: Array | None) -> Array:
    return np.zeros(2) if support is None else support


def _tables(laws: Sequence[Sequence[TableLaw | None]]) -> Array:
    """Return the tables of all flanks, each with one for all positions or one for each."""
    points = max((len(law.forces) for each in laws for law in each if law), default=0)
    count = max(map(len, laws), default=1) if points else 1
    table = np.zeros((count, len(laws), 2, points))
    for m, each in enumerate(laws):
        for row, law in enumerate(each):
            if law:
                rows = row if len(each) > 1 else slice(None)
                table[rows, m, :, : len(law.forces)] = law.forces, law.compressions
                table[rows, m, :, len(law.forces) :] = np.nan
    return table


def _filled(table: Array, points: int) -> Array:
    missing = points - table.shape[-1]
    return np.pad(table, [(0, 0)] * 3 + [(0, missing)], constant_values=np.nan)
