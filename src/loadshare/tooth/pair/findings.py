"""Warnings about a pair that is valid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from loadshare.errors import Problem
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.cylindrical.pair import HelicoidPair
from loadshare.tooth.face.flank import tip_half_angle
from loadshare.tooth.face.pair import FaceGearPair
from loadshare.tooth.problems import digits, millimetres, problem
from loadshare.tooth.unloaded.touch import contact_points

# Tips thinner than this, in modules, are commonly avoided for case-hardened teeth.
THIN_TIP = 0.2
# Pairs of teeth that touch within this angle of the first [rad] count as touching.
ROUND_OFF = 1e-9

REMEDY = {
    "face": "Crown the flank along the lead, relieve its ends, or make the misalignment smaller.",
    "inner end": "Use fewer pinion teeth, or make the misalignment smaller.",
    "outer end": "Use fewer pinion teeth, or make the misalignment smaller.",
    "tip": "Relieve the tip.",
    "root": "Relieve the partner's tip.",
}


def findings(pair: HelicoidPair | FaceGearPair, positions: int = 16) -> tuple[Problem, ...]:
    """Return warnings of contact at edges, thin tips and contact that is not localised.

    Parameters
    ----------
    pair : HelicoidPair or FaceGearPair
        The two gears.
    positions : int
        Number of positions of the mesh cycle that are checked for contact at an edge.

    Returns
    -------
    tuple of Problem
        Warnings with the dimension they come from; nothing here is fatal.

    Raises
    ------
    NoContactError
        If at some position no pair of teeth is within both active flanks.
    """
    return (*thin_tips(pair), *_not_localised(pair), *edge_contacts(pair, positions))


def thin_tips(pair: HelicoidPair | FaceGearPair) -> Iterator[Problem]:
    """Yield tips that are thinner than is common."""
    for name, gear in (("driver", pair.driver.gear), ("driven", pair.driven.gear)):
        if isinstance(gear, HelicoidGear):
            land = 2.0 * gear.tip * gear.half_angle(gear.tip)
            yield from _thin_tip(f"{name}.addendum", gear.addendum, land, gear.module)
    if isinstance(pair, FaceGearPair):
        face = pair.gear
        land = 2.0 * face.outer * tip_half_angle(pair.driven.flank, face.outer)
        yield from _thin_tip("driven.outer", face.outer, land, face.shaper.module)


def _not_localised(pair: HelicoidPair | FaceGearPair) -> Iterator[Problem]:
    if isinstance(pair, FaceGearPair) and pair.pinion.teeth == pair.gear.shaper.teeth:
        yield problem(
            "driven.shaper.teeth",
            pair.pinion.teeth,
            "the pinion has as many teeth as the shaper: contact is along a line and "
            "moves to an end of the teeth when the pair is misaligned",
            f"{pair.pinion.teeth + 1} to {pair.pinion.teeth + 3} for localised contact",
        )


def edge_contacts(pair: HelicoidPair | FaceGearPair, positions: int = 16) -> tuple[Problem, ...]:
    """Return a finding for every edge of the active flanks at which the pair touches first.

    Parameters
    ----------
    pair : HelicoidPair or FaceGearPair
        The two gears.
    positions : int
        Number of positions of the mesh cycle that are checked.

    Returns
    -------
    tuple of Problem
        Keyed by gear and edge, with the phases.
    """
    phases: dict[str, list[float]] = {}
    for phase in np.arange(positions) / positions:
        points = contact_points(pair, float(phase))
        first = min(point.lead for point in points)
        for point in points:
            if point.edge and point.lead <= first + ROUND_OFF:
                phases.setdefault(point.edge, []).append(float(phase))
    return tuple(
        problem(
            edge.replace(" ", ".", 1).replace(" ", "_"),
            "",
            f"the unloaded flanks touch first at the {edge}, at "
            f"{len(where)} of {positions} positions (phase {digits(where[0])} first)",
            "contact within both active flanks",
            REMEDY[edge.split(" ", 1)[1]],
        )
        for edge, where in sorted(phases.items())
    )


def _thin_tip(key: str, given: float, land: float, module: float) -> Iterator[Problem]:
    if land < THIN_TIP * module:
        allowed = f"{millimetres(THIN_TIP * module)} or more for case-hardened teeth"
        yield problem(key, given, f"the tip land is {millimetres(land)} wide", allowed)
