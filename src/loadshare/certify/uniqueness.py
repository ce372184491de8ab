r"""Whether an answer is the only one: arcs and friction that follows the torque against stiffness.

All elements but two are convex: with these alone an equilibrium is a global minimum and its forces
are unique. A drum's **arc** keeps centres apart, which is no convex set: a reaction F that rolls
off sideways gains F Δ_t²/2|d|, a negative stiffness F/|d| across it. **Friction that follows the
torque** feeds back from flanks to the spline. Where neither carries, the answer is the global
minimum of the convex rest, which no other place can undercut.

Elsewhere the second-order condition decides. Let K be the stiffness of what carries, projected on
the moves that rigid contacts leave, and M what takes from it (F/|d| of every arc; of friction, the
symmetric part with its sign changed). The largest κ of M z = κ K z is the *curvature*, in parts of
the stiffness. For κ < 1 the answer is a strict minimum among its neighbours. More than that: flanks
enter K by the least slope to any other compression, F/δ, so that for two equilibria in which the
same contacts carry and splines are in the same stage, with arc forces F and F', convexity of what
is left gives, to second order in their distance Δ,

.. math:: \Delta^T K \Delta \le \sum \tfrac12 (F + F') \Delta_t^2 / |d| ,

so F' must exceed F some (2/κ − 1) times: another answer of that kind would need reactions many
times larger. Contacts that touch without force count as open, which is on the safe side.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.state import Pull, Push, State
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.law import Law, TableLaw
from loadshare.train.radial import Piece
from loadshare.train.train import Spline, Train

Array = NDArray[np.float64]

CARRIES = 1e-9
"""Part of the load from which on a contact counts as carrying, and of the deflection within which a
radius counts as at a corner: the band of the certificate."""
RANK = 1e-10
"""Relative size below which a singular value of unit rows is none."""
FLAT = 1e-13
"""Relative stiffness below which a move is held by nothing: round-off of the stiffest element."""
NOTHING = 1e-15
"""Curvature that is none: what round-off leaves where rigid contacts allow no move."""
TOLD = {
    "convex": "only answer: the problem is convex",
    "least energy": "only answer of least energy: nothing that is not convex carries",
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
        A key of `TOLD`.
    curvature : float or None
        κ, what arcs and friction take from the stiffness, in parts of it; None where a move that
        they drive is held by nothing.
    where : str
        Elements that are not convex and carry; empty if there are none.
    """

    kind: str
    curvature: float | None
    where: str

    @property
    def told(self) -> str:
        """The verdict as a sentence without its full stop."""
        if self.kind in ("convex", "least energy"):
            return TOLD[self.kind]
        size = (
            "curvature without bound"
            if self.curvature is None
            else (f"curvature {self.curvature:.2g} of the stiffness")
        )
        return f"{TOLD[self.kind]}: {size} ({self.where})"


def uniqueness(train: Train, answer: Equilibrium) -> Uniqueness:
    """Judge whether an equilibrium is the only one.

    Parameters
    ----------
    train : Train
    answer : Equilibrium
        A certified one.
    """
    following = [s for s in train.splines.values() if _follows(s)]
    if not train.drums and not following:
        return Uniqueness("convex", 0.0, "")
    state = State(train, answer)
    system = _System(state)
    if not system.bent:
        return Uniqueness("least energy", 0.0, "")
    curvature = system.curvature()
    where = ", ".join(system.bent)
    if math.isinf(curvature):
        return Uniqueness("not proved", None, where)
    return Uniqueness("local" if curvature < 1.0 else "not proved", curvature, where)


def _follows(spline: Spline) -> bool:
    """Whether a spline's friction bound follows the torque."""
    return spline.friction_force is None and spline.friction_per_torque > 0.0


