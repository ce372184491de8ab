r"""A programme in the forms that other solvers take: QP, linear complementarity, cones, CVXPY.

Each form names its variables and reads an answer back as a point of the programme. All are
dimensionless. The quadratic form is

.. math:: \min_z \; \tfrac12 z^\mathsf{T} P z + q^\mathsf{T} z
    \quad \text{s.t.} \quad l \le A z \le u,

the complementarity form asks for z ≥ 0 with

.. math:: w = M z + q \ge 0, \qquad z^\mathsf{T} w = 0.

Source: formulation, sections 4 to 6; Cottle, Pang, Stone, The Linear Complementarity Problem, 1992.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from loadshare.array_types import Array, shaped
from loadshare.contact.backends.conic import ConicForm, conic_form
from loadshare.contact.programme import Point, Programme
from loadshare.settings import CONTACT

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix


@dataclass(frozen=True, eq=False)
class QuadraticForm:
    """A programme without radial elements and Hertz laws as a QP.

    Attributes
    ----------
    quadratic : csc_matrix, shape (k, k)
        P, upper triangle.
    linear : ndarray, shape (k,)
        q.
    matrix : csc_matrix, shape (r, k)
        A.
    lower, upper : ndarray, shape (r,)
        l (−∞ where there is none) and u.
    variables : tuple of str
        Coordinates, then the compression of every compliant contact over √b.
    rows : tuple of str
        Contacts in the order of A.
    """

    quadratic: csc_matrix
    linear: Array
    matrix: csc_matrix
    lower: Array
    upper: Array
    variables: tuple[str, ...]
    rows: tuple[str, ...]
    form: ConicForm

    def point(self, z: Array, dual: Array) -> Point:
        """Read a primal-dual answer; a multiplier is positive where the upper bound acts."""
        return self.form.point(z, dual)


@dataclass(frozen=True, eq=False)
class ComplementarityForm:
    """A programme without radial elements and Hertz laws as a linear complementarity problem.

    If springs hold every coordinate, the unknowns z are the forces alone, and M is a compliance
    matrix; otherwise z holds positive and negative parts of the coordinates, then the forces.

    Attributes
    ----------
    matrix : ndarray, shape (k, k)
        M, positive semidefinite.
    vector : ndarray, shape (k,)
        q.
    unknowns : tuple of str
    """

    matrix: Array
    vector: Array
    unknowns: tuple[str, ...]
    programme: Programme

    def point(self, z: Array) -> Point:
        """Read an answer z."""
        z, programme = shaped("z", z, self.vector.shape), self.programme
        n, m = programme.rows.shape[1], len(programme.gaps)
        forces = z[len(z) - m :]
        if len(z) == m:
            load = programme.load - programme.rows.T @ forces
            x = np.asarray(np.linalg.solve(programme.stiffness, load))
        else:
            x = z[:n] - z[n : 2 * n]
        return Point(x, forces, np.zeros((0, 2)))


def quadratic_form(programme: Programme) -> QuadraticForm:
    """Write a programme as a QP.

    Raises
    ------
    ValueError
        If it has radial elements or Hertz laws, which a QP cannot express; the message names them.
    """
    _only_linear(programme, "a QP")
    form = conic_form(programme)
    equal = sum(int(size) for kind, size in form.cones if kind == "zero")
    lower = np.full(len(form.bounds), -np.inf)
    lower[:equal] = form.bounds[:equal]
    order = np.argsort(form.row_of)
    yielding = [n for n, b in zip(programme.names, programme.linear, strict=True) if b > 0.0]
    return QuadraticForm(
        form.quadratic,
        form.linear,
        form.matrix,
        lower,
        form.bounds,
        (*programme.coordinates, *(f"{n} yields" for n in yielding)),
        tuple(programme.names[k] for k in order),
        form,
    )


def complementarity_form(programme: Programme) -> ComplementarityForm:
    """Write a programme as a linear complementarity problem.

    Contacts that are assumed closed become contacts that may open: their sign has been verified.

    Raises
    ------
    ValueError
        As `quadratic_form`.
    """
    _only_linear(programme, "a linear complementarity problem")
    h, a, n = programme.stiffness, programme.rows, len(programme.load)
    soft = np.diag(programme.linear)
    values = np.linalg.eigvalsh(h) if n else np.zeros(0)
    if n and values[0] > CONTACT.definite * values[-1]:
        inverse = np.linalg.inv(h)
        matrix = a @ inverse @ a.T + soft
        vector = programme.gaps - a @ inverse @ programme.load
        return ComplementarityForm(matrix, vector, programme.names, programme)
    matrix = np.block([[h, -h, a.T], [-h, h, -a.T], [-a, a, soft]])
    vector = np.concatenate([-programme.load, programme.load, programme.gaps])
    parts = [f"{c} {sign}" for sign in "+-" for c in programme.coordinates]
    return ComplementarityForm(matrix, vector, (*parts, *programme.names), programme)


def _only_linear(programme: Programme, what: str) -> None:
    others = [cone.name for cone in programme.cones]
    others += [n for n, c in zip(programme.names, programme.hertz, strict=True) if c > 0.0]
    if others:
        raise ValueError(
            f"{what} cannot express {', '.join(others)} (radial elements need second-order cones, "
            "Hertz laws power cones); use the conic form"
        )
