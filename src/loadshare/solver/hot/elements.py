"""Elements of many samples: rows of arrays that vary, pieces of tables, arcs."""

from __future__ import annotations

import numpy as np

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
    last = (~np.isnan(axis)).sum(axis=2) - 2
    k = np.minimum(np.maximum((axis <= where[:, :, None]).sum(axis=2) - 1, 0), last)
    at = np.arange(len(k))[:, None] if len(axis) > 1 else 0, np.arange(k.shape[1])
    x0, y0 = axis[(*at, k)], values[(*at, k)]
    return x0, y0, (values[(*at, k + 1)] - y0) / (axis[(*at, k + 1)] - x0)


def arc_at(loading: Loading, a: int, rows: Numbers, x: Array) -> tuple[Array, Array]:
    """Return normal (k, 3) and margin (k,) of an arc at coordinates x (k, n); see `Arc`."""
    nominal = loading.nominal[a]
    moved = pick(loading.shift, rows)[:, a] + x @ loading.relative[a].T
    d, here, margin = rolled(nominal, moved)
    beyond = d @ nominal <= 0.0
    if beyond.any():
        d[beyond] = nominal
        here[beyond] = distance = np.sqrt(nominal @ nominal)
        margin[beyond] = moved[beyond] @ nominal / distance
    return d / here[:, None], margin + pick(loading.clearance, rows)[:, a]


def times(matrices: Array, vectors: Array) -> Array:
    """Return the products of (k, n, n) with (k, n)."""
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])
