r"""Whether an answer is the only one: arcs and friction that follows the torque against stiffness.

All elements but two are convex: with the convex ones alone, an equilibrium is a global minimum and
its forces are unique. A drum's **arc** keeps centres apart, and the set outside it is not convex: a
centre that rolls sideways under a reaction F lowers the energy by F Δ_t²/2|d|, a negative stiffness
F/|d| across the arc. **Friction that follows the torque** feeds back from flanks to the spline.
Where neither carries, the answer is the global minimum of the convex rest, and no other place has
less energy.

Elsewhere the second-order condition decides. Let K be the stiffness of the elements that carry,
projected on the moves that rigid contacts leave, and M what reduces it (F/|d| of every arc; for
friction, the symmetric part with its sign changed). The largest κ of M z = κ K z is the
*curvature*, as a part of the stiffness. For κ < 1 the answer is a strict minimum among its
neighbours. Moreover, flanks enter K by the least slope to any other compression, F/δ, so that for
two equilibria in which the same contacts carry and splines are in the same stage, with arc forces F
and F', convexity of the rest gives, to second order in their distance Δ,

.. math:: \Delta^T K \Delta \le \sum \tfrac12 (F + F') \Delta_t^2 / |d| ,

so F' must be some (2/κ − 1) times F: another answer of that kind would need reactions so many times
as large. Contacts that touch without force count as open, which is on the safe side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from loadshare.array_types import Array
from loadshare.certify.bound.columns import Columns
from loadshare.certify.state import ClaimedState, size
from loadshare.settings import CERTIFY
from loadshare.train.elements import Spline
from loadshare.train.train import Train

MEANINGS = {
    "convex": "only answer: the problem is convex",
    "least energy": "only answer of least energy: no non-convex element carries load",
    "local": "locally unique",
    "not proved": "not proved to be the only answer",
}
"""What the kinds of a verdict mean."""


@dataclass(frozen=True, slots=True)
class Uniqueness:
    """Whether an answer is proved to be the only one.

    Attributes
    ----------
    kind : str
        A key of `MEANINGS`.
    curvature : float or None
        κ, the part of the stiffness that arcs and friction take; None where nothing holds a move
        that they drive.
    where : str
        Elements that are not convex and carry; empty if there are none.
    """

    kind: str
    curvature: float | None
    where: str

    @property
    def text(self) -> str:
        """The verdict as a sentence without its full stop."""
        if self.kind in ("convex", "least energy"):
            return MEANINGS[self.kind]
        size = (
            "curvature without bound"
            if self.curvature is None
            else (f"curvature {self.curvature:.2g} of the stiffness")
        )
        return f"{MEANINGS[self.kind]}: {size} ({self.where})"


def uniqueness(train: Train, columns: Columns, state: ClaimedState, row: int) -> Uniqueness:
    """Judge whether an equilibrium is the only one.

    Parameters
    ----------
    train : Train
    columns : Columns
        The columns of a train of the same shape.
    state : ClaimedState
        State of certified claims.
    row : int
        Its number among them.
    """
    if not train.drums and not any(map(_follows, train.splines.values())):
        return Uniqueness("convex", 0.0, "")
    system = _System(train, columns, state, row)
    if not system.bent:
        return Uniqueness("least energy", 0.0, "")
    curvature = system.curvature()
    where = ", ".join(system.bent)
    if math.isinf(curvature):
        return Uniqueness("not proved", None, where)
    return Uniqueness("local" if curvature < 1.0 else "not proved", curvature, where)


def _follows(spline: Spline) -> bool:
    """Return whether a spline's friction bound follows the torque."""
    return spline.friction_force is None and spline.friction_per_torque > 0.0


