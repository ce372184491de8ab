"""How strongly a computed law depends on the rims and on the sampling of the mesh cycle.

Both are found with slices, whatever model the pair is analysed with: only ratios are given, and
slices are fast.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from loadshare.tooth.analysis.ltca import PairCompliance, ltca
from loadshare.tooth.compliance.slices import Slices
from loadshare.tooth.pair.file import PairFile

THINNER, THICKER = 0.5, 1.5
"""Thicknesses of the rims that are tried, over the pair's own."""
Which = Literal["driver", "driven"]


@dataclass(frozen=True, slots=True)
class RimEffect:
    """Mean stiffness of a pair with other rims of one gear.

    Attributes
    ----------
    thickness : tuple of float
        Thickness below the root of a thinner rim, of the gear's own, and of a thicker one [m].
    stiffness : tuple of float
        T over the mean deflection of the cycle, relative to that with the gear's own rim.
    """

    thickness: tuple[float, float, float]
    stiffness: tuple[float, float, float]


def rim_effects(pair: PairFile) -> dict[Which, RimEffect]:
    """Return the effect of thinner and of thicker rims of either gear.

    They are half as thick, and half as thick again, or half-way to a solid body if that is less.

    Parameters
    ----------
    pair : PairFile

    Returns
    -------
    dict of "driver" or "driven" to RimEffect

    Raises
    ------
    Refused
        If a position has no certified contact.
    """
    geometry = pair.geometry
    loaded: dict[Which, tuple[Any, int]] = {
        "driver": (geometry.driver, 1),
        "driven": (geometry.driven, geometry.driven_side),
    }
    own = {name: Slices(*flank) for name, flank in loaded.items()}
    mean = _mean_deflection(pair, own)
    found = {}
    for name, (body, side) in loaded.items():
        thickness = body.gear.rim_thickness
        most = np.inf if body.gear.shape != "external" else 0.5 * (thickness + body.gear.root)
        tried = thickness * THINNER, min(thickness * THICKER, most)
        others = [
            _mean_deflection(pair, own | {name: Slices(_on_rim(body, rim), side)}) for rim in tried
        ]
        found[name] = RimEffect(
            (tried[0], thickness, tried[1]), (mean / others[0], 1.0, mean / others[1])
        )
    return found


def sampled_deflection(pair: PairFile) -> float:
    """Return the mean elastic deflection at a pair's positions over that of the whole mesh cycle.

    Parameters
    ----------
    pair : PairFile

    Raises
    ------
    Refused
        If a position has no certified contact.
    """
    count = pair.analysis.positions
    found = ltca(pair.geometry, pair.torque, count, (1.0,), "slices", means=True)
    return float(found.approach[:, -1].mean() / found.elastic[:, -1].mean())


def _mean_deflection(pair: PairFile, models: dict[Which, Slices]) -> float:
    compliance = PairCompliance(models["driver"], models["driven"], "slices")
    found = ltca(pair.geometry, pair.torque, 1, (1.0,), compliance, means=True)
    return float(found.elastic[0, -1])


def _on_rim(body: Any, thickness: float) -> Any:
    gear = body.gear
    rim = thickness if body.gear.shape == "face" else gear.root - gear.kind * thickness
    return replace(body, gear=replace(gear, rim=rim))
