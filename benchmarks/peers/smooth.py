"""The smooth energy of displacements, with rigid limits as constraints, for general minimisers.

    E(x) = ½xᵀHx − fᵀx + Σ U(a·x − g) + Σ W(|Px − m|)

U and its derivative F(δ) have closed forms, so no outer loop is needed; rigid rows, arcs and round
rings are constraints.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim, NotForThis, faces, force_of
from loadshare.contact.radial import RadialLaw


class Smooth:
    """Energy, gradient and constraints of a form."""

    def __init__(self, form: Form) -> None:
        if any(g.follows for g in form.graphs):
            raise NotForThis("friction that follows the torque has no energy")
        self.form = form
        self.laws: Sequence[RadialLaw] = form.laws(np.ones(len(form.gaps)))
        self.yields = (form.linear > 0.0) | (form.hertz > 0.0)
        self.rigid = np.flatnonzero(~self.yields)
        self.discs = [j for j, law in enumerate(self.laws) if np.isfinite(law.reach)]

    def forces(self, x: Array) -> Array:
        """Return the forces of all rows that yield."""
        form = self.form
        rows, gaps = faces(form, x)
        found = force_of(form.linear, form.hertz, rows @ x - gaps)
        return np.asarray(np.where(self.yields, found, 0.0))

    def energy(self, x: Array) -> float:
        """Return E(x)."""
        form = self.form
        f = self.forces(x)
        total = 0.5 * x @ form.stiffness @ x - form.load @ x
        total += float(np.sum(0.5 * form.linear * f**2 + 0.4 * form.hertz * np.cbrt(f) ** 5))
        for graph, law in zip(form.graphs, self.laws, strict=True):
            radius = float(np.linalg.norm(graph.matrix @ x - graph.centre))
            total += law.energy(min(radius, law.reach))
        return float(total)

    def gradient(self, x: Array) -> Array:
        """Return ∇E(x)."""
        form = self.form
        rows, _ = faces(form, x)
        slope = form.stiffness @ x - form.load + rows.T @ self.forces(x)
        for graph, pull in zip(form.graphs, self.pulls(x), strict=True):
            slope = slope + graph.matrix.T @ pull
        return np.asarray(slope)

    def pulls(self, x: Array) -> list[Array]:
        """Return the force of every graph, at a vertical piece its lower end."""
        found = []
        for graph, law in zip(self.form.graphs, self.laws, strict=True):
            q = graph.matrix @ x - graph.centre
            radius = float(np.linalg.norm(q))
            at = min(radius, law.reach)
            on = (p for p in law.parts() if p.begin <= at <= p.end)
            low = min(p.low + p.slope * (at - p.begin) for p in on)
            found.append(q / radius * low if radius > 0.0 else np.zeros(2))
        return found

    def room(self, x: Array) -> Array:
        """Return the slack of the constraints: ≥ 0 if they hold."""
        rows, gaps = faces(self.form, x)
        free = gaps[self.rigid] - rows[self.rigid] @ x
        offsets = [self.form.graphs[j].matrix @ x - self.form.graphs[j].centre for j in self.discs]
        reach = [self.laws[j].reach for j in self.discs]
        discs = [r * r - q @ q for r, q in zip(reach, offsets, strict=True)]
        return np.concatenate([free, np.array(discs)])

    def room_slope(self, x: Array) -> Array:
        """Return the Jacobian of `room`."""
        rows, _ = faces(self.form, x)
        discs = [
            -2.0 * (g.matrix @ x - g.centre) @ g.matrix
            for g in (self.form.graphs[j] for j in self.discs)
        ]
        return np.vstack([-rows[self.rigid], *discs]) if len(self.rigid) + len(discs) else rows[:0]

    @property
    def constrained(self) -> bool:
        """Whether there are any rigid limits."""
        return bool(len(self.rigid) or self.discs)

    def claim(self, x: Array) -> Claim:
        """Return the answer at x; forces of rigid limits are fitted to the unbalanced forces."""
        from scipy.optimize import nnls

        forces, pulls = self.forces(x), self.pulls(x)
        if self.constrained:
            slope = self.room_slope(x)
            near = np.abs(self.room(x)) < 1e-5
            pushes = np.zeros(len(near))
            if near.any():
                pushes[near], _ = nnls(slope[near].T, self.gradient(x))
            forces[self.rigid] = pushes[: len(self.rigid)]
            for j, push in zip(self.discs, pushes[len(self.rigid) :], strict=True):
                graph = self.form.graphs[j]
                pulls[j] = pulls[j] + 2.0 * push * (graph.matrix @ x - graph.centre)
        return Claim(x, forces, pulls)
