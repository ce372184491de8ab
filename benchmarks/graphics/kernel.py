"""The compiled kernel of the fast method for CUDA: the same functions, one sample to a thread.

`loadshare.solver.hot.kernel` works on samples side by side along the last axis; a thread does so
for a width of one, in local memory. It exchanges its active set alone, as `exchange` does for all
samples.
"""

# Numba has no types.
# mypy: ignore-errors

from __future__ import annotations

import math
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import cuda
from numba.cuda import cgutils, libdevice, types
from numba.cuda.extending import intrinsic
from numba.cuda.np.arrayobj import make_array, populate_array
from numpy.typing import NDArray

from loadshare.settings import EXCHANGE
from loadshare.solver.hot.compiled import UNDECIDED
from loadshare.solver.hot.contact_states import OPEN, OTHER
from loadshare.solver.hot.kernel import set_arrays
from loadshare.solver.hot.kernel.conclude import conclude
from loadshare.solver.hot.kernel.fill import fill
from loadshare.solver.hot.kernel.passes import give_up, run
from loadshare.solver.hot.kernel.set_arrays import SetArrays
from loadshare.solver.hot.kernel.work import _EACH, _RADIAL, _SPRING, Work

ASKED = -2
"""Verdict on a sample that needs an active set that is not prepared."""

_NUMPY = ModuleType("numpy")
"""The functions of NumPy that the kernel uses, as CUDA knows them."""
_NUMPY.__dict__.update(
    inf=np.inf,
    sqrt=math.sqrt,
    cbrt=libdevice.cbrt,
    isnan=math.isnan,
    isinf=math.isinf,
    isfinite=math.isfinite,
)


def on_device(function: Any, known: dict[Any, Any] | None = None) -> Any:
    """Return a function that Numba compiles for the CPU as one that CUDA compiles.

    Parameters
    ----------
    function
        A function or a dispatcher of Numba; the functions it calls are translated with it.
    known : dict, optional
        Functions that have been translated already.
    """
    known = {} if known is None else known
    plain = getattr(function, "py_func", function)
    if plain not in known:
        names = dict(plain.__globals__, np=_NUMPY)
        for name in plain.__code__.co_names:
            if hasattr(names.get(name), "py_func"):
                names[name] = on_device(names[name], known)
        code = FunctionType(plain.__code__, names, plain.__name__, plain.__defaults__)
        known[plain] = cuda.jit(device=True)(code)
    return known[plain]


@intrinsic
def _view(_context, pool, _start, shape):
    """Part of a pool as an array of a shape, without the checks of `reshape`."""
    kind = types.Array(pool.dtype, len(shape), "C")

    def code(context, builder, signature, arguments):
        base = make_array(signature.args[0])(context, builder, arguments[0])
        data = builder.gep(base.data, [arguments[1]])
        sizes = cgutils.unpack_tuple(builder, arguments[2])
        width = context.get_abi_sizeof(context.get_data_type(pool.dtype))
        itemsize = context.get_constant(types.intp, width)
        strides, step = [], itemsize
        for size in reversed(sizes):
            strides.insert(0, step)
            step = builder.mul(step, size)
        found = make_array(kind)(context, builder)
        populate_array(
            found, data=data, shape=sizes, strides=strides, itemsize=itemsize, meminfo=None
        )
        return found._getvalue()

    return kind(pool, types.intp, shape), code


@cuda.jit(device=True, inline="always")
def _table(floats, place):
    """Return a table of a packed set; see `set_arrays`."""
    return _view(floats, place[0], (place[1], place[2]))


@cuda.jit(device=True, inline="always")
def _list(rows, place):
    """Return a list of a packed set; see `set_arrays`."""
    return _view(rows, place[0], (place[1],))


@cuda.jit(device=True, inline="always")
def _lane(pool, place, rows):
    """Take (rows, 1) from a pool."""
    start = place[0]
    place[0] = start + rows
    return _view(pool, start, (rows, 1))


@cuda.jit(device=True, inline="always")
def _lanes(pool, place, tables, rows):
    """Take (tables, rows, 1) from a pool."""
    start = place[0]
    place[0] = start + tables * rows
    return _view(pool, start, (tables, rows, 1))


@cuda.jit(device=True, inline="always")
def _line(pool, place, rows):
    """Take (rows,) from a pool."""
    start = place[0]
    place[0] = start + rows
    return _view(pool, start, (rows,))


_known: dict[Any, Any] = {
    set_arrays._table.py_func: _table,
    set_arrays._list.py_func: _list,
}
_fill, _run, _give_up, _conclude, _unpacked = (
    on_device(function, _known) for function in (fill, run, give_up, conclude, set_arrays.unpacked)
)


