"""Support of a body across its axis by the bearings of its shaft, reduced to its place there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solve_triangular

from loadshare.exchange.rexs.gearing import Gearing, Joint
from loadshare.exchange.rexs.model import BEARINGS, Component

STIFF = 1e15
"""Stiffness from which a spring counts as rigid [N/m]."""
NEAR = 1e-9
"""Distance up to which places count as one [m]."""


def beam(stiffness: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, float]:
    """Return the part of a force at 0 that each spring takes, and the beam's compliance there.

    Parameters
    ----------
    stiffness : ndarray (n,)
        Stiffness of the springs [N/m].
    places : ndarray (n,)
        Their places along the beam [m].

    Returns
    -------
    ndarray (n,)
        The parts k (1, u) S⁻¹ (1, 0)ᵀ with S = Σ k (1, u)ᵀ (1, u); they add up to one.
    float
        The compliance (1, 0) S⁻¹ (1, 0)ᵀ [m/N].

    Notes
    -----
    With √k (1, u) = Q R and y = R⁻ᵀ (1, 0)ᵀ they are √k Q y and yᵀ y. Forming S = Rᵀ R would lose a
    spring that is softer than another by the machine precision; R, with the stiff rows first, does
    not.
    """
    arms, here = _arms(places)
    stiff_first = np.argsort(-stiffness, kind="stable")
    root = np.sqrt(stiffness[stiff_first])
    q, r = np.linalg.qr(root[:, None] * arms[stiff_first])
    y = solve_triangular(r.T, here, lower=True)
    parts = np.empty(len(stiffness))
    parts[stiff_first] = root * (q @ y)
    length = math.hypot(*y.tolist())
    return parts, length * length


def _arms(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (1, u) of the springs and of the place 0, in suitable units."""
    size = float(np.ptp(places))
    if is_one(places):
        return np.ones((len(places), 1)), np.ones(1)
    # About the middle of the springs and in units of their distance, for better conditioning.
    middle = float(places.mean())
    arms = np.column_stack([np.ones(len(places)), (places - middle) / size])
    return arms, np.array([1.0, -middle / size])


def is_one(places: ArrayLike) -> bool:
    """Return whether springs are all at one place: then the beam only moves and does not tilt."""
    return float(np.ptp(places)) < NEAR


CLEARANCES = (
    "operating_radial_bearing_clearance",
    "mounted_radial_bearing_clearance",
    "radial_bearing_clearance",
    "radial_clearance",
    "radial_backlash",
)
"""Names of a bearing's radial clearance in all versions; that in operation takes precedence."""


@dataclass(frozen=True)
class Link:
    """A bearing or coupling that holds a shaft.

    Attributes
    ----------
    part : Component
    side : str
        Its side on which the shaft is: "inner" or "outer".
    shaft : Component
    stiffness : float
        Across the axis [N/m]; `STIFF` if rigid.
    place : float
        How far it lies ahead of the body [m].
    """

    part: Component
    side: str
    shaft: Component
    stiffness: float
    place: float


@dataclass(frozen=True)
class Holding:
    """The support of a body.

    Attributes
    ----------
    support : dict
        Keys of the gear in the case.
    clearance : dict
        Its bearing with clearance, if any.
    offset : tuple of float
        Offset of the body due to misaligned bearings (3,) [m].
    parts : frozenset of str
        Ids of the bearings and couplings that hold it.
    """

    support: dict[str, Any]
    clearance: dict[str, Any]
    offset: tuple[float, float, float]
    parts: frozenset[str]


