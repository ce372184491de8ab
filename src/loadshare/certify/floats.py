"""Where each float rests: inside its region or on which boundary, and its spline's stage."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.certify.state import Pull, State


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


def float_states(state: State, band: float) -> dict[str, FloatState]:
    """Judge every float of a train.

    Parameters
    ----------
    state : State
    band : float
        Relative band: a margin within band × deflection, or a reaction above band × load with no
        margin left, is contact.
    """
    return {gear: _float_state(state, gear, band) for gear in state.train.floating}


def _float_state(state: State, gear: str, band: float) -> FloatState:
    frame = state.train.gears[gear].frame
    settled = not {f"gear {gear} x", f"gear {gear} y"} & state.answer.undetermined.keys()
    near, pressed = band * state.length_scale, band * state.force_scale
    touches: list[Touch] = []
    reaction = np.zeros(2)
    for push in state.pushes:
        if push.gear != gear:
            continue
        reaction += push.force * (frame @ push.normal)
        margin = -push.approach
        normal = -(frame @ push.normal)
        touching = (settled and margin <= near) or push.force > pressed
        touches.append(Touch(push.name, margin, push.force, _pair(normal), touching))
    spline: list[Pull] = []
    for pull in state.pulls:
        if pull.gear != gear:
            continue
        if not pull.is_ring:
            spline.append(pull)
            continue
        radius = float(np.linalg.norm(pull.offset))
        force = frame @ pull.reaction
        reaction += force
        size = float(np.linalg.norm(force))
        outward = frame @ pull.offset / radius if radius > 0.0 else np.zeros(2)
        margin = pull.law.pieces[0].length - radius
        if pull.law.pieces[0].name != "inside":
            margin = -radius
        touching = (settled and margin <= near) or size > pressed
        touches.append(Touch(pull.name, margin, size, _pair(outward), touching))
    touches.sort(key=lambda t: -t.force)
    on = [t for t in touches if t.touching]
    return FloatState(
        gear=gear,
        state="on boundary" if on else "inside" if settled else "undetermined",
        boundary=" + ".join(t.name.split(": ")[-1] for t in on) or None,
        margin=min((t.margin for t in touches), default=None),
        normal=on[0].normal if on else None,
        reaction=_pair(reaction),
        boundaries=tuple(touches),
        spline=_stage(spline, near if settled else math.inf, pressed) if spline else None,
        spline_force=float(np.linalg.norm(sum(p.reaction for p in spline))) if spline else 0.0,
        friction=state.train.splines[gear].bound(state.transmitted(gear)) if spline else None,
    )


def _pair(vector: np.ndarray) -> tuple[float, float]:
    return float(vector[0]), float(vector[1])


def _stage(parts: list[Pull], near: float, pressed: float) -> str:
    """Stage of a spline: the last piece that its radius has entered and its force has reached.

    With memory its parts are friction and clearance. Where both hold the slip, how they share the
    force is open; it sticks if friction could do it alone.
    """
    if len(parts) > 1:
        friction, stop = parts
        held = float(np.linalg.norm(friction.offset)) <= near
        total = float(np.linalg.norm(friction.reaction + stop.reaction))
        if held and total <= friction.law.strength + pressed:
            return "stick"
        return "stop" if float(np.linalg.norm(stop.reaction)) > pressed else "slip"
    (pull,) = parts
    radius, force = float(np.linalg.norm(pull.offset)), float(np.linalg.norm(pull.reaction))
    stage = pull.law.pieces[0].name
    for k, piece in enumerate(pull.law.pieces):
        more = pressed if math.isinf(near) and piece.stiffness > 0.0 else -pressed
        if radius >= pull.law.start(k) - near and force >= piece.force + more:
            stage = piece.name
    return stage
