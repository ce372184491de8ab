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
from loadshare.tooth.contact_certificate import ContactCertificate, certify_contacts
from loadshare.tooth.contact_problem import ContactBatch, ContactProblem, times

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
    """Solve one contact under a load P [N] from `warm` (N,) [N]; see :func:`solve_contacts`."""
    begun = None if warm is None else warm[None]
    return solve_contacts(problem.alone, np.array([load]), begun, solver)[0]


def solve_contacts(
    batch: ContactBatch,
    load: Array,
    warm: Array | None = None,
    solver: str = "clarabel",
) -> tuple[Contact, ...]:
    """Solve several contacts at once, each for itself.

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
        If one of the contacts is not found, or not passed by its certificate.
    """
    wrong = load[~((load > 0.0) & np.isfinite(load))]
    if len(wrong):
        raise ValueError(f"load = {wrong[0]}: the flanks are pressed together; allowed: above 0 N")
    if warm is None:
        real = np.arange(batch.gap.shape[1]) < batch.count[:, None]
        force = np.where(real, (load / batch.count)[:, None], 0.0)
    else:
        force = warm * (load / np.sum(warm, axis=1))[:, None]
    count = len(force)
    found = _Settled.empty(batch)
    going, part, wanted = np.arange(count), batch, load
    newton, last = np.full(count, warm is not None), np.full(count, np.inf)
    for passes in range(PASSES):
        secant, tangent = part.compliance(force)
        yielded = times(secant, force)
        approach = np.sum((yielded + part.gap) * force, axis=1) / wanted
        distance = yielded + part.gap - approach[:, None]
        closed = force > 0.0
        missed = np.max(np.where(closed, np.abs(distance), -distance), axis=1)
        # Light loads yield less than the gaps that they close; those have their own round-off.
        least = ROUND_OFF * np.max(np.where(closed, part.gap, 0.0), axis=1)
        settled = missed < SETTLED * np.abs(yielded).max(axis=1) + least
        if settled.any():
            found.keep(
                going[settled],
                passes,
                *(values[settled] for values in (force, approach, distance, tangent)),
            )
            left = np.flatnonzero(~settled)
            if not len(left):
                return found.contacts(batch, load)
            going, part = going[left], part.rows(left)
            force, yielded, closed = force[left], yielded[left], closed[left]
            newton, last, wanted = newton[left], last[left], wanted[left]
            secant, tangent = secant[left], tangent[left]
        # The law at the last forces by its tangent: a linear contact with a shifted gap.
        shift = np.where(newton[:, None], yielded - times(tangent, force), 0.0)
        matrix = np.where(newton[:, None, None], tangent, secant)
        gap = part.gap + shift
        new, solved = exchanges(matrix, gap, wanted, closed)
        for k in np.flatnonzero(~solved):
            n = part.count[k]
            linear = matrix[k, :n, :n], gap[k, :n], float(wanted[k]), force[k, :n]
            try:
                new[k] = 0.0
                new[k, :n] = by_interface(*linear, backend(solver))
            except Refused as refusal:
                raise Refused(_called(part.names[k]) + str(refusal), refusal.figures) from refusal
        step = np.abs(new - force).max(axis=1)
        # Where Newton's method does not draw in, a pass at fixed widths does.
        newton = ~newton | (step < last)
        force, last = new, step
    raise Refused(
        f"{_called(part.names[0])}the contact under {wanted[0]:.6g} N did not settle in {PASSES} "
        "passes; more points a line, or a smoother gap, may help",
    )


