"""What holds a body across its axis: the bearings of its shaft, seen from its place on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import solve_triangular

from loadshare.exchange.rexs.model import Component, Model

BEARINGS = (
    "concept_bearing",
    "rolling_bearing_with_catalog_geometry",
    "rolling_bearing_with_detailed_geometry",
    "plain_bearing",
    "radial_plain_bearing",
)
STIFF = 1e15
"""Stiffness from which on a bearing counts as rigid [N/m]."""


@dataclass(frozen=True)
class Holding:
    """What holds a body.

    Attributes
    ----------
    support : dict
        Of a gear of a case.
    clearance : dict
        Its bearing with clearance, if any.
    offset : tuple of float
        By which its bearings are out of place (3,) [m].
    """

    support: dict[str, Any]
    clearance: dict[str, Any]
    offset: tuple[float, float, float]


def holding_of(
    model: Model, shafts: list[Component], at: float, name: str, assumed: list[str]
) -> Holding:
    """Return what holds a body at a place along its shaft [m].

    The shaft is a rigid beam on the stiffnesses k of its bearings at u; at a place x it yields by

    (1, x) S⁻¹ (1, x)ᵀ with S = Σ k (1, u)ᵀ (1, u).

    Other bodies on the same shaft are not seen.
    """
    found = _bearings_on(model, shafts)
    if not found:
        return Holding({"support": "free" if shafts else "rigid"}, {}, (0.0, 0.0, 0.0))
    stiffness = [_stiffness(bearing, name, assumed) for bearing, *_ in found]
    places = np.array([place for _, place, _ in found])
    held = _seen_from(at, np.array(stiffness), places)
    if len(found) > 1 or held is not None:
        assumed.append("supports: each gear by the bearings of its shaft, as a rigid beam")
    rigid = held is None or held >= STIFF
    bearings = [bearing for bearing, *_ in found]
    clearance_keys = ("operating_radial_bearing_clearance", "radial_clearance")
    gaps = [bearing.number(*clearance_keys) or 0.0 for bearing in bearings]
    offset = _offset(bearings)
    gap = sum(gaps) / len(gaps)
    if gap > 0.0:
        assumed.append(f"{name}: half of its bearings' mean radial clearance to every side")
        text = "rigid" if rigid else f"{held:.12g} N/m"
        return Holding({}, {"clearance": f"{0.5e6 * gap:.12g} um", "stiffness": text}, offset)
    return Holding({"support": "rigid" if rigid else f"{held:.12g} N/m"}, {}, offset)


def borne_by(
    model: Model, shafts: list[Component], at: float
) -> list[tuple[Component, str, float]]:
    """Return the bearings that hold a body at a place along its shaft [m], as `holding_of` has it.

    Returns
    -------
    list of (Component, str, float)
        Bearing, the side on which the shaft is ("inner" or "outer"), and the part of the body's
        force that the bearing takes, k (1, u) S⁻¹ (1, x)ᵀ; all parts add up to one.
    """
    found = _bearings_on(model, shafts)
    if not found:
        return []
    stiffness = np.array([_stiffness(bearing, "", []) for bearing, *_ in found])
    parts, _ = _beam(at, stiffness, np.array([place for _, place, _ in found]))
    return [(b, side, part) for (b, _, side), part in zip(found, parts.tolist(), strict=True)]


def axes_of(bearing: Component) -> tuple[np.ndarray, np.ndarray]:
    """Directions v and w of a bearing, of length 1."""
    u = np.array(bearing.vector("u_axis_vector") or (1.0, 0.0, 0.0))
    w = np.array(bearing.vector("w_axis_vector") or (0.0, 0.0, 1.0))
    u, w = (a / np.linalg.norm(a) if a.any() else a for a in (u, w))
    return np.cross(w, u), w


def _bearings_on(model: Model, shafts: list[Component]) -> list[tuple[Component, float, str]]:
    """Bearings of shafts, where along the shaft they sit [m], and on which side it is."""
    found = []
    for bearing, inner, outer in model.related("side", "assembly", "inner_part", "outer_part"):
        if bearing.type not in BEARINGS:
            continue
        for shaft, side in ((inner, "inner"), (outer, "outer")):
            if shaft in shafts:
                place = bearing.number(f"u_coordinate_on_shaft_{side}_side") or 0.0
                found.append((bearing, place, side))
    return found


def _arms(at: float, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(1, u) of places along a shaft and of one more, in units of suitable size."""
    size = float(np.ptp(places))
    if size < 1e-9:
        return np.ones((len(places), 1)), np.ones(1)
    # About the middle of the bearings, in units of their distance: better numbers.
    middle = float(places.mean())
    arms = np.column_stack([np.ones(len(places)), (places - middle) / size])
    return arms, np.array([1.0, (at - middle) / size])


def _stiffness(bearing: Component, name: str, assumed: list[str]) -> float:
    found = bearing.number("radial_stiffness")
    if found is None or found <= 0.0:
        assumed.append(
            f"{name}: a bearing of its shaft gives no radial stiffness and is taken as rigid"
        )
        return STIFF
    return min(found, STIFF)


def _seen_from(at: float, stiffness: np.ndarray, places: np.ndarray) -> float | None:
    """Stiffness at a place [N/m]; None where all is rigid."""
    if stiffness.min() >= STIFF:
        return None
    _, compliance = _beam(at, stiffness, places)
    return 1.0 / compliance


def _beam(at: float, stiffness: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, float]:
    """What of a unit force at a place each bearing takes (n,), and the compliance there [m/N].

    With √k (1, u) = Q R and y = R⁻ᵀ (1, x)ᵀ they are √k Q y and yᵀ y. S = Rᵀ R itself would lose a
    bearing that is softer than another by the precision of numbers; with the stiff rows first, R
    does not.
    """
    arms, here = _arms(at, places)
    stiff_first = np.argsort(-stiffness, kind="stable")
    root = np.sqrt(stiffness[stiff_first])
    q, r = np.linalg.qr(root[:, None] * arms[stiff_first])
    y = solve_triangular(r.T, here, lower=True)
    parts = np.empty(len(stiffness))
    parts[stiff_first] = root * (q @ y)
    length = math.hypot(*y.tolist())
    return parts, length * length


def _offset(bearings: list[Component]) -> tuple[float, float, float]:
    """Mean of what bearings are out of place (3,) [m]."""
    total = np.zeros(3)
    for bearing in bearings:
        v, w = axes_of(bearing)
        total += (bearing.number("misalignment_in_v_direction") or 0.0) * v
        total += (bearing.number("misalignment_in_w_direction") or 0.0) * w
    x, y, z = (total / len(bearings)).tolist()
    return (x, y, z)
