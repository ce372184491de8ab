"""Elements of many samples: rows of arrays that vary, pieces of tables, arcs."""

from __future__ import annotations

from typing import NamedTuple

from loadshare.array_library import library_of
from loadshare.array_types import Array, Numbers
from loadshare.contact.arc import rolled
from loadshare.scene.loading import Loading


def pick(array: Array, rows: Numbers) -> Array:
    """Return some rows of an array, or its only row if all samples share one."""
    return array[rows] if len(array) > 1 else array


def piece(axis: Array, values: Array, where: Array) -> tuple[Array, Array, Array]:
    """Return start on the axis, start value and slope of the pieces of tables that hold `where`.

    Parameters
    ----------
    axis, values : ndarray, shape (S or 1, tables, points)
    where : ndarray, shape (S, tables)
    """
    xp = library_of(where)
    last = xp.count_nonzero(~xp.isnan(axis), axis=2) - 2
    passed = xp.count_nonzero(axis <= where[:, :, None], axis=2)
    k = xp.minimum(xp.maximum(passed - 1, 0), last)[:, :, None]

    def at(points: Array, number: Numbers) -> Array:
        found: Array = xp.take_along_axis(points, number, axis=2)[:, :, 0]
        return found

    x0, y0 = at(axis, k), at(values, k)
    return x0, y0, (at(values, k + 1) - y0) / (at(axis, k + 1) - x0)


class Arcs(NamedTuple):
    """Arcs of some samples; the arrays are those of `Loading`."""

    nominal: Array
    shift: Array
    clearance: Array
    relative: Array


def arcs_of(loading: Loading, rows: Numbers) -> Arcs:
    """Return the arcs of some samples."""
    varying = pick(loading.shift, rows), pick(loading.clearance, rows)
    return Arcs(loading.nominal, *varying, loading.relative)


def arcs_at(arcs: Arcs, x: Array) -> tuple[Array, Array]:
    """Return normals (k, arcs, 3) and margins (k, arcs) at coordinates x (k, n); see `Arc`."""
    xp, nominal = library_of(x), arcs.nominal
    lines = xp.reshape(arcs.relative, (3 * nominal.shape[0], x.shape[1]))
    moved = arcs.shift + xp.reshape(x @ lines.T, (x.shape[0], *nominal.shape))
    d, here, margin = rolled(nominal, moved)
    beyond = xp.sum(d * nominal, axis=2) <= 0.0
    if xp.any(beyond):
        distance = xp.sqrt(xp.sum(nominal * nominal, axis=1))
        d = xp.where(beyond[:, :, None], nominal, d)
        here = xp.where(beyond, distance, here)
        margin = xp.where(beyond, xp.sum(moved * nominal, axis=2) / distance, margin)
    return d / here[:, :, None], margin + arcs.clearance


def times(matrices: Array, vectors: Array) -> Array:
    """Return the products of (k, n, n) with (k, n)."""
    return (matrices @ vectors[:, :, None])[:, :, 0]
