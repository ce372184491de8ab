"""The method of the literature: displacement iteration with trial states of contacts and splines.

States are assumed (open or closed; stick, slip or stop), the linear equations of the displacements
are solved with secant stiffnesses, all states are read off the result, and so on until nothing
changes or a limit of trials is reached. There is no guard against cycles: this is how it is done. A
rigid limit gets the stiffness `STIFF`, as the usual penalty.
"""

from __future__ import annotations

import numpy as np

from benchmarks.peers.form import Array, Form
from benchmarks.peers.loop import Claim, Failure, faces
from loadshare.contact.radial import RadialLaw

STIFF = 1e6
"""Penalty stiffness of rigid limits, over that of a flank."""
PATIENCE = 200


class TrialStates:
    """Displacement iteration; the tolerance applies to the last change of the displacements."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance

    def prepare(self, form: Form) -> None:
        """Do nothing: nothing is kept."""

    def solve(self, form: Form) -> Claim:
        """See `Peer`."""
        closed = form.driven.copy()
        forces = np.where(closed, 1.0, 0.0)
        pulls = [np.zeros(2) for _ in form.graphs]
        places = ["stick"] * len(form.graphs)
        x: Array = np.zeros(form.size)
        for number in range(1, PATIENCE + 1):
            rows, gaps = faces(form, x)
            laws = form.laws(forces)
            matrix, right = form.stiffness.copy(), form.load.copy()
            stiffness = _secants(form, forces)
            push = rows[closed].T * stiffness[closed]
            matrix += push @ rows[closed]
            right += push @ gaps[closed]
            for graph, law, place, pull in zip(form.graphs, laws, places, pulls, strict=True):
                k, centre, force = _spring(law, place, pull)
                matrix += k * graph.matrix.T @ graph.matrix
                right += graph.matrix.T @ (k * (graph.centre + centre) - force)
            try:
                # Least squares, because a float that nothing touches makes the trial system
                # singular.
                after = np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-13)[0])
            except np.linalg.LinAlgError as error:
                raise Failure("trial states: the trial system has no solution") from error
            approach = rows @ after - gaps
            now = approach > 0.0
            forces = np.where(now, stiffness * np.maximum(approach, 0.0), 0.0)
            offsets = [g.matrix @ after - g.centre for g in form.graphs]
            stands = [_place(law, q) for law, q in zip(laws, offsets, strict=True)]
            pulls = [_pull(law, p, q) for law, p, q in zip(laws, stands, offsets, strict=True)]
            change = float(np.abs(after - x).max(initial=0.0))
            settled = change <= self.tolerance * max(1.0, float(np.abs(after).max(initial=0.0)))
            same = bool((now == closed).all()) and stands == places
            x, closed, places = after, now, stands
            if same and settled:
                return Claim(x, forces, pulls, number)
        raise Failure(f"trial states: no consistent states after {PATIENCE} trials")


def _secants(form: Form, forces: Array) -> Array:
    """Return the secant stiffness of every row; the penalty if it is rigid."""
    force = np.where(forces > 0.0, forces, 1.0)
    compliance = form.linear + form.hertz / np.cbrt(force)
    return np.asarray(1.0 / np.maximum(compliance, 1.0 / STIFF))


def _spring(law: RadialLaw, place: str, pull: Array) -> tuple[float, Array, Array]:
    """Return the stiffness, its centre and the constant force of a piece of a graph."""
    size = float(np.linalg.norm(pull))
    along = pull / size if size > 0.0 else np.zeros(2)
    for k, piece in enumerate(law.pieces):
        if piece.name == place:
            start = law.start(k) if k else 0.0
            return piece.stiffness, start * along, piece.force * along
    return STIFF, law.reach * along, np.zeros(2)


def _place(law: RadialLaw, offset: Array) -> str:
    """Return the piece in which a radius lies; "wall" beyond a rigid end."""
    radius = float(np.linalg.norm(offset))
    for k, piece in enumerate(law.pieces):
        if radius <= law.start(k + 1):
            return piece.name
    return "wall"


def _pull(law: RadialLaw, place: str, offset: Array) -> Array:
    """Return the force of a graph at an offset."""
    radius = float(np.linalg.norm(offset))
    if radius == 0.0:
        return np.zeros(2)
    if place == "wall":
        return np.asarray(offset / radius * STIFF * (radius - law.reach))
    k = [p.name for p in law.pieces].index(place)
    piece = law.pieces[k]
    return np.asarray(offset / radius * (piece.force + piece.stiffness * (radius - law.start(k))))


def make(tolerance: float) -> TrialStates:
    """Return the displacement iteration."""
    return TrialStates(tolerance)
