"""Sparse Gaussian elimination in any arithmetic; free unknowns are returned as null vectors."""

from __future__ import annotations

from typing import Any

Sparse = list[dict[int, Any]]

PIVOT = 0.1
"""Fraction of a column's largest entry that a pivot must reach; it leaves room to choose for
sparsity."""


class Contradiction(ArithmeticError):  # noqa: N818 -- a finding, not a fault
    """The equations contradict each other.

    Parameters
    ----------
    left : number
        Right-hand side of the worst equation without unknowns.
    spans : list of list
        Null vectors of the matrix.
    """

    def __init__(self, left: Any, spans: list[list[Any]]) -> None:
        self.left, self.spans = left, spans
        super().__init__(f"an equation without unknowns is left with {float(left):.1e}")


def solve_sparse(
    rows: Sparse, right: list[Any], size: int, nothing: Any
) -> tuple[list[Any], list[list[Any]]]:
    """Solve A z = r.

    Parameters
    ----------
    rows : list of dict
        Rows of A by column; they are overwritten.
    right : list
        r.
    size : int
        Number of unknowns.
    nothing : number
        Magnitude below which a remaining entry counts as zero.

    Returns
    -------
    list
        One solution, with the free unknowns zero.
    list of list
        Null vectors of A, one per free unknown.

    Raises
    ------
    Contradiction
        If a row without unknowns has a non-zero right-hand side.
    """
    columns: list[set[int]] = [set() for _ in range(size)]
    for i, row in enumerate(rows):
        for j in row:
            columns[j].add(i)
    left = set(range(size))
    order: list[tuple[int, int]] = []
    free: list[int] = []
    while left:
        column = min(left, key=lambda j: len(columns[j]))
        left.discard(column)
        largest = max((abs(rows[i][column]) for i in columns[column]), default=0)
        if largest <= nothing:
            free.append(column)
            for i in columns[column]:
                rows[i].setdefault(column, 0)
            continue
        fit = [i for i in columns[column] if abs(rows[i][column]) >= PIVOT * largest]
        pivot = min(fit, key=lambda i: len(rows[i]))
        _eliminate(rows, right, columns, pivot, column)
        order.append((pivot, column))
    used = {i for i, _ in order}
    none = [0 * r for r in right]
    spans = [_back(rows, none, order, size, {j: 1}) for j in free]
    left_over = max((abs(v) for i, v in enumerate(right) if i not in used), default=0)
    if left_over > nothing:
        raise Contradiction(left_over, spans)
    return _back(rows, right, order, size, {}), spans


def _eliminate(
    rows: Sparse, right: list[Any], columns: list[set[int]], pivot: int, column: int
) -> None:
    row, value = rows[pivot], rows[pivot][column]
    for j in row:
        columns[j].discard(pivot)
    for i in list(columns[column]):
        factor = rows[i].pop(column) / value
        target = rows[i]
        for j, entry in row.items():
            if j == column:
                continue
            if j in target:
                target[j] -= factor * entry
            else:
                target[j] = -factor * entry
                columns[j].add(i)
        right[i] -= factor * right[pivot]
    columns[column].clear()


def _back(
    rows: Sparse,
    right: list[Any],
    order: list[tuple[int, int]],
    size: int,
    given: dict[int, Any],
) -> list[Any]:
    values: list[Any] = [given.get(j, 0) for j in range(size)]
    for pivot, column in reversed(order):
        row = rows[pivot]
        rest = right[pivot] - sum(v * values[j] for j, v in row.items() if j != column)
        values[column] = rest / row[column]
    return values