def holding_of(of: Gearing, body: Component, assumed: list[str]) -> Holding:
    """Return the support of a body.

    Its shaft is a rigid beam on its bearings, and the pin of a planet is one on its seats. The
    force on the body goes through both, so their compliances add up. Other bodies on the same shaft
    are neglected.
    """
    links, seats = _links(of, body, assumed)
    name, nowhere = of.names[body.id], (0.0, 0.0, 0.0)
    if not links:
        shafts = of.shafts_of(body)
        if shafts:
            assumed.append(f"{name}: no bearing holds it across its axis, so it floats")
        elif not any(whole.id in of.casing and part is body for whole, part in of.model.parts):
            assumed.append(f"{name}: it is on no shaft, and is held rigidly across its axis")
        return Holding({"support": "free" if shafts else "rigid"}, {}, nowhere, frozenset())
    yields = sum(_yields(level) for level in (links, seats) if level)
    stiffness = f"{1.0 / yields:.12g} N/m" if yields > 1.0 / STIFF else "rigid"
    if len(links) > 1 or yields:
        assumed.append("supports: each gear is held by the bearings of its shaft, a rigid beam")
    parts = frozenset(link.part.id for link in (*links, *seats))
    offset = _offset(of, [*_shared(links), *_shared(seats)])
    if any(offset) and body.id in of.carrier_of:
        assumed.append("planets: the misalignment of their bearings does not change when they turn")
    own, below = _clearance(links, assumed), _clearance(seats, assumed)
    gap = own + below
    if gap > 0.0:
        more = ", and half that of what carries its shaft" if below else ""
        assumed.append(f"{name}: half its bearings' mean radial clearance to each side{more}")
        clearance = {"clearance": f"{0.5e6 * gap:.12g} um", "stiffness": stiffness}
        return Holding({}, clearance, offset, parts)
    return Holding({"support": stiffness}, {}, offset, parts)


def _clearance(links: list[Link], assumed: list[str]) -> float:
    """Return the mean radial clearance of bearings [m]; it is 0 for those with preload."""
    gaps = []
    for part in (link.part for link in links if link.part.type in BEARINGS):
        given = part.number(*CLEARANCES) or 0.0
        if given < 0.0:
            assumed.append(
                f"{part.title()}: its clearance of {1e6 * given:g} um is a preload; 0 is assumed"
            )
        gaps.append(max(given, 0.0))
    return sum(gaps) / len(gaps) if gaps else 0.0


def force_parts(of: Gearing, body: Component) -> list[tuple[Link, float]]:
    """Return the bearings that hold a body, as in `holding_of`, and their parts of its force.

    Returns
    -------
    list of (Link, float)
        Links that hold its shaft, each with the part of the body's force that it takes; the parts
        add up to one. So do those of the seats of its pin.
    """
    links, seats = _links(of, body, [])
    return [*_shared(links), *_shared(seats)]


def _shared(links: list[Link]) -> list[tuple[Link, float]]:
    """Return links with the part of a force at the body that each takes."""
    return list(zip(links, _beam(links)[0].tolist(), strict=True)) if links else []


def _links(of: Gearing, body: Component, assumed: list[str]) -> tuple[list[Link], list[Link]]:
    """Return the links that hold a body's shafts, and those that hold the pin they turn on."""
    fixed = of.casing
    if body.id in of.carrier_of:
        fixed = fixed | of.parts_of(of.carrier_of[body.id])
    name = of.names[body.id]
    firm: list[Joint] = []
    pinned: list[tuple[Joint, list[Joint]]] = []
    riding: list[Joint] = []
    for joint in _joints(of, of.shafts_of(body)):
        other = joint.other
        if other.id in fixed:
            firm.append(joint)
        elif other.type == "shaft" and not of.on_shaft(other):
            seats = [seat for seat in _joints(of, [other]) if seat.other.id in fixed]
            if seats:
                pinned.append((joint, seats))
            elif other.id in of.pins:
                assumed.append("pins without a given seat are rigid in their carriers")
                firm.append(joint)
        elif other.type == "shaft" and other.id not in of.carrier_shafts:
            riding.append(joint)
    turns = body in of.gears and body.id not in of.carrier_of
    if turns and not firm and not pinned and len({joint.other.id for joint in riding}) == 1:
        bearer = riding[0].other
        seats = [seat for seat in _joints(of, [bearer]) if seat.other.id in fixed]
        if seats:
            pinned = [(joint, seats) for joint in riding]
            assumed.append(
                f"{name}: it rides on {bearer.title()}, whose other gears do not move it"
            )
    ends = [*firm, *(seat for _, seats in pinned for seat in seats)]
    if body.id in of.carrier_of and any(joint.other.id in of.casing for joint in ends):
        assumed.append(f"{name}: its supports in the casing are assumed to be on its carrier")
    # A single pin yields in series; beside other supports, the tilting of both shafts would count.
    seats = pinned[0][1] if pinned else []
    if firm or len({joint.other.id for joint, _ in pinned}) > 1:
        if any(radial(seat.part) < STIFF for _, seats in pinned for seat in seats):
            assumed.append(
                f"{name}: held in several ways; shafts without gears among them are rigid"
            )
        seats = []
    held = [*firm, *(joint for joint, _ in pinned)]
    return _placed(of, body, held, assumed), _placed(of, body, seats, assumed)