@cuda.jit(device=True)
def _work(s, n, pool, numbers, marks):
    """Return `work_for` with a width of one, from pools of floats, integers and small integers."""
    r, springs, contacts = s.redundant.shape[1], s.springs.shape[0], s.contacts.shape[0]
    turned, radials, turning = s.borders.shape[0], s.radial_at.shape[0], s.turning.shape[0]
    arcs, tables = s.arcs.shape[0], s.tables_of.shape[0]
    size = r
    for t in range(turned):
        size += s.borders[t] >= 0
    place = cuda.local.array(1, np.int64)
    place[0] = 0
    return Work(
        numbers[0:1],
        numbers[1:2],
        _lane(pool, place, _EACH),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _line(pool, place, 1),
        _lane(pool, place, s.loaded.shape[0]),
        _lanes(pool, place, _SPRING, springs),
        _lane(pool, place, contacts),
        _lane(pool, place, contacts),
        _lane(pool, place, contacts),
        _lane(pool, place, contacts),
        _lane(pool, place, contacts),
        _lane(pool, place, contacts),
        _lane(pool, place, s.powers),
        _lane(pool, place, s.powers),
        _lane(pool, place, s.powers),
        _lane(pool, place, s.powers),
        _lane(pool, place, tables),
        _lanes(pool, place, turned, _RADIAL),
        _lanes(pool, place, turned, r),
        _lane(pool, place, arcs),
        _lane(pool, place, turning),
        _lane(pool, place, turning),
        _lane(pool, place, turning),
        _lane(pool, place, n),
        _line(pool, place, n),
        _lane(pool, place, r),
        _lane(pool, place, r),
        _lane(pool, place, size),
        _lane(pool, place, s.springs_entries.shape[0]),
        _lanes(pool, place, size, size),
        _lane(pool, place, 3),
        _view(marks, 0, (s.states.shape[0] - radials, 1)),
        _view(marks, s.states.shape[0] - radials, (radials, 1)),
    )


@cuda.jit(device=True)
def _number(states, keys, order, key_of):
    """Return the index of an active set among those prepared, −1 if it is not; see `exchange`."""
    key = np.int64(0)
    for k in range(states.shape[0]):
        key += key_of[k] * states[k]
    low, high = 0, keys.shape[0]
    while low < high:
        middle = (low + high) // 2
        if keys[middle] < key:
            low = middle + 1
        else:
            high = middle
    if low < keys.shape[0] and keys[low] == key:
        return order[low]
    return -1


@cuda.jit(device=True)
def _without_wedges(opposed, here, proposal):
    """Let only one of two opposed rigid arcs act; see `exchange`."""
    for k in range(opposed.shape[0]):
        one, other = opposed[k, 0], opposed[k, 1]
        if proposal[one] != OPEN and proposal[other] != OPEN:
            if here[one] != OPEN and here[other] == OPEN:
                proposal[one] = OPEN
            elif here[one] == OPEN:
                proposal[other] = OPEN


def settling(floats: int, switches: int, registers: int | None = None) -> Any:
    """Return the kernel for samples that need given numbers of floats and switches.

    Both are literals in it, so that the arrays of a thread lie in local memory.

    Parameters
    ----------
    floats, switches : int
    registers : int, optional
        Most registers of a thread; fewer registers leave room for more threads.
    """

    @cuda.jit(max_registers=registers)
    def settle(packed, lookup, samples, given, states, turns, some, limit):
        tables, numbers, begins, sets = packed
        keys, order, key_of, opposed = lookup
        pool = cuda.local.array(floats, np.float64)
        counts = cuda.local.array(2, np.int64)
        marks = cuda.local.array(switches, np.int8)
        waiting = cuda.local.array(1, np.int64)
        for k in range(floats):
            pool[k] = 0.0
        for at in range(cuda.grid(1), some.shape[0], cuda.gridsize(1)):
            i = some[at]
            turn = 0
            while turn < limit:
                g = _number(states[i], keys, order, key_of)
                if g < 0:
                    given.verdict[i] = ASKED
                    break
                given.verdict[i] = UNDECIDED
                turn += 1
                s = _unpacked(tables[begins[g, 0] :], numbers[begins[g, 1] :], sets[g], samples)
                work = _work(s, given.xs.shape[1], pool, counts, marks)
                waiting[0] = i
                _fill(s, work, given, waiting, 0, 1, 1)
                _run(s, work, given.one_only, 0, 1)
                _give_up(work, 1)
                _conclude(s, work, given, 1, 1)
                if given.verdict[i] != OTHER:
                    break
                _without_wedges(opposed, states[i], given.proposal[i])
                for k in range(states.shape[1]):
                    states[i, k] = given.proposal[i, k]
                if turn >= EXCHANGE.together:
                    given.one_only[i] = True
            turns[i] += turn

    return settle


def floats_of(numbers: NDArray[np.intp], n: int) -> int:
    """Return the largest number of floats that a thread works with.

    Parameters
    ----------
    numbers : ndarray of int
        Of a packed set.
    n : int
        Number of coordinates.
    """
    at = dict(
        zip(SetArrays._fields, numbers[: set_arrays._FRONT].reshape(-1, 3).tolist(), strict=False)
    )
    (_, contacts, r), (_, springs, _) = at["redundant"], at["springs"]
    turned, turning, arcs = (at[name][1] for name in ("turning_radials", "turning", "arcs"))
    size = r + turned
    single = _EACH + 16 + 2 * n + _SPRING * springs + 13 * contacts + arcs + 3 * turning
    return single + n + turned * (_RADIAL + r) + 3 * size + size * (size + 1) // 2 + size * size + 3
