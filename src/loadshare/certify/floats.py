"""Where each float rests: inside its region or on which boundary, and its spline's stage."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.pulls import Pull, pulls_of
from loadshare.certify.state import ClaimedState
from loadshare.train.train import Train

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Touch:
    """A boundary of a float's region.

    Attributes
    ----------
    name : str
    margin : float
        Distance left [m]; negative inside an elastic ring's wall.
    force : float
        Size of its reaction [N].
    normal : tuple of float
        Outward normal of the region, (2,) in the gear's transverse frame.
    touching : bool
        Whether the centre lies on it: it pushes, or its margin is within the band and the place is
        determined.
    """

    name: str
    margin: float
    force: float
    normal: tuple[float, float]
    touching: bool


@dataclass(frozen=True, slots=True)
class FloatState:
    """Rest of one float.

    Attributes
    ----------
    gear : str
    state : str
        "inside", "on boundary", or "undetermined" where forces leave the place open and no boundary
        pushes; what it then says of margins holds for the place of least norm.
    boundary : str or None
        The boundaries it touches, the hardest pressed first.
    margin : float or None
        Smallest distance to a boundary [m]; None without a ring.
    normal : tuple of float or None
        Outward normal of the hardest pressed boundary.
    reaction : tuple of float
        Force of the ring on the gear [N], (2,) in the gear's transverse frame.
    boundaries : tuple of Touch
    spline : str or None
        Stage of the spline: "stick", "slip", "stop".
    spline_force : float
        Size of the spline's force [N].
    friction : float or None
        Friction bound F_m of the spline [N].
    """

    gear: str
    state: str
    boundary: str | None
    margin: float | None
    normal: tuple[float, float] | None
    reaction: tuple[float, float]
    boundaries: tuple[Touch, ...]
    spline: str | None
    spline_force: float
    friction: float | None


def float_states(
    state: ClaimedState, undetermined: Collection[str], band: float
) -> dict[str, FloatState]:
    """Judge every float of a train.

    Parameters
    ----------
    state : ClaimedState
        Of a single claim that can be judged.
    undetermined : collection of str
        Coordinates that its forces do not determine.
    band : float
        Relative band: a margin within band × deflection, or a reaction above band × load with no
        margin left, is contact.
    """
    train = state.of.train
    near, pressed = band * float(state.deflection[0]), band * float(state.load[0])
    pulls = pulls_of(state)
    found = {}
    for gear in train.floating:
        settled = not {f"gear {gear} x", f"gear {gear} y"} & {*undetermined}
        rests = _Rests(settled, near, pressed)
        touches = [*_drum_touches(state, gear, rests), *_ring_touches(train, gear, pulls, rests)]
        spline = [p for p in pulls if p.gear == gear and not p.is_ring]
        found[gear] = _float_state(state, gear, rests, touches, spline)
    return found


@dataclass(frozen=True, slots=True)
class _Rests:
    """What counts as contact: whether the place is determined, and the bands [m], [N]."""

    settled: bool
    near: float
    pressed: float

    def touching(self, margin: float, force: float) -> bool:
        """Whether a centre lies on a boundary."""
        return (self.settled and margin <= self.near) or force > self.pressed


def _drum_touches(state: ClaimedState, gear: str, rests: _Rests) -> Iterator[tuple[Touch, Array]]:
    """Boundaries of a gear's drum, and their forces on it (2,) [N]."""
    for d, ring in enumerate(state.of.train.drums):
        if ring.gear != gear:
            continue
        frame, ways = state.of.train.gears[gear].plane, state.way[d, :, :, 0]
        outward = [*(-way / np.linalg.norm(way) for way in ways), ring.across, -ring.across]
        first = len(state.of.flanks) + 4 * d
        for k, way in enumerate(outward):
            force, margin = float(state.ring_force[d, k, 0]), -float(state.approach[first + k, 0])
            normal, touching = frame @ way, rests.touching(margin, force)
            name = state.of.contacts[first + k]
            yield Touch(name, margin, force, _pair(normal), touching), -force * normal


def _ring_touches(
    train: Train, gear: str, pulls: Iterable[Pull], rests: _Rests
) -> Iterator[tuple[Touch, Array]]:
    """Boundary of a gear's round ring, and its force on it (2,) [N]."""
    frame = train.gears[gear].plane
    for pull in pulls:
        if pull.gear != gear or not pull.is_ring:
            continue
        radius, force = pull.radius, frame @ pull.reaction
        size = float(np.linalg.norm(force))
        outward = frame @ pull.offset / radius if radius > 0.0 else np.zeros(2)
        margin = pull.play - radius
        touching = rests.touching(margin, size)
        yield Touch(pull.name, margin, size, _pair(outward), touching), force


def _float_state(
    state: ClaimedState,
    gear: str,
    rests: _Rests,
    touches: list[tuple[Touch, Array]],
    spline: list[Pull],
) -> FloatState:
    boundaries = sorted((touch for touch, _ in touches), key=lambda t: -t.force)
    on = [t for t in boundaries if t.touching]
    friction = None
    if spline:
        train = state.of.train
        torque = float(state.transmitted[list(train.splines).index(gear), 0])
        friction = train.splines[gear].bound(torque)
    return FloatState(
        gear=gear,
        state="on boundary" if on else "inside" if rests.settled else "undetermined",
        boundary=" + ".join(t.name.split(": ")[-1] for t in on) or None,
        margin=min((t.margin for t in boundaries), default=None),
        normal=on[0].normal if on else None,
        reaction=_pair(sum((force for _, force in touches), np.zeros(2))),
        boundaries=tuple(boundaries),
        spline=_stage(spline, rests) if spline else None,
        spline_force=float(np.linalg.norm(sum(p.reaction for p in spline))) if spline else 0.0,
        friction=friction,
    )


def _pair(vector: Array) -> tuple[float, float]:
    return float(vector[0]), float(vector[1])


def _stage(parts: list[Pull], rests: _Rests) -> str:
    """Stage of a spline: the last piece that its radius has entered and its force has reached.

    With memory its parts are friction and clearance. Where both hold the slip, how they share the
    force is open; it sticks if friction could do it alone.
    """
    near, pressed = rests.near if rests.settled else math.inf, rests.pressed
    if len(parts) > 1:
        friction, stop = parts
        total = float(np.linalg.norm(friction.reaction + stop.reaction))
        if friction.radius <= near and total <= friction.law.strength + pressed:
            return "stick"
        return "stop" if stop.force > pressed else "slip"
    (pull,) = parts
    radius, force = pull.radius, pull.force
    stage = pull.law.pieces[0].name
    for k, piece in enumerate(pull.law.pieces):
        more = pressed if math.isinf(near) and piece.stiffness > 0.0 else -pressed
        if radius >= pull.law.start(k) - near and force >= piece.force + more:
            stage = piece.name
    return stage
