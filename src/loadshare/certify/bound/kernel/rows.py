"""Claims side by side: their numbers in rows, one number per claim.

A loop over claims reads and writes few rows: with more, the compiler cannot tell that they do not
overlap, and takes one claim after another. Rows always have full width, so that all loops have the
same length; beyond the last claim their entries have no meaning.
"""

from __future__ import annotations

from loadshare.by_reference import set_apart
from loadshare.certify.bound.kernel.options import inlined, within
from loadshare.extremes import larger
from loadshare.settings import BOUND


@inlined
def row_of(array, s):  # type: ignore[no-untyped-def]
    """Return the row of a claim, or the only one."""
    return s if len(array) > 1 else 0


@within
def put_rows(array, first, width, rows):  # type: ignore[no-untyped-def]
    """Write an array of claims, or one that all share, (S or 1, k), into rows."""
    set_apart()
    step = 1 if len(array) > 1 else 0
    for v in range(width):
        for k in range(len(rows)):
            rows[k, v] = array[step * (first + v), k]


@within
def take_rows(array, first, width, rows):  # type: ignore[no-untyped-def]
    """Write rows into an array of claims, (S, k)."""
    set_apart()
    for v in range(width):
        for k in range(len(rows)):
            array[first + v, k] = rows[k, v]


@within
def take_row(figures, first, width, row):  # type: ignore[no-untyped-def]
    """Write a row into an array of claims, (S,)."""
    set_apart()
    for v in range(width):
        figures[first + v] = row[v]


@within
def put_column(column, first, width, row):  # type: ignore[no-untyped-def]
    """Write a number of each claim, or the one that all share, into a row."""
    set_apart()
    step = 1 if len(column) > 1 else 0
    for v in range(width):
        row[v] = column[step * (first + v)]


@within
def fill(row, value):  # type: ignore[no-untyped-def]
    """Write one value into a row."""
    set_apart()
    for v in range(BOUND.side_by_side):
        row[v] = value


@within
def put_sum(total, row, factor):  # type: ignore[no-untyped-def]
    """Add a multiple of a row."""
    set_apart()
    for v in range(BOUND.side_by_side):
        total[v] += factor * row[v]


@within
def put_sizes(total, row, factor):  # type: ignore[no-untyped-def]
    """Add the sizes of a multiple of a row."""
    set_apart()
    for v in range(BOUND.side_by_side):
        total[v] += abs(factor * row[v])


@within
def put_multiple(product, row, factor):  # type: ignore[no-untyped-def]
    """Write a multiple of a row."""
    set_apart()
    for v in range(BOUND.side_by_side):
        product[v] = factor * row[v]


@within
def put_most(most, row, factor):  # type: ignore[no-untyped-def]
    """Take the larger of a row and a multiple of another."""
    set_apart()
    for v in range(BOUND.side_by_side):
        most[v] = larger(most[v], factor * row[v])


@within
def put_largest(most, row, factor):  # type: ignore[no-untyped-def]
    """Take the larger of a row and a multiple of the sizes of another."""
    set_apart()
    for v in range(BOUND.side_by_side):
        most[v] = larger(most[v], factor * abs(row[v]))


@within
def put_product(rows, start, end, at, value, numbers):  # type: ignore[no-untyped-def]
    """Add the product of a matrix, given by the entries of each of its rows, with numbers."""
    set_apart()
    for j in range(len(rows)):
        row = rows[j]
        for i in range(start[j], end[j]):
            factor, other = value[i], numbers[at[i]]
            for v in range(BOUND.side_by_side):
                row[v] += factor * other[v]
