"""Distinct rows of small integers, numbered as samples first show them, compiled with Numba."""

from __future__ import annotations

import numpy as np

from loadshare import compilation

inlined = compilation.within(forceinline=True, nogil=True, error_model="numpy", _nrt=False)


@inlined
def numbered(s, rows, first, key, count, last):  # type: ignore[no-untyped-def]
    """Return the count of distinct rows so far, and the number of a sample's row; −1 if no room.

    `first` holds the first sample with each row, `key` the row's hash, both as long as the most
    rows that are numbered; `last` is the number of the previous sample's row.
    """
    if last >= 0 and count > 0 and _same(rows, s, first[last]):
        return count, last
    own = np.uint64(0)
    for c in range(rows.shape[1]):
        own = own * np.uint64(6364136223846793005) + np.uint64(1 + rows[s, c])
    for k in range(count):
        if key[k] == own and _same(rows, s, first[k]):
            return count, k
    if count == len(first):
        return count, -1
    first[count], key[count] = s, own
    return count + 1, count


@inlined
def _same(rows, one, other):  # type: ignore[no-untyped-def]
    same = True
    for c in range(rows.shape[1]):
        same &= rows[one, c] == rows[other, c]
    return same
