"""Radial elements of a single claim with their laws, and why a claim cannot be judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.certify.state import ClaimedState
from loadshare.contact.radial import RadialLaw, round_ring_law
from loadshare.train.memory import SlipFriction, SlipStop


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """A radial element.

    Attributes
    ----------
    name, gear : str
    number : int
        Among the radial elements of `Mechanics`.
    law : RadialLaw
    offset : ndarray, shape (3,)
        Displacement of the gear's centre from the element's [m].
    reaction : ndarray, shape (3,)
        Force on the gear [N], as claimed.
    is_ring : bool
    play : float
        How far the gear moves freely [m].
    """

    name: str
    gear: str
    number: int
    law: RadialLaw
    offset: Array
    reaction: Array
    is_ring: bool
    play: float = 0.0

    @property
    def radius(self) -> float:
        """Size of the offset [m]."""
        return float(np.linalg.norm(self.offset))

    @property
    def force(self) -> float:
        """Size of the reaction [N]."""
        return float(np.linalg.norm(self.reaction))


def pulls_of(state: ClaimedState) -> tuple[Pull, ...]:
    """Return the radial elements of the first claim.

    Raises
    ------
    ValueError
        If a spline has no law at the torque that it transmits; the message names the numbers.
    """
    of = state.of
    splines = _spline_laws(state)
    of_rounds = (float(v[0]) for v in state.here.round_radius)
    plays = [*(0.0 for _ in splines), *of_rounds]
    walls = zip(state.graph.reach[:, 0], state.graph.last[:, 0], strict=True)
    rings = [round_ring_law(float(r), float(k)) for r, k in walls][len(splines) :]
    return tuple(
        Pull(name, of.gears[of.pulled[q]], q, law, state.offset[q, :, 0], state.reaction[q, :, 0],
             q >= len(splines), plays[q])
        for q, (name, law) in enumerate(zip(of.pulls, [*splines, *rings], strict=True))
    )  # fmt: skip


def _spline_laws(state: ClaimedState) -> list[RadialLaw]:
    """Laws of splines; with memory of friction, and then of the stops."""
    train = state.of.train
    if not train.splines:
        return []
    torques = state.transmitted[:, 0].tolist()
    splines = list(zip(train.splines.values(), torques, strict=True))
    if train.slip is None:
        return [s.law(torque) for s, torque in splines]
    return [part(s).law(torque) for part in (SlipFriction, SlipStop) for s, torque in splines]


def fault_of(state: ClaimedState) -> str:
    """Why the first claim cannot be judged, else empty.

    A figure is not a number, a spline has no law, or a gear is beyond the neighbour on whose
    ring its own rolls: there the arc's inequality holds, and no gear can be.
    """
    if not state.faulty[0]:
        return ""
    if not all(np.isfinite(claimed[..., 0]).all() for claimed in state.claim.arrays):
        return "a figure that is not a number"
    try:
        _spline_laws(state)
    except ValueError as error:
        return str(error)
    beyond = [
        ring.arc_name(neighbour)
        for ring, sides in zip(state.of.train.drums, state.beyond[..., 0], strict=True)
        for neighbour, is_beyond in zip(ring.neighbours, sides, strict=True)
        if is_beyond
    ]
    return f"a place beyond the neighbour, {', '.join(beyond)}" if beyond else "a figure too large"
