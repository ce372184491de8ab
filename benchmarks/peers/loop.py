"""The outer loop that peers share: it repeats until laws, ring faces and friction bounds agree.

Newton replaces every law by its tangent at the force of the last compression, Picard by its secant
at the last force. It is the plain loop, without step control.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from benchmarks.peers.form import Array, Form
from loadshare.contact.radial import RadialLaw

PASSES = 60
SMALL, OPEN = 1e-18, 1e-6
"""Smallest forces, over the load, at which laws of all rows and of open rows are linearised."""


class Failure(RuntimeError):  # noqa: N818 -- what a peer says of itself
    """A peer gives no answer; the message is its own."""


class NotForThis(Failure):
    """A peer does not solve problems of this class."""


@dataclass(frozen=True, slots=True, eq=False)
class Claim:
    """The answer that a peer claims.

    Attributes
    ----------
    x : ndarray, shape (n,)
    forces : ndarray, shape (m,)
    pulls : sequence of ndarray, shape (2,)
    passes : int
        Passes of the outer loop.
    """

    x: Array
    forces: Array
    pulls: Sequence[Array]
    passes: int = 1


class Inner(Protocol):
    """Solver of the programme of one pass: min ½xᵀHx − fᵀx + Σ ½ b F² + Σ W, rows ≤ gaps."""

    def __call__(
        self, form: Form, rows: Array, gaps: Array, compliance: Array, laws: Sequence[RadialLaw]
    ) -> Claim:
        """Solve one pass.

        Raises
        ------
        Failure
            If the solver says that it has no answer.
        """


def settle(form: Form, inner: Inner, stop: float, method: str = "newton") -> Claim:
    """Call an inner solver until laws, faces and friction bounds agree.

    Parameters
    ----------
    form : Form
    inner : Inner
    stop : float
        Largest misfit allowed, in deflections and loads.
    method : {"newton", "picard", "exact"}
        Tangents, secants, or laws that the inner solver takes as they are.

    Raises
    ------
    Failure
        If the loop does not converge, or the inner solver fails.
    """
    forces = np.ones(len(form.gaps))
    x = np.zeros(form.size)
    best = np.inf
    for number in range(1, PASSES + 1):
        rows, gaps = faces(form, x, wide=number == 1)
        compliance, offset = linearised(form, forces, method)
        laws = form.laws(forces)
        claim = inner(form, rows, gaps + offset, compliance, laws)
        claim = Claim(claim.x, claim.forces, claim.pulls, number)
        if not form.curved:
            return claim
        misfit = misfit_of(form, claim, method == "exact", rows, gaps, laws)
        if misfit <= stop or (misfit <= 1e3 * stop and misfit >= 0.5 * best):
            return claim
        best = min(best, misfit)
        forces = next_forces(form, claim, forces, method)
        x = claim.x
    raise Failure(f"no end after {PASSES} passes (misfit {misfit:.1e})")


def faces(form: Form, x: Array, wide: bool = False) -> tuple[Array, Array]:
    """Return rows and gaps with the arcs replaced by their faces at x.

    Wide faces are moved outwards by the sagitta: the faces at rest could wedge a float where the
    arcs let it pass.
    """
    if not len(form.arcs.rows):
        return form.rows, form.gaps
    vectors, bounds = form.arcs.faces(x)
    rows, gaps = form.rows.copy(), form.gaps.copy()
    bounds = bounds + form.arcs.sagitta if wide else bounds
    norms = np.sqrt(np.einsum("kn,kn->k", vectors, vectors))
    rows[form.arcs.rows], gaps[form.arcs.rows] = vectors / norms[:, None], bounds / norms
    return rows, gaps


def linearised(form: Form, forces: Array, method: str) -> tuple[Array, Array]:
    """Return compliance and offset of every row at given forces."""
    if not form.hertz.any() or method == "exact":
        return form.linear, np.zeros(len(forces))
    root = np.cbrt(np.maximum(forces, SMALL))
    if method == "picard":
        return form.linear + form.hertz / root, np.zeros(len(forces))
    return form.linear + 2.0 / 3.0 * form.hertz / root, form.hertz * root**2 / 3.0


def force_of(linear: Array, hertz: Array, compression: Array) -> Array:
    """Return the force of every law at a compression: the root of b y³ + c y² = δ, y = F^(1/3)."""
    delta = np.maximum(compression, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        y = np.fmin(np.sqrt(delta / hertz), np.cbrt(delta / linear))
    y = np.where(np.isfinite(y), y, 0.0)
    if not hertz.any():
        return np.asarray(y**3)
    for _ in range(8):
        slope = 3.0 * linear * y**2 + 2.0 * hertz * y
        step = (linear * y**3 + hertz * y**2 - delta) / np.where(slope > 0.0, slope, 1.0)
        y = y - np.where(slope > 0.0, step, 0.0)
    return np.asarray(np.maximum(y, 0.0) ** 3)


def next_forces(form: Form, claim: Claim, before: Array, method: str) -> Array:
    """Return the forces at which the next pass linearises."""
    if method == "picard" or not form.hertz.any():
        return np.maximum(claim.forces, SMALL)
    approach = form.rows @ claim.x - form.gaps
    found = force_of(form.linear, form.hertz, approach)
    # The tangent of an open row is taken at a moderate force: its compliance at a force near zero
    # would spoil the conditioning of the whole programme.
    return np.maximum(np.where(approach > 0.0, found, np.maximum(0.1 * before, OPEN)), SMALL)


def misfit_of(
    form: Form,
    claim: Claim,
    exact: bool,
    rows: Array,
    gaps: Array,
    laws: Sequence[RadialLaw],
) -> float:
    """Return the largest difference between what a pass assumed and what holds at its answer.

    Parameters
    ----------
    form : Form
    claim : Claim
    exact : bool
        Whether the laws themselves were used instead of tangents or secants.
    rows, gaps : ndarray
        With the faces that replaced the arcs.
    laws : sequence of RadialLaw
    """
    force = np.maximum(claim.forces, 0.0)
    worst = 0.0
    if form.hertz.any() and not exact:
        # The small force that an interior-point method leaves on an open contact does not count;
        # but a compressed contact without force, because of its tangent's offset, violates its law.
        approach = form.rows @ claim.x - form.gaps
        yielded = form.linear * force + form.hertz * np.cbrt(force) ** 2
        curved = (approach > 0.0) & (form.hertz > 0.0)
        worst = float(np.where(curved, np.abs(yielded - approach), 0.0).max())
    if len(form.arcs.rows):
        new_rows, new_gaps = faces(form, claim.x)
        k = form.arcs.rows
        slack = np.abs((new_rows[k] - rows[k]) @ claim.x - (new_gaps[k] - gaps[k]))
        turned = np.abs(new_rows[k] - rows[k]).max(axis=1) * force[k]
        closed = (force[k] > 0.0) | (new_rows[k] @ claim.x - new_gaps[k] > 0.0)
        worst = max(worst, float(np.where(closed, np.maximum(slack, turned), 0.0).max()))
    if any(g.follows for g in form.graphs):
        worst = max([worst, *map(_apart, laws, form.laws(claim.forces))])
    return worst


def _apart(one: RadialLaw, other: RadialLaw) -> float:
    """Return the difference of two laws' friction bounds; infinite if their pieces differ."""
    if len(one.pieces) != len(other.pieces):
        return np.inf
    return abs(one.pieces[-1].force - other.pieces[-1].force)
