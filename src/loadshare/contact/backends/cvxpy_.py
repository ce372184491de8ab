"""The readable reference formulation in CVXPY: the programme as the theory page writes it."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from loadshare.contact.backends.backend import KINDS_CONIC, Backend, BackendFailure
from loadshare.contact.programme import Cone, Point, Programme
from loadshare.settings import CONTACT


@dataclass(frozen=True, eq=False)
class CvxpyForm:
    """A programme in CVXPY.

    Attributes
    ----------
    problem : cvxpy.Problem
        To be solved with any solver that CVXPY has for its cones.
    x : cvxpy.Variable
        The coordinates.
    contacts, radials : list of cvxpy.Constraint
        Constraints whose multipliers are the forces.
    """

    problem: Any
    x: Any
    contacts: list[Any]
    radials: list[Any]

    def point(self) -> Point:
        """Read the answer of the solved problem.

        Raises
        ------
        ValueError
            If it has none.
        """
        if self.x.value is None:
            status = self.problem.status or "not solved yet"
            raise ValueError(f"the CVXPY problem has no answer to read: {status}")
        forces = np.array([float(c.dual_value) for c in self.contacts])
        cone_forces = np.array([r.dual_value for r in self.radials]).reshape(-1, 2)
        return Point(np.asarray(self.x.value), forces, cone_forces)


def cvxpy_form(programme: Programme) -> CvxpyForm:
    """Write a programme in CVXPY."""
    import cvxpy as cp

    x = cp.Variable(len(programme.load))
    energy = 0.5 * cp.sum_squares(_square_root(programme.stiffness).T @ x) - programme.load @ x
    contacts: list[Any] = []
    constraints: list[Any] = []
    for e in range(len(programme.gaps)):
        yielded = 0.0
        b, c = float(programme.linear[e]), float(programme.hertz[e])
        if b > 0.0:
            bending = cp.Variable()  # compression over √b, so that its energy is a plain square
            energy += 0.5 * cp.square(bending)
            yielded += np.sqrt(b) * bending
        if c > 0.0:
            hertz = cp.Variable(nonneg=True)
            energy += 0.4 * c**-1.5 * cp.power(hertz, 2.5)
            yielded += hertz
        approach = programme.rows[e] @ x - float(programme.gaps[e])
        closed = bool(programme.assumed_closed[e])
        contacts.append(approach == yielded if closed else approach <= yielded)
    radials = []
    for cone in programme.cones:
        law_energy, offset = _radial(cone, x, constraints)
        energy += law_energy
        radials.append(offset)
    problem = cp.Problem(cp.Minimize(energy), [*contacts, *radials, *constraints])
    return CvxpyForm(problem, x, contacts, radials)


def _radial(cone: Cone, x: Any, constraints: list[Any]) -> tuple[Any, Any]:
    """Return a radial graph's energy, an inf-convolution of its pieces, and its offset equation."""
    import cvxpy as cp

    energy, total = 0.0, 0.0
    for piece in cone.law.pieces:
        s = cp.Variable(2)
        if piece.force > 0.0:
            energy += piece.force * cp.norm(s, 2)
        if piece.stiffness > 0.0:
            energy += 0.5 * piece.stiffness * cp.sum_squares(s)
        if np.isfinite(piece.length):
            constraints.append(cp.norm(s, 2) <= piece.length)
        total = total + s
    return energy, cone.matrix @ x - cone.centre == total


class Cvxpy(Backend):
    """CVXPY with Clarabel underneath: slow, short, written from the formulas."""

    name = "cvxpy"
    kinds = KINDS_CONIC

    def solve(self, programme: Programme) -> Point:
        """See :meth:`loadshare.contact.backends.backend.Backend.solve`."""
        import cvxpy as cp

        form = cvxpy_form(programme)
        try:
            with warnings.catch_warnings():
                # CVXPY warns of answers that miss its tolerances; here the certificate judges them.
                warnings.simplefilter("ignore", UserWarning)
                names = ("tol_gap_abs", "tol_gap_rel", "tol_feas")
                form.problem.solve(solver=cp.CLARABEL, **dict.fromkeys(names, CONTACT.interior))
        except cp.error.SolverError as error:
            raise BackendFailure(f"CVXPY gave no point ({error})") from error
        if form.x.value is None:
            raise BackendFailure(f"CVXPY gave no point (status {form.problem.status})")
        return form.point()


def _square_root(matrix: np.ndarray) -> np.ndarray:
    """Return L with L Lᵀ = H for a semidefinite H."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