@dataclass(eq=False)
class _Settled:
    """What has settled of a batch; `tangent` is du/dp (K, N, N)."""

    force: Array
    approach: Array
    distance: Array
    tangent: Array
    passes: NDArray[np.int64]

    @classmethod
    def empty(cls, batch: ContactBatch) -> _Settled:
        flat, count = np.zeros_like(batch.gap), len(batch.gap)
        passes = np.zeros(count, dtype=np.int64)
        return cls(flat, np.zeros(count), flat.copy(), np.zeros_like(batch.fixed), passes)

    def keep(
        self, rows: NDArray[np.int64], passes: int, force: Array, approach: Array,
        distance: Array, tangent: Array,
    ) -> None:  # fmt: skip
        self.passes[rows] = passes
        self.force[rows], self.approach[rows] = force, approach
        self.distance[rows], self.tangent[rows] = distance, tangent

    def contacts(self, batch: ContactBatch, load: Array) -> tuple[Contact, ...]:
        """The contacts with their slopes, all certified."""
        certificates = certify_contacts(batch, load, self.force, self.approach)
        closed = self.force > 0.0
        _, slope = _saddles(self.tangent, np.zeros_like(self.force), np.ones_like(load), closed)
        distance = np.where(closed, 0.0, self.distance)
        for name, part, certificate in zip(batch.names, load, certificates, strict=True):
            if not certificate.passed:
                raise Refused(_told(name, float(part), certificate), certificate.failing)
        return tuple(
            Contact(
                self.force[k, :n], float(self.approach[k]), distance[k, :n], float(slope[k]),
                int(self.passes[k]), certificates[k],
            )
            for k, n in enumerate(batch.count)
        )  # fmt: skip


def _called(name: str) -> str:
    return f"{name}: " if name else ""


def _told(name: str, load: float, certificate: ContactCertificate) -> str:
    figures = ", ".join(f"{n} {v:.1e}" for n, v in certificate.failing.items())
    return (
        f"{_called(name)}the contact under {load:.6g} N does not pass its certificate: {figures}, "
        f"allowed {certificate.tolerance:.0e}"
    )


def _saddles(matrix: Array, gap: Array, load: Array, closed: Mask) -> tuple[Array, Array]:
    """Forces (K, N) and approaches (K,) with the closed points in touch, whatever the signs."""
    count = gap.shape[1]
    # The compliance's size keeps the bordered matrix well scaled.
    unit = matrix.max(axis=(1, 2))
    unit = np.where(unit > 0.0, unit, 1.0)[:, None]
    system = np.zeros((len(gap), count + 1, count + 1))
    both = closed[:, :, None] & closed[:, None, :]
    np.divide(matrix, unit[..., None], out=system[:, :count, :count], where=both)
    point = np.arange(count)
    system[:, point, point] += ~closed  # open points carry nothing
    system[:, count, :count] = closed
    system[:, :count, count] = -1.0 * closed
    right = np.empty((len(gap), count + 1, 1))
    right[:, :count, 0] = np.where(closed, -gap / unit, 0.0)
    right[:, count, 0] = load
    solved = np.linalg.solve(system, right)[..., 0]
    return solved[:, :count], solved[:, count] * unit[:, 0]


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
    force, solved = exchanges(matrix[None], gap[None], np.array([load]), closed[None])
    return force[0] if solved[0] else None


def exchanges(matrix: Array, gap: Array, load: Array, closed: Mask) -> tuple[Array, Mask]:
    """Solve K linear contacts (K, N, N) by exchanging closed points; see :func:`exchange`.

    Returns
    -------
    force : array (K, N)
        [N].
    solved : array (K,) of bool
        Where the exchange did not come back to a set.
    """
    force, solved = np.zeros_like(gap), np.zeros(len(gap), dtype=bool)
    seen: set[tuple[int, bytes]] = set()
    closed, going = closed.copy(), list(range(len(gap)))
    for _ in range(EXCHANGES):
        sets = {k: (k, closed[k].tobytes()) for k in going if closed[k].any()}
        going = [k for k, own in sets.items() if own not in seen]
        if not going:
            break
        seen.update(sets.values())
        now, inner = closed[going], matrix if len(going) == len(gap) else matrix[going]
        found, approach = _saddles(inner, gap[going], load[going], now)
        yielded = times(inner, found)
        distance = yielded + gap[going] - approach[:, None]
        pulled = found < -BAND * load[going, None]
        pressed = ~now & (distance < -BAND * np.abs(yielded).max(axis=1, keepdims=True))
        left = (pulled | pressed).any(axis=1)
        force[going] = np.maximum(found, 0.0)
        solved[going] = ~left
        closed[going] = (now & ~pulled) | pressed
        going = [k for k, more in zip(going, left, strict=True) if more]
    return force, solved


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
