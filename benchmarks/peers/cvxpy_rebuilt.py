"""CVXPY as most people use it: the problem written again in every pass, solved by Clarabel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim, Failure, settle
from loadshare.contact.radial import RadialLaw


class CvxpyRebuilt:
    """The problem as the theory page writes it."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance

    def prepare(self, form: Form) -> None:
        """Do nothing: nothing can be prepared."""

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        return settle(form, self._inner, self.tolerance)

    def _inner(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        import cvxpy as cp

        x, y = cp.Variable(form.size), cp.Variable(len(gaps))
        root = square_root(form.stiffness)
        energy = 0.5 * cp.sum_squares(root.T @ x) - form.load @ x + 0.5 * cp.sum_squares(y)
        contact = rows @ x - cp.multiply(np.sqrt(compliance), y) <= gaps
        offsets, discs = [], []
        for graph, law in zip(form.graphs, laws, strict=True):
            more, offset, inside = radial(graph.matrix @ x - graph.centre, law)
            energy += more
            offsets.append(offset)
            discs += inside
        problem = cp.Problem(cp.Minimize(energy), [contact, *offsets, *discs])
        solve_with_clarabel(problem, self.tolerance)
        return Claim(
            np.asarray(x.value), np.asarray(contact.dual_value), [o.dual_value for o in offsets]
        )


def radial(offset: Any, law: RadialLaw, parameters: list[Any] | None = None) -> tuple[Any, ...]:
    """Return the energy of a radial law as an inf-convolution, its offset equation, and its discs.

    Parameters
    ----------
    offset : cvxpy expression, shape (2,)
    law : RadialLaw
    parameters : list, optional
        List to which forces and lengths of the pieces are appended as parameters, to be changed
        later.
    """
    import cvxpy as cp

    energy, total, inside = 0.0, 0.0, []
    for piece in law.pieces:
        force, length = piece.force, piece.length
        if parameters is not None:
            force = cp.Parameter(nonneg=True)
            length = cp.Parameter(nonneg=True) if np.isfinite(piece.length) else piece.length
            parameters.append((force, length))
        s = cp.Variable(2)
        if piece.force or parameters is not None:
            energy += force * cp.norm(s, 2)
        if piece.stiffness:
            energy += 0.5 * piece.stiffness * cp.sum_squares(s)
        if np.isfinite(piece.length):
            inside.append(cp.norm(s, 2) <= length)
        total = total + s
    return energy, offset == total, inside


def solve_with_clarabel(problem: Any, tolerance: float) -> None:
    """Solve a CVXPY problem.

    Raises
    ------
    Failure
        If CVXPY has no answer, or discards an inaccurate one.
    """
    import warnings

    import cvxpy as cp

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            problem.solve(
                solver=cp.CLARABEL, tol_gap_abs=tolerance, tol_gap_rel=tolerance, tol_feas=tolerance
            )
    except cp.error.SolverError as error:
        raise Failure(f"CVXPY: {error}") from error
    if problem.status not in ("optimal", "optimal_inaccurate"):
        raise Failure(f"CVXPY: {problem.status}")


def square_root(matrix: Array) -> Array:
    """Return L with L Lᵀ = H for a semidefinite H."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def make(tolerance: float) -> CvxpyRebuilt:
    """Return CVXPY, rebuilt."""
    return CvxpyRebuilt(tolerance)
