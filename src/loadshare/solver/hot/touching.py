"""Elements that carry in many samples, and those they touch, with Numba; see `determined`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from loadshare import compilation
from loadshare.array_types import Array, Flags, Numbers, States
from loadshare.numbering import numbered
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import PLACES
from loadshare.solver.hot.contact_states import FREE, HELD, LEVEL
from loadshare.solver.hot.iterate import Iterate
from loadshare.solver.hot.products import SparseRows, rows_of

_how = {"nogil": True, "error_model": "numpy", "_nrt": False}
compiled = compilation.jit(**_how)
inlined = compilation.within(forceinline=True, **_how)


class VaryingArrays(NamedTuple):
    """Arrays that vary, as in `Loading`, with x (S, n), force (S, m) and the least force (S,)."""

    x: Array
    force: Array
    least: Array
    gap: Array
    shift: Array
    clearance: Array
    radial: Array


class SharedArrays(NamedTuple):
    """Arrays that all samples share: A, the lines between centres of arcs, levers of splines."""

    vectors: SparseRows
    relative: SparseRows  # three rows an arc
    levers: SparseRows
    nominal: Array
    springs: int
    flat: int
    radials: int  # first column of radial elements


class Touching:
    """Elements that carry in S samples, and elements that the samples touch.

    Parameters
    ----------
    structure, loading, iterate, states, held
        As for `determined`.
    least : ndarray, shape (S,)
        An element carries if its force is above this one, and above a share of the largest.

    Attributes
    ----------
    number : ndarray of int, shape (S,)
        Of the set that carries; −1 where no coordinate is loose, all acting elements carry, and no
        radial element is on a level piece.
    sets : ndarray of int8, shape (sets, rows + radials)
        Which contacts carry, and how radial elements hold.
    """

    def __init__(
        self,
        structure: Structure,
        loading: Loading,
        iterate: Iterate,
        states: States,
        held: Flags,
        least: Array,
    ) -> None:
        self._of = structure.cached(
            ("touching",),
            lambda: SharedArrays(
                rows_of(structure.vectors),
                rows_of(loading.relative.reshape(-1, structure.size)),
                rows_of(loading.carried),
                loading.nominal,
                structure.springs,
                structure.flat,
                structure.columns.radials.start,
            ),
        )
        varying = (getattr(loading, name) for name in VaryingArrays._fields[3:])
        figures = (iterate.x, iterate.force, least, *varying)
        self._here = VaryingArrays(*(np.require(array, np.float64, ["C"]) for array in figures))
        count = len(states)
        self.number, first = np.empty((2, count), dtype=np.intp)
        self._carries = np.empty((count, structure.rows + len(structure.radials)), dtype=np.int8)
        keys = np.empty(count, dtype=np.uint64)
        acts = np.ascontiguousarray(states)
        sets = _number_all(
            self._of, self._here, acts, held, self.number, self._carries, first, keys
        )
        self.sets = self._carries[first[:sets]]

    def met(self, sets: Sequence[Sequence[int]]) -> Numbers:
        """Return how many of the elements listed for its set every sample touches, (S,).

        Elements are flanks and stops, then arcs, then radial elements.
        """
        start = np.cumsum([0, *map(len, sets)])
        structure = np.array([e for elements in sets for e in elements], dtype=np.intp)
        found = np.zeros(len(self.number), dtype=np.intp)
        _touch_all(self._of, self._here, self.number, self._carries, start, structure, found)
        return found


@compiled
def _number_all(of, here, states, held, number, carries, first, key):  # type: ignore[no-untyped-def]
    """Find and number the sets that carry; return how many there are."""
    count, contacts, last = 0, carries.shape[1] - here.radial.shape[1], 0
    for s in range(len(states)):
        least, certain = here.least[s], held[s]
        for k in range(contacts):
            least = max(least, PLACES.carries * abs(here.force[s, of.springs + k]))
        for k in range(contacts):
            carries[s, k] = here.force[s, of.springs + k] > least
            certain &= states[s, k] == 0 or carries[s, k] != 0
        for j in range(here.radial.shape[1]):
            carries[s, contacts + j] = _holds(of, here, s, j, least)
            certain &= states[s, contacts + j] == 0 or carries[s, contacts + j] == HELD
        number[s] = -1
        if not certain:
            count, last = numbered(s, carries, first, key, count, last)
            number[s] = last
    return count


@compiled
def _touch_all(of, here, number, carries, start, structure, found):  # type: ignore[no-untyped-def]
    """See `Touching.met`."""
    for s in range(len(found)):
        if number[s] >= 0:
            for i in range(start[number[s]], start[number[s] + 1]):
                found[s] += _touches(of, here, s, structure[i], carries)


@inlined
def _row(array, s):  # type: ignore[no-untyped-def]
    """Return the row of a sample, or the only one."""
    return s if len(array) > 1 else 0


@inlined
def _graph(of, here, s, j):  # type: ignore[no-untyped-def]
    """Return S1, level and S2 of a radial element (see `contact_states.graph`)."""
    law = here.radial[_row(here.radial, s), j]
    stiffness, given, reach, level = law[0], law[1], law[2], law[3]
    if np.isnan(level):
        torque = 0.0
        for i in range(of.levers.start[j], of.levers.start[j + 1]):
            torque += of.levers.value[i] * here.force[s, of.levers.at[i]]
        level = law[4] * abs(torque)
    stick = level / stiffness if stiffness > 0.0 else 0.0
    if not np.isnan(given):
        return min(given, stick), level, reach
    return np.inf if reach < stick else stick, level, reach


@inlined
def _holds(of, here, s, j, least):  # type: ignore[no-untyped-def]
    """Return how a radial element holds."""
    stick, level, reach = _graph(of, here, s, j)
    x, y = here.force[s, of.radials + 2 * j], here.force[s, of.radials + 2 * j + 1]
    size = np.hypot(x, y)
    if abs(size - level) <= least and reach > stick:
        return FREE if size <= least else LEVEL
    return HELD


@inlined
def _along(rows, k, here, s):  # type: ignore[no-untyped-def]
    """Return row k of a matrix times the coordinates."""
    total = 0.0
    for i in range(rows.start[k], rows.start[k + 1]):
        total += rows.value[i] * here.x[s, rows.at[i]]
    return total


@inlined
def _touches(of, here, s, element, carries):  # type: ignore[no-untyped-def]
    """Return whether a sample touches a flank or stop, an arc, a radial element."""
    flat, arcs, r = of.flat, len(of.nominal), _row(here.gap, s)
    if element < flat:
        c = of.springs + element
        return here.gap[r, c] - _along(of.vectors, c, here, s) <= PLACES.play
    if element < flat + arcs:
        return _margin(of, here, s, element - flat) <= PLACES.play
    j = element - flat - arcs
    stick, _, reach = _graph(of, here, s, j)
    c = of.radials + 2 * j
    x = _along(of.vectors, c, here, s) - here.gap[r, c]
    y = _along(of.vectors, c + 1, here, s) - here.gap[r, c + 1]
    radius = np.sqrt(x * x + y * y)
    is_level = carries[s, carries.shape[1] - here.radial.shape[1] + j] == LEVEL
    # It may count twice, at either end of a level piece.
    return (reach - radius <= PLACES.play) + (is_level and radius - stick <= PLACES.play)


@inlined
def _margin(of, here, s, a):  # type: ignore[no-untyped-def]
    """Return the margin of an arc (see `elements.arcs_at`)."""
    r, along, square, nominal = _row(here.shift, s), 0.0, 0.0, 0.0
    for i in range(3):
        moved = here.shift[r, a, i] + _along(of.relative, 3 * a + i, here, s)
        nominal += of.nominal[a, i] * of.nominal[a, i]
        along += of.nominal[a, i] * moved
        square += moved * moved
    margin, distance = along, np.sqrt(nominal)
    if nominal + along > 0.0:
        grown = 2.0 * along + square
        margin = grown / (np.sqrt(nominal + grown) + distance)
    else:
        margin = along / distance
    return margin + here.clearance[_row(here.clearance, s), a]
