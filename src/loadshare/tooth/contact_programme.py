r"""The contact programme: quadratic programmes that follow the contact law.

With the strips' widths held, or the law replaced by its tangent, the problem of
:mod:`loadshare.tooth.contact_problem` is the quadratic programme

.. math:: \min_{p\ge 0}\ \tfrac12 p^\mathsf{T} F p + w^\mathsf{T} p
    \quad\text{s.t.}\quad \textstyle\sum p = P \qquad : Z

It is solved exactly, by exchange of closed points, and where an exchange comes back to a set by the
package's solver interface: with :math:`F = L L^\mathsf{T}` its dual has the interface's form,

.. math:: \min_{Z, y}\ \tfrac12\lVert y\rVert^2 - P Z
    \quad\text{s.t.}\quad Z - (L y)_i \le w_i \qquad : p_i

The first programme holds the widths, the next ones are Newton's method on the law with its closed
points (semismooth), which converges quadratically; where a step is no shorter than the last, widths
are held once more. What leaves is in touch to round-off, and certified.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.errors import Refused
from loadshare.scene.programme import Programme
from loadshare.solver.backend import Backend, backend
from loadshare.solver.findings import Unsolved
from loadshare.solver.inner import solve_programme
from loadshare.tooth.body import Array
from loadshare.tooth.contact_certificate import ContactCertificate, certify_contact
from loadshare.tooth.contact_problem import ContactProblem

Mask = NDArray[np.bool_]

PASSES = 60
"""Passes after which a contact that does not settle is given up."""
SETTLED = 1e-12
"""Distance of closed points, in deflections, at which a contact has settled."""
ROUND_OFF = 16.0 * float(np.finfo(float).eps)
"""Part of a gap that counts as nothing."""
EXCHANGES = 40
"""Exchanges in one pass before the solver interface is asked instead."""
BAND = 1e-13
"""Violation of a sign, in loads and deflections, that counts as round-off."""


@dataclass(frozen=True, eq=False)
class Contact:
    """A certified contact.

    Attributes
    ----------
    force : array (N,)
        [N].
    approach : float
        Z [m].
    distance : array (N,)
        d [m]; 0 where the flanks touch.
    tangent : float
        dZ/dP [m/N].
    passes : int
    certificate : ContactCertificate
    """

    force: Array
    approach: float
    distance: Array
    tangent: float
    passes: int
    certificate: ContactCertificate


def solve_contact(
    problem: ContactProblem,
    load: float,
    warm: Array | None = None,
    solver: str = "clarabel",
) -> Contact:
    """Solve the contact under a load.

    Parameters
    ----------
    problem : ContactProblem
    load : float
        P [N], positive.
    warm : array (N,), optional
        Forces under another load, to begin from.
    solver : str
        Back-end for programmes that the exchange does not solve.

    Raises
    ------
    ValueError
        If the load is not positive.
    Refused
        If no contact is found that its certificate passes.
    """
    if not (load > 0.0 and np.isfinite(load)):
        raise ValueError(f"load = {load}: the flanks are pressed together; allowed: above 0 N")
    force = np.full(len(problem.gap), load / len(problem.gap))
    newton = warm is not None
    if warm is not None:
        force = warm * (load / float(np.sum(warm)))
    last = np.inf
    for passes in range(PASSES):
        secant, tangent = problem.compliance(force)
        yielded = secant @ force
        approach = float((yielded + problem.gap) @ force) / load
        distance = yielded + problem.gap - approach
        closed = force > 0.0
        missed = float(np.max(np.where(closed, np.abs(distance), -distance)))
        # Light loads yield less than the gaps that they close; those have their own round-off.
        least = ROUND_OFF * float(problem.gap[closed].max())
        if missed < SETTLED * float(np.abs(yielded).max()) + least:
            certificate = certify_contact(problem, load, force, approach)
            if not certificate.passed:
                raise Refused(_told(load, certificate), certificate.failing)
            _, slope = _saddle(tangent, np.zeros_like(force), 1.0, closed)
            distance = np.where(closed, 0.0, distance)
            return Contact(force, approach, distance, slope, passes, certificate)
        matrix, gap = secant, problem.gap
        if newton:
            # The law at the last forces by its tangent: a linear contact with a shifted gap.
            matrix, gap = tangent, problem.gap + yielded - tangent @ force
        found = exchange(matrix, gap, load, closed)
        if found is None:
            found = by_interface(matrix, gap, load, force, backend(solver))
        step = float(np.abs(found - force).max())
        # Where Newton's method does not draw in, a pass at fixed widths does.
        newton = not newton or step < last
        force, last = found, step
    raise Refused(
        f"the contact under {load:.6g} N did not settle in {PASSES} passes; more points a line, or "
        "a smoother gap, may help",
    )


def _told(load: float, certificate: ContactCertificate) -> str:
    figures = ", ".join(f"{n} {v:.1e}" for n, v in certificate.failing.items())
    return (
        f"the contact under {load:.6g} N does not pass its certificate: {figures}, allowed "
        f"{certificate.tolerance:.0e}"
    )


def _saddle(matrix: Array, gap: Array, load: float, closed: Mask) -> tuple[Array, float]:
    """Forces (N,) and approach with the closed points in touch, whatever the signs."""
    inner = matrix if closed.all() else matrix[closed][:, closed]
    count = len(inner)
    # The compliance's size keeps the bordered matrix well scaled.
    unit = float(inner.max(initial=0.0)) or 1.0
    system = np.zeros((count + 1, count + 1))
    system[:count, :count] = inner / unit
    system[count, :count] = 1.0
    system[:count, count] = -1.0
    right = np.append(-gap[closed] / unit, load)
    solved = np.linalg.solve(system, right)
    force = np.zeros(len(gap))
    force[closed] = solved[:count]
    return force, float(solved[count]) * unit


def exchange(matrix: Array, gap: Array, load: float, closed: Mask) -> Array | None:
    """Solve the linear contact by exchanging closed points.

    Parameters
    ----------
    matrix : array (N, N)
        F [m/N]; it need not be symmetric.
    gap : array (N,)
        w [m].
    load : float
        P [N].
    closed : array (N,) of bool
        Where to begin.

    Returns
    -------
    array (N,) or None
        Forces [N]; None if the exchange comes back to a set.
    """
    seen = set()
    for _ in range(EXCHANGES):
        if not closed.any() or closed.tobytes() in seen:
            return None
        seen.add(closed.tobytes())
        force, approach = _saddle(matrix, gap, load, closed)
        yielded = matrix @ force
        distance = yielded + gap - approach
        pulled = force < -BAND * load
        pressed = ~closed & (distance < -BAND * float(np.abs(yielded).max()))
        if not pulled.any() and not pressed.any():
            return np.maximum(force, 0.0)
        closed = (closed & ~pulled) | pressed
    return None


def contact_rows(matrix: Array, gap: Array, load: float) -> tuple[Programme, Array]:
    """Write the linear contact as a programme of the package, dimensionless.

    Parameters
    ----------
    matrix : array (N, N)
        F [m/N], symmetric.
    gap : array (N,)
        w [m].
    load : float
        P [N].

    Returns
    -------
    Programme
        In units of the load and of the load times the mean of F's diagonal.
    array (N,)
        What a row's multiplier is to be multiplied by to give the point's force [N].
    """
    count = len(gap)
    size = float(np.trace(matrix)) / count
    values, vectors = np.linalg.eigh(matrix / size)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    rows = np.hstack([np.ones((count, 1)), -root])
    norm = np.linalg.norm(rows, axis=1)
    stiffness = np.eye(count + 1)
    stiffness[0, 0] = 0.0
    programme = Programme(
        coordinates=("approach", *(f"mode {k}" for k in range(count))),
        stiffness=stiffness,
        load=np.eye(count + 1)[0],
        names=tuple(f"point {k}" for k in range(count)),
        rows=rows / norm[:, None],
        gaps=gap / (size * load) / norm,
        linear=np.zeros(count),
        hertz=np.zeros(count),
        assumed_closed=np.zeros(count, dtype=bool),
        cones=(),
    )
    return programme, load / norm


def by_interface(matrix: Array, gap: Array, load: float, force: Array, solver: Backend) -> Array:
    """Solve the linear contact by the package's solver interface.

    Reading at a point what a strip of another width does leaves a small skew part in the matrix;
    it acts on the last forces, beside the gap.

    Parameters
    ----------
    matrix, gap, load
        As for :func:`exchange`.
    force : array (N,)
        The last forces [N].
    solver : Backend

    Returns
    -------
    array (N,)
        Forces [N].

    Raises
    ------
    Refused
        If the solver finds no answer.
    """
    even = 0.5 * (matrix + matrix.T)
    programme, unit = contact_rows(even, gap + (matrix - even) @ force, load)
    try:
        answer = solve_programme(programme, solver, None, polish=True)
    except Unsolved as failure:
        raise Refused(
            f"the contact programme under {load:.6g} N was not solved: {failure}"
        ) from failure
    return np.maximum(answer.point.forces * unit, 0.0)
