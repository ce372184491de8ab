"""Sums over rows, and systems of equations, for samples side by side."""

from __future__ import annotations

from loadshare.settings import SIDE_BY_SIDE
from loadshare.solver.hot.kernel.options import bare


@bare
def add_product(total, weights, table, width):  # type: ignore[no-untyped-def]
    """Add weights (p, q) times the first q rows of a table, (·, width), to total (p, width).

    This takes two rows and four terms at a time, so that a term is fetched once for two rows, and
    skips them where all of their weights are zero.
    """
    p, q = weights.shape
    rows, terms = p - p % 2, q - q % 4
    for o in range(0, rows, 2):
        for e in range(0, terms, 4):
            a0, a1, a2, a3 = weights[o, e], weights[o, e + 1], weights[o, e + 2], weights[o, e + 3]
            b0, b1 = weights[o + 1, e], weights[o + 1, e + 1]
            b2, b3 = weights[o + 1, e + 2], weights[o + 1, e + 3]
            if a0 == a1 == a2 == a3 == b0 == b1 == b2 == b3 == 0.0:
                continue
            for m in range(width):
                t0, t1, t2, t3 = table[e, m], table[e + 1, m], table[e + 2, m], table[e + 3, m]
                total[o, m] += (a0 * t0 + a1 * t1) + (a2 * t2 + a3 * t3)
                total[o + 1, m] += (b0 * t0 + b1 * t1) + (b2 * t2 + b3 * t3)
        for e in range(terms, q):
            a0, b0 = weights[o, e], weights[o + 1, e]
            if a0 == b0 == 0.0:
                continue
            for m in range(width):
                total[o, m] += a0 * table[e, m]
                total[o + 1, m] += b0 * table[e, m]
    for o in range(rows, p):
        for e in range(0, terms, 4):
            a0, a1, a2, a3 = weights[o, e], weights[o, e + 1], weights[o, e + 2], weights[o, e + 3]
            if a0 == a1 == a2 == a3 == 0.0:
                continue
            for m in range(width):
                total[o, m] += (a0 * table[e, m] + a1 * table[e + 1, m]) + (
                    a2 * table[e + 2, m] + a3 * table[e + 3, m]
                )
        for e in range(terms, q):
            a0 = weights[o, e]
            for m in range(width):
                total[o, m] += a0 * table[e, m]


@bare
def clear(table, width):  # type: ignore[no-untyped-def]
    """Set a table (rows, width) to zero."""
    for o in range(table.shape[0]):
        for m in range(width):
            table[o, m] = 0.0


@bare
def approach(s, samples, column, x, width, total):  # type: ignore[no-untyped-def]
    """Write A x − g (width,) for one column of a row or of a radial element."""
    varying = s.gap.shape[0] > 1
    for m in range(width):
        total[m] = -s.gap[samples[m] if varying else 0, column]
    first, end = s.starts[column], s.starts[column + 1]
    pairs = end - (end - first) % 2
    for c in range(first, pairs, 2):
        d, e, along, across = s.coordinates[c], s.coordinates[c + 1], s.entries[c], s.entries[c + 1]
        for m in range(width):
            total[m] += along * x[d, m] + across * x[e, m]
    for c in range(pairs, end):
        d, along = s.coordinates[c], s.entries[c]
        for m in range(width):
            total[m] += along * x[d, m]


@bare
def solve(matrix, right, factor, definite, width, singular, largest, pivot):  # type: ignore[no-untyped-def]
    """Solve symmetric systems (size, size, width) in place, given their lower triangles.

    The first `definite` rows are positive definite, the others borders. Below the diagonal of each
    column, only the rows in which the factor is not zero (starts, rows) are visited.
    """
    starts, below = factor
    size = right.shape[0]
    for m in range(width):
        largest[m] = 0.0
    for c in range(size):
        if c < definite:
            for m in range(width):
                p = matrix[c, c, m]
                largest[m] = p if p > largest[m] else largest[m]
                singular[m] = singular[m] if p > SIDE_BY_SIDE.doubtful * largest[m] else 1.0
                pivot[m] = 1.0 / p
        else:
            for m in range(width):
                p = matrix[c, c, m]
                singular[m] = singular[m] if -p * largest[m] > SIDE_BY_SIDE.doubtful else 1.0
                pivot[m] = 1.0 / p
        for k in range(starts[c], starts[c + 1]):
            d = below[k]
            for m in range(width):
                matrix[c, d, m] = matrix[d, c, m] * pivot[m]
            for i in range(starts[c], k + 1):
                e = below[i]
                for m in range(width):
                    matrix[d, e, m] -= matrix[d, c, m] * matrix[c, e, m]
            for m in range(width):
                right[d, m] -= matrix[c, d, m] * right[c, m]
        for m in range(width):
            right[c, m] *= pivot[m]
    for c in range(size - 1, -1, -1):
        for k in range(starts[c], starts[c + 1]):
            d = below[k]
            for m in range(width):
                right[c, m] -= matrix[c, d, m] * right[d, m]