class _System:
    """Stiffness K, what takes from it M, and the rows of rigid contacts, at an answer.

    Coordinates are arcs on the base circles [m] and displacements in the gears' frames [m].
    """

    def __init__(self, state: State) -> None:
        self.state = state
        train = state.train
        turning = [g for g in train.gears if g != train.output]
        moving = [g for g in train.gears.values() if g.moves]
        self.turn_at = {g: k for k, g in enumerate(turning)}
        self.move_at = {g.name: len(turning) + 2 * k for k, g in enumerate(moving)}
        self.size = len(turning) + 2 * len(moving)
        self.load = CARRIES * state.force_scale
        self.near = CARRIES * state.length_scale
        self.stiffness = np.zeros((self.size, self.size))
        self.taken = np.zeros((self.size, self.size))
        self.rigid: list[Array] = []
        self.torque_slope = {g: np.zeros(self.size) for g in train.splines}

    @cached_property
    def bent(self) -> tuple[str, ...]:
        """Elements that are not convex and carry."""
        arcs = [p.name for p in self._carrying_ring_contacts() if p.pushing is not None]
        return (*arcs, *(p.name for p in self.state.pulls if self._follows(p)))

    def _assemble(self) -> None:
        self._flanks()
        self._ring_contacts()
        self._springs()
        train = self.state.train
        for pull in self.state.pulls:
            if pull.is_ring or train.slip is None:
                self._pull(pull)
        if train.slip is not None:
            self._remembering()

    def _turned(self, gear: str, per_angle: float) -> Array:
        row = np.zeros(self.size)
        if gear in self.turn_at:
            row[self.turn_at[gear]] = per_angle / self.state.train.gears[gear].base_radius
        return row

    def _moved(self, gear: str, way: Array) -> Array:
        row = np.zeros(self.size)
        if gear in self.move_at:
            at = self.move_at[gear]
            row[at : at + 2] = self.state.train.gears[gear].frame @ way
        return row

    def _hold(self, row: Array, stiffness: float) -> None:
        if math.isinf(stiffness):
            self.rigid.append(row)
        else:
            self.stiffness += stiffness * np.outer(row, row)

    def _flanks(self) -> None:
        train, forces = self.state.train, self.state.answer.flank_force
        laws = {p.name: p for p in self.state.pushes}
        for mesh in train.meshes.values():
            for drive in mesh.flanks:
                name = mesh.flank_name(drive)
                if forces[name] <= self.load:
                    continue
                on_driver, on_driven, n = mesh.direction(drive)
                row = self._turned(mesh.driver, on_driver) + self._turned(mesh.driven, on_driven)
                row += self._moved(mesh.driver, n) - self._moved(mesh.driven, n)
                stiffness = least_slope(laws[name].law, forces[name])
                self._hold(row, stiffness)
                for gear, slope in self.torque_slope.items():
                    lever = {mesh.driver: on_driver, mesh.driven: on_driven}.get(gear, 0.0)
                    if lever and math.isfinite(stiffness):
                        slope += lever * stiffness * row

    def _ring_contacts(self) -> None:
        for push in self._carrying_ring_contacts():
            assert push.pushed is not None
            row = self._moved(push.pushed, push.normal)
            if push.pushing is None:
                self._hold(row, least_slope(push.law, push.force))
                continue
            self._hold(row - self._moved(push.pushing, push.normal),
                       least_slope(push.law, push.force))  # fmt: skip
            beside = np.cross(self.state.train.gears[push.pushed].axis, push.normal)
            across = self._moved(push.pushed, beside) - self._moved(push.pushing, beside)
            self.taken += push.force / self._distance(push) * np.outer(across, across)

    def _carrying_ring_contacts(self) -> Iterator[Push]:
        return (p for p in self.state.pushes if p.gear is not None and p.force > self.load)

    def _distance(self, push: Push) -> float:
        """|d| of an arc [m] at the answer."""
        assert push.pushed is not None
        assert push.pushing is not None
        (ring,) = (r for r in self.state.train.drums if r.gear == push.pushed)
        side = ring.neighbours.index(push.pushing)
        arc = self.state.train.arc(ring, side, self.state.situation)
        way = arc.start + self.state.moved(push.pushed) - self.state.moved(push.pushing)
        return float(np.linalg.norm(way))

    def _springs(self) -> None:
        for shaft in self.state.train.shafts.values():
            row = self._turned(shaft.first, 1.0) - self._turned(shaft.second, 1.0)
            scale = float(np.linalg.norm(row))
            if scale > 0.0:
                rigid = math.isinf(shaft.stiffness)
                self._hold(row / scale if rigid else row, shaft.stiffness)
        for name, _, held, _ in self.state.bearings():
            at = self.move_at[name]
            self.stiffness[[at, at + 1], [at, at + 1]] += held

    def _follows(self, pull: Pull) -> bool:
        """Whether the force of a radial element follows the torque where it stands."""
        spline = self.state.train.splines.get(pull.gear)
        if pull.is_ring or spline is None or pull.name != spline.name or not _follows(spline):
            return False
        radius, force = float(np.linalg.norm(pull.offset)), float(np.linalg.norm(pull.reaction))
        if radius <= self.near:
            return False
        if self.state.train.slip is not None:
            return True
        return _piece(pull, radius, force, self.near, self.load)[0].name != "stick"

    def _pull(self, pull: Pull) -> None:
        """A radial element: the slope of its piece along, force over radius across."""
        frame = self.state.train.gears[pull.gear].frame
        radius, force = float(np.linalg.norm(pull.offset)), float(np.linalg.norm(pull.reaction))
        piece, at_stop = _piece(pull, radius, force, self.near, self.load)
        if radius <= self.near:
            held = math.inf if at_stop else piece.stiffness
            for way in frame:
                self._hold(self._moved(pull.gear, way), held)
            return
        outward = pull.offset / radius
        beside = np.cross(self.state.train.gears[pull.gear].axis, outward)
        along = self._moved(pull.gear, outward)
        self._hold(along, math.inf if at_stop else piece.stiffness)
        self._hold(self._moved(pull.gear, beside), force / radius)
        if not self._follows(pull):
            return
        spline = self.state.train.splines[pull.gear]
        torque = self.state.transmitted(pull.gear)
        follow = math.copysign(spline.friction_per_torque, torque) * self.torque_slope[pull.gear]
        coupling = np.outer(along, follow)
        self.taken -= 0.5 * (coupling + coupling.T)

    def _remembering(self) -> None:
        """Splines with memory: held by their shaft where the slip is, and by nothing elsewhere."""
        for pull in self.state.pulls:
            spline = self.state.train.splines.get(pull.gear)
            if pull.is_ring or spline is None or pull.name != spline.name:
                continue
            if float(np.linalg.norm(pull.offset)) <= self.near:
                for way in self.state.train.gears[pull.gear].frame:
                    self._hold(self._moved(pull.gear, way), spline.bending_stiffness)

    def curvature(self) -> float:
        """Largest κ of M z = κ K z on the moves that rigid contacts leave, at least 0."""
        if self.state.train.slip is not None and any(map(self._follows, self.state.pulls)):
            return math.inf
        self._assemble()
        free = np.eye(self.size)
        if self.rigid:
            rows = np.array([r / (np.linalg.norm(r) or 1.0) for r in self.rigid])
            _, sizes, basis = np.linalg.svd(rows)
            free = basis[int((sizes > RANK).sum()) :].T
        stiffness, taken = (free.T @ m @ free for m in (self.stiffness, self.taken))
        values, vectors = np.linalg.eigh(stiffness)
        held = values > FLAT * max(float(values.max(initial=0.0)), 0.0)
        loose = vectors[:, ~held]
        size = float(np.abs(self.taken).max())
        if loose.size and float(np.abs(taken @ loose).max(initial=0.0)) > RANK * size:
            return math.inf
        root = vectors[:, held] / np.sqrt(values[held])
        largest = float(np.linalg.eigvalsh(root.T @ taken @ root).max(initial=0.0))
        return largest if largest > NOTHING else 0.0


def least_slope(law: Law, force: float) -> float:
    """Least slope [N/m] from a loaded contact to any other compression of it; infinite if rigid."""
    if isinstance(law, TableLaw):
        return float(np.min(np.diff(law.forces) / np.diff(law.compressions)))
    compression = law.compression(force)
    return force / compression if compression > 0.0 else math.inf


def _piece(pull: Pull, radius: float, force: float, near: float, load: float) -> tuple[Piece, bool]:
    """The piece of a graph on which it stands, and whether it leans on a rigid stop."""
    law = pull.law
    at_stop = math.isfinite(law.reach) and radius >= law.reach - near
    at_stop = at_stop and force > law.pieces[-1].end_force + load
    here = law.pieces[0]
    for k, piece in enumerate(law.pieces):
        if radius >= law.start(k) - near and force >= piece.force - load:
            here = piece
    return here, at_stop