class _System:
    """Stiffness K, its reduction M, and the rows of rigid contacts, at an answer.

    Coordinates and rows are those of the bound's `Columns`.
    """

    def __init__(self, train: Train, columns: Columns, state: ClaimedState, row: int) -> None:
        self.train, self.columns, self.state, self.row = train, columns, state, row
        self.rows = columns.matrix.high
        count = len(columns.coordinates)
        self.load = CERTIFY.carries * float(state.load[row])
        self.near = CERTIFY.carries * float(state.deflection[row])
        self.stiffness = np.zeros((count, count))
        self.taken = np.zeros((count, count))
        self.held: list[tuple[float, Array]] = []
        self.splines = list(train.splines.values())
        self.first_spline = columns.claims.splines.start
        self.radius = state.radius[:, row] if state.of.pulls else np.zeros(0)

    @cached_property
    def bent(self) -> tuple[str, ...]:
        """Elements that are not convex and carry."""
        of = self.state.of
        carrying = np.argwhere(self.state.ring_force[:, :2, self.row] > self.load).tolist()
        arcs = [of.contacts[len(of.flanks) + 4 * d + k] for d, k in carrying]
        return (*arcs, *(s.name for k, s in enumerate(self.splines) if self._follows(k)))

    def _assemble(self) -> None:
        """Assemble K and M, and the rows of rigid contacts."""
        self._flanks()
        self._drums()
        self._springs()
        remembering = self.train.slip is not None
        for q in range(self.first_spline if remembering else len(self.radius)):
            self._pull(q)
        for k, spline in enumerate(self.splines if remembering else ()):
            self._remembering(k, spline)
        held = np.array([stiffness for stiffness, _ in self.held])
        rows = np.array([row for _, row in self.held]).reshape(len(held), self.rows.shape[1])
        elastic = np.isfinite(held)
        self.rigid = rows[~elastic]
        self.stiffness += rows[elastic].T @ (held[elastic, None] * rows[elastic])

    def _hold(self, row: Array, stiffness: float) -> None:
        self.held.append((stiffness, row))

    def _own(self, figures: Array) -> Array:
        """Return the figures (…, S or 1) of this answer."""
        return np.asarray(figures[..., self.row % figures.shape[-1]])

    def _pulled(self, q: int) -> float:
        """Return the size of the force of a radial element [N]."""
        return float(size(self.state.reaction[q], axis=0)[self.row])

    def _pair(self, first: int) -> Array:
        """Return the rows of both components of an element's vector."""
        return self.rows[first : first + 2]

    def _slope(self, contact: int) -> float:
        """Return the least slope [N/m] to any other compression; infinite for a rigid contact."""
        force, compression = (
            v[contact, self.row] for v in (self.state.force, self.state.compression)
        )
        return float(force / compression) if compression > 0.0 else math.inf

    def _flanks(self) -> None:
        state, of = self.state, self.state.of
        flanks = np.flatnonzero(state.claim.flank_force[:, self.row] > self.load)
        slopes = np.array([self._slope(e) for e in flanks.tolist()])
        for k, e in enumerate(flanks.tolist() if of.tabled else ()):
            if e in of.tabled:
                forces, compressions = np.diff(self._own(state.here.table[e]))
                slopes[k] = float(np.nanmin(forces / compressions))
        self.held += zip(slopes.tolist(), self.rows[flanks], strict=True)
        elastic = np.isfinite(slopes)
        slopes, some = slopes[elastic], flanks[elastic]
        self.torque_slope = self.columns.moments[:, some] @ (slopes[:, None] * self.rows[some])

    def _drums(self) -> None:
        state, train = self.state, self.train
        for d, ring in enumerate(train.drums):
            frame, first = train.gears[ring.gear].frame, len(state.of.flanks) + 4 * d
            for k in np.flatnonzero(state.ring_force[d, :, self.row] > self.load).tolist():
                slope = self._slope(first + k)
                if k >= 2:
                    self._hold(self.rows[self.columns.stops.start + 2 * d + k - 2], slope)
                    continue
                pair = self._pair(self.columns.arcs.start + 2 * (2 * d + k))
                way = state.way[d, k, :, self.row]
                distance = float(np.linalg.norm(way))
                along, across = _along_and_across(frame @ way / distance)
                self._hold(along @ pair, slope)
                row = across @ pair
                self.taken += state.ring_force[d, k, self.row] / distance * np.outer(row, row)

    def _springs(self) -> None:
        state, columns = self.state, self.columns
        torsion = self._own(state.here.torsion)[columns.elastic_shafts] / columns.shaft_arms**2
        held = self._own(state.here.support)[columns.moving].ravel()
        for some, stiffness in ((columns.shafts, torsion), (columns.bearings, held)):
            rows = self.rows[some]
            self.stiffness += rows.T @ (stiffness[:, None] * rows)

    def _follows(self, k: int) -> bool:
        """Return whether the force of a spline follows the torque at its present offset."""
        q = self.first_spline + k
        if not _follows(self.splines[k]) or self.radius[q] <= self.near:
            return False
        return self.train.slip is not None or self._piece(q)[0] != "stick"

    def _piece(self, q: int) -> tuple[str, float]:
        """Return the piece of its graph on which a radial element is, and its slope [N/m]."""
        first, stick, bound, reach, last = (
            float(figure[q, self.row]) for figure in self.state.graph
        )
        radius, force = self.radius[q], self._pulled(q)
        rigid = math.isinf(last) and math.isfinite(reach)
        if rigid and radius >= reach - self.near and force > bound + self.load:
            return "stop", math.inf
        pieces = [
            ("stick", stick > 0.0, 0.0, 0.0, first),
            ("slip", reach > stick, stick, bound, 0.0),
            ("stop", math.isfinite(stick) and math.isfinite(last), reach, bound, last),
        ]
        there = [piece for piece in pieces if piece[1]]
        reached = [p for p in there if radius >= p[2] - self.near and force >= p[3] - self.load]
        name, *_, slope = [*there[:1], *reached][-1] if there else ("slip", 0.0)
        return name, slope

    def _pull(self, q: int) -> None:
        """Add a radial element: the slope of its piece along it, force over radius across it."""
        state = self.state
        pair, radius, held = self.rows[self.columns.both(q)], self.radius[q], self._piece(q)[1]
        if radius <= self.near:
            for row in pair:
                self._hold(row, held)
            return
        gear = self.train.gears[state.of.gears[state.of.pulled[q]]]
        outward, beside = _along_and_across(gear.frame @ state.offset[q, :, self.row] / radius)
        along = outward @ pair
        self._hold(along, held)
        self._hold(beside @ pair, self._pulled(q) / radius)
        k = q - self.first_spline
        if k < 0 or not self._follows(k):
            return
        per_torque = self.splines[k].friction_per_torque
        follow = math.copysign(per_torque, state.transmitted[k, self.row]) * self.torque_slope[k]
        coupling = np.outer(along, follow)
        self.taken -= 0.5 * (coupling + coupling.T)

    def _remembering(self, k: int, spline: Spline) -> None:
        """Add a spline with memory: its shaft holds it unless the slip has changed."""
        q = self.first_spline + k
        if self.radius[q] <= self.near:
            for row in self.rows[self.columns.both(q)]:
                self._hold(row, math.inf)
            for row in self._pair(self.columns.bends.start + 2 * k):
                self._hold(row, spline.bending_stiffness)

    def curvature(self) -> float:
        """Return the largest κ of M z = κ K z on moves that rigid contacts leave, at least 0."""
        if self.train.slip is not None and any(map(self._follows, range(len(self.splines)))):
            return math.inf
        self._assemble()
        free = np.eye(len(self.stiffness))
        if len(self.rigid):
            lengths = np.sqrt((self.rigid**2).sum(axis=1, keepdims=True))
            _, sizes, basis = np.linalg.svd(self.rigid / np.where(lengths > 0.0, lengths, 1.0))
            free = basis[int((sizes > CERTIFY.rank).sum()) :].T
        stiffness, taken = (free.T @ m @ free for m in (self.stiffness, self.taken))
        values, vectors = np.linalg.eigh(stiffness)
        held = values > CERTIFY.flat * max(float(values.max(initial=0.0)), 0.0)
        loose = vectors[:, ~held]
        most = float(np.abs(self.taken).max())
        if loose.size and float(np.abs(taken @ loose).max(initial=0.0)) > CERTIFY.rank * most:
            return math.inf
        root = vectors[:, held] / np.sqrt(values[held])
        largest = float(np.linalg.eigvalsh(root.T @ taken @ root).max(initial=0.0))
        return largest if largest > CERTIFY.nothing else 0.0


def _along_and_across(along: Array) -> tuple[Array, Array]:
    """Return a unit vector of a plane, and the one across it."""
    return along, np.array([-along[1], along[0]])
