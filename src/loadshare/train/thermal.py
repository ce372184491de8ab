"""Thermal growth: bodies warmer than when they were made, as gaps of known size.

A body grows uniformly by α ΔT. The growth of a gear at the pitch point adds to the approach as much
as moving the gear that far towards the pitch point would. Housing and carriers move the gears
mounted in them along the line of centres: gears that grow as much as these come no closer.
Source: formulation, section 14.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from loadshare import case as spec
from loadshare.errors import CaseError
from loadshare.train.gear import Gear
from loadshare.train.geometry import Pair
from loadshare.train.ring import Bearing, transverse


def growth_of(case: spec.Case, gear: str | None) -> float:
    """Return the relative growth of a gear, or of the housing [-]."""
    body = case.operating if gear is None else case.gears[gear]
    if body.temperature is None:
        return 0.0
    return body.temperature.si * (body.expansion.si if body.expansion else spec.STEEL_EXPANSION)


def grows(case: spec.Case) -> bool:
    """Return whether anything is warmer than when it was made."""
    return any(growth_of(case, body) for body in (None, *case.gears))


def flank_growth(case: spec.Case, pair: Pair) -> float:
    """Return by how much both flanks of a mesh come closer as its gears grow [m].

    Parameters
    ----------
    case : spec.Case
    pair : Pair
    """
    driver, driven, normal = pair.driver, pair.driven, pair.normals[0]
    way = transverse(driven.centre - driver.centre, driver.axis)
    way = way / np.linalg.norm(way)
    # From a centre to the pitch point: in an internal mesh both point away from the ring's centre.
    ahead = -way if driven.kind == "internal" else way
    back = way if driver.kind == "internal" else -way
    total, seat = 0.0, growth_of(case, driver.carrier or driven.carrier)
    for gear, to_pitch, sign in ((driver, ahead, 1.0), (driven, back, -1.0)):
        radius = gear.base_radius / np.cos(pair.line.pressure_angle)
        grown = growth_of(case, gear.name) - seat
        total += sign * grown * radius * float(normal @ to_pitch)
    return total


def fitted(case: spec.Case, bearing: Bearing, gear: Gear) -> Bearing:
    """Return a bearing with the clearance that is left when the bodies are warm.

    A gear's shaft grows in the housing, a planet about the pin of its carrier.

    Raises
    ------
    CaseError
        If it is negative: the laws here do not describe a bearing with interference.
    """
    given = case.bearings[gear.name]
    if given.diameter is None:
        return bearing
    inner, outer = growth_of(case, gear.name), growth_of(case, None)
    if gear.carrier is not None:
        inner, outer = growth_of(case, gear.carrier), inner
    left = bearing.radius + 0.5 * given.diameter.si * (outer - inner)
    if np.any(left < 0.0):
        message = f"is used up as the bodies expand: {1e6 * float(np.min(left)):.4g} um are left"
        raise CaseError([case.problem(("bearings", gear.name, "clearance"), message)])
    return replace(bearing, radius=left)
