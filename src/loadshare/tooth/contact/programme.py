r"""The contact programme: quadratic programmes that follow the contact law.

With the strips' widths held, or the law replaced by its tangent, the problem of
:mod:`loadshare.tooth.contact.problem` is the quadratic programme

.. math:: \min_{p\ge 0}\ \tfrac12 p^\mathsf{T} F p + w^\mathsf{T} p
    \quad\text{s.t.}\quad \textstyle\sum p = P \qquad : Z

It is solved exactly, by exchange of closed points or, if an exchange returns to an earlier set, by
the package's solver interface: with :math:`F = L L^\mathsf{T}` its dual has the interface's form,

.. math:: \min_{Z, y}\ \tfrac12\lVert y\rVert^2 - P Z
    \quad\text{s.t.}\quad Z - (L y)_i \le w_i \qquad : p_i

Without forces to begin from, the first programme holds the widths; the others are semismooth Newton
steps on the law with its closed points, which converge quadratically. After a step no shorter than
the last, widths are held once more. The result is in contact to round-off, and certified.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from loadshare.contact.backends.backend import Backend, backend
from loadshare.contact.findings import Unsolved
from loadshare.contact.inner import solve_programme
from loadshare.contact.programme import Programme
from loadshare.errors import Refused
from loadshare.settings import TEETH
from loadshare.tooth.contact.certificate import ContactCertificate, certify_contacts
from loadshare.tooth.contact.problem import ContactBatch, Strips, ToothContact
from loadshare.tooth.geometry.body import Array

Mask = NDArray[np.bool_]


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
    problem: ToothContact,
    load: float,
    warm: Array | None = None,
    solver: str = "clarabel",
) -> Contact:
    """Solve one contact under a load P [N] from `warm` (N,) [N]; see :func:`solve_contacts`."""
    start = None if warm is None else warm[None]
    return solve_contacts(problem.alone, np.array([load]), start, solver)[0]


def solve_contacts(
    batch: ContactBatch,
    load: Array,
    warm: Array | None = None,
    solver: str = "clarabel",
) -> tuple[Contact, ...]:
    """Solve several independent contacts at once.

    Parameters
    ----------
    batch : ContactBatch
    load : array (K,)
        P [N] of each, positive.
    warm : array (K, N), optional
        Forces under another load, to begin from.
    solver : str
        Back-end for programmes that the exchange does not solve.

    Raises
    ------
    ValueError
        If the load is not positive.
    Refused
        If one of the contacts is not found, or does not pass its certificate.
    """
    load = np.array(load, float)
    wrong = load[~((load > 0.0) & np.isfinite(load))]
    if len(wrong):
        raise ValueError(
            f"load = {wrong[0]}: a load must press the flanks together; allowed: above 0 N"
        )
    points = batch.gap.shape[1]
    if warm is None:
        force = np.repeat(load[:, None] / points, points, axis=1)
    else:
        force = warm * (load / np.sum(warm, axis=1))[:, None]
    found = _Found.initial(force, warm is not None)
    of = _Batch(batch.which, load, batch.gap, batch.fixed)
    linear = _Linear(np.empty((points, points)), np.empty(points), np.empty(points))
    circling = -1
    while (circling := _settle(batch.strips, of, found, linear, circling)) >= 0:
        try:
            last = float(load[circling]), force[circling]
            linear.force[:] = by_interface(linear.matrix, linear.gap, *last, backend(solver))
        except Refused as refusal:
            message = _called(batch.names[circling]) + str(refusal)
            raise Refused(message, refusal.figures) from refusal
    for k in np.flatnonzero(~found.settled)[:1]:
        raise Refused(
            f"{_called(batch.names[k])}the contact under {load[k]:.6g} N did not converge in "
            f"{TEETH.passes} passes; more points per line, or a smoother gap, may help",
        )
    return _certified(batch, load, found)


def _settle(strips: Strips, of: _Batch, found: _Found, linear: _Linear, answered: int) -> int:
    """Return the number of the next contact whose exchange goes in circles, −1 if there is none."""
    from loadshare.tooth.contact.compiled import settle

    try:
        # The limits are arguments, because compiled code would keep an old value of a global.
        return int(settle(strips, of, found, linear, TEETH, answered))
    except np.linalg.LinAlgError as error:
        raise Refused(
            "the compliance of a contact is singular or not a number; gap, lengths, curvatures and "
            "elasticity of the teeth must be finite"
        ) from error


class _Batch(NamedTuple):
    """Contacts to be settled, in the form that compiled code reads."""

    which: NDArray[np.int64]  # (K,)
    load: Array  # (K,)
    gap: Array  # (K, N)
    fixed: Array  # (M, N, N)


class _Found(NamedTuple):
    """Iterates of the contacts, and whether they have settled."""

    force: Array  # (K, N)
    approach: Array  # (K,)
    distance: Array  # (K, N)
    slope: Array  # (K,): dZ/dP
    step: Array  # (K,): largest change of a force in the last pass
    passes: NDArray[np.int64]  # (K,)
    newton: Mask  # (K,): whether the next pass uses the tangent
    settled: Mask  # (K,)

    @classmethod
    def initial(cls, force: Array, newton: bool) -> _Found:
        count = len(force)
        approach, slope = np.zeros((2, count))
        step, passes = np.full(count, np.inf), np.zeros(count, dtype=np.int64)
        newtons, settled = np.full(count, newton), np.zeros(count, dtype=bool)
        return cls(force, approach, np.zeros_like(force), slope, step, passes, newtons, settled)


class _Linear(NamedTuple):
    """A contact with its law made linear, and its forces."""

    matrix: Array  # (N, N)
    gap: Array  # (N,)
    force: Array  # (N,)


def _certified(batch: ContactBatch, load: Array, found: _Found) -> tuple[Contact, ...]:
    certificates = certify_contacts(batch, load, found.force, found.approach)
    for name, part, certificate in zip(batch.names, load, certificates, strict=True):
        if not certificate.passed:
            figures = ", ".join(f"{n} {v:.1e}" for n, v in certificate.failing.items())
            raise Refused(
                f"{_called(name)}the contact under {part:.6g} N does not pass its certificate: "
                f"{figures}, allowed {certificate.tolerance:.0e}",
                certificate.failing,
            )
    distance = np.where(found.force > 0.0, 0.0, found.distance)
    columns = (
        found.force,
        found.approach.tolist(),
        distance,
        found.slope.tolist(),
        found.passes.tolist(),
        certificates,
    )
    return tuple(map(Contact, *columns))


def _called(name: str) -> str:
    return f"{name}: " if name else ""


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
        Points to begin with.

    Returns
    -------
    array (N,) or None
        Forces [N]; None if the exchange returns to an earlier set.
    """
    from loadshare.tooth.contact.compiled import exchange as exchanged

    force, compliance = np.empty(len(gap)), np.ascontiguousarray(matrix, float)
    found = exchanged(compliance, gap, float(load), closed.copy(), TEETH, force)
    return force if found else None


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
        Factors from the rows' multipliers to the points' forces [N].
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

    Because a strip's displacement is read at points of strips of other widths, the matrix has a
    small skew part; its product with the last forces is added to the gap.

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
