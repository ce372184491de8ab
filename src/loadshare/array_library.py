"""Arrays of NumPy, or of another library that keeps to the array API standard (2024.12).

Code that asks an array for the functions of its library, uses nothing beyond the standard and
writes into no array runs with any such library, and so on whatever device holds its arrays.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from loadshare.array_types import Array, Flags, Numbers


def library_of(array: Any) -> Any:
    """Return the functions of the library that an array belongs to."""
    return array.__array_namespace__()


def to_numpy(array: Any) -> np.ndarray:
    """Return an array of any library as one of NumPy's, which may share its memory."""
    if isinstance(array, np.ndarray):
        return array
    return np.from_dlpack(array, device="cpu")


def cube_root(numbers: Array) -> Array:
    """Return the cube roots of numbers that are not negative."""
    xp = library_of(numbers)
    # The standard has no cube root.
    found: Array = xp.cbrt(numbers) if hasattr(xp, "cbrt") else numbers ** (1.0 / 3.0)
    return found


def largest(vectors: Array) -> Array:
    """Return the size of the largest entry of every row (k,); 0 where rows have no entries."""
    xp = library_of(vectors)
    found: Array = xp.max(xp.abs(vectors), axis=1) if vectors.shape[1] else xp.sum(vectors, axis=1)
    return found


def lengths(vectors: Array) -> Array:
    """Return the lengths (k,) of vectors (k, n)."""
    xp = library_of(vectors)
    found: Array = xp.sqrt(xp.sum(vectors * vectors, axis=1))
    return found


def columns(values: Array, at: Numbers) -> Array:
    """Return some columns of values (k, n), each in one piece, so that rows are compared faster."""
    found: Array = library_of(values).take(values.T, at, axis=0).T
    return found


def in_places(values: Array, place: Numbers) -> Array:
    """Return columns of values (k, n) in other places (k, m); zero or false in those without one.

    Parameters
    ----------
    values : ndarray, shape (k, n)
    place : ndarray of int, shape (m,)
        Which column comes to each place, n for none.
    """
    xp = library_of(values)
    none = xp.zeros((values.shape[0], 1), dtype=values.dtype, device=values.device)
    return columns(xp.concat([values, none], axis=1), place)


def put_rows(these: Flags, values: Array, others: Array) -> Array:
    """Return an array (k, n) whose rows are those of `values`, in order, where a flag is set."""
    xp = library_of(values)
    if not values.shape[0]:
        return others
    number = xp.cumulative_sum(xp.astype(these, xp.int64)) - 1
    rows = xp.take(values, xp.maximum(number, 0), axis=0)
    found: Array = xp.where(these[:, None], rows, others)
    return found
