"""Why a claim cannot be judged."""

from __future__ import annotations

import numpy as np

from loadshare.certify.state import ClaimedState
from loadshare.train.memory import SlipFriction
from loadshare.train.train import Train


def fault_of(train: Train, state: ClaimedState, row: int) -> str:
    """Return why a claim cannot be judged; empty if it can.

    Either a figure is not a number or too large, or a spline has no law, or a gear is beyond the
    neighbour on whose ring its own rolls: there the arc's inequality holds, but no gear can be.
    """
    if not state.faulty[row]:
        return ""
    if not all(np.isfinite(claimed[..., row]).all() for claimed in state.claim.arrays):
        return "a figure that is not a number"
    try:
        for k, spline in enumerate(train.splines.values()):
            part = spline if train.slip is None else SlipFriction(spline)
            part.law(float(state.transmitted[k, row]))
    except ValueError as error:
        return str(error)
    beyond = [
        ring.arc_name(neighbour)
        for ring, sides in zip(train.drums, state.beyond[..., row], strict=True)
        for neighbour, is_beyond in zip(ring.neighbours, sides, strict=True)
        if is_beyond
    ]
    return f"a place beyond the neighbour, {', '.join(beyond)}" if beyond else "a figure too large"