def _joints(of: Gearing, shafts: list[Component]) -> list[Joint]:
    """Return joints between some shafts and anything else that have a radial stiffness."""
    return [
        joint
        for shaft in shafts
        for joint in of.joints.get(shaft.id, [])
        if joint.other not in shafts and radial(joint.part) > 0.0
    ]


def _placed(of: Gearing, body: Component, joints: list[Joint], assumed: list[str]) -> list[Link]:
    """Return joints as springs along the axis of a body."""
    places = [of.ahead(joint.part, joint.shaft, joint.side, body) for joint in joints]
    unknown = len(joints) > 1 and None in places
    if unknown:
        places = [0.0 for _ in places]
    known = [place for place in places if place is not None]
    if unknown or (known and is_one(known) and abs(known[0]) > NEAR):
        why = "the places of its bearings are not given" if unknown else "it is held at one place"
        assumed.append(f"{of.names[body.id]}: tilting is neglected, as {why}")
    assumed += [
        f"{joint.part.title()}: no radial stiffness is given; it is rigid"
        for joint in joints
        if joint.part.type in BEARINGS and joint.part.number("radial_stiffness") is None
    ]
    assumed += [
        f"{joint.part.title()}: no w axis is given; its misalignment counts from z"
        for joint in joints
        if any(joint.part.number(f"misalignment_in_{axis}_direction") for axis in "vw")
        and all(body.vector("w_axis_vector") is None for body in (joint.part, joint.shaft))
    ]
    return [
        Link(joint.part, joint.side, joint.shaft, radial(joint.part), place or 0.0)
        for joint, place in zip(joints, places, strict=True)
    ]


def radial(part: Component) -> float:
    """Return the stiffness of a bearing or coupling across its axis [N/m]; 0 if it has none."""
    given = part.number("radial_stiffness")
    if part.attributes.get("radial_force_absorption") is False:
        return 0.0
    if given is None:
        return STIFF if part.type in BEARINGS or part.type == "rigid_connection" else 0.0
    return min(given, STIFF)


def _beam(links: list[Link]) -> tuple[np.ndarray, float]:
    stiffness = np.array([link.stiffness for link in links])
    return beam(stiffness, np.array([link.place for link in links]))


def _yields(links: list[Link]) -> float:
    """Return the compliance of a body on its links [m/N]; 0 if all are rigid."""
    if min(link.stiffness for link in links) >= STIFF:
        return 0.0
    return _beam(links)[1]


def _offset(of: Gearing, borne: list[tuple[Link, float]]) -> tuple[float, float, float]:
    """Return how far misaligned bearings move a body without load (3,) [m].

    A bearing's misalignment is the offset of its outer ring where that is mounted: a shaft inside
    moves with it, a shaft outside moves the other way. As the shaft is rigid, each bearing moves
    the body by its offset times the part of the body's force that it takes; so does each seat of
    the pin.
    """
    total = np.zeros(3)
    for link, part in borne:
        v, w = of.places.across(link.part, link.shaft)
        moved = (link.part.number("misalignment_in_v_direction") or 0.0) * v
        moved += (link.part.number("misalignment_in_w_direction") or 0.0) * w
        total += part * moved if link.side == "inner" else -part * moved
    x, y, z = total.tolist()
    return (x, y, z)
