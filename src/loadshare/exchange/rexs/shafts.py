"""Torsion of a REXS shaft between two places, from its sections."""

from __future__ import annotations

import math
from typing import NamedTuple

from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.model import Component, Model

STEEL = 79.3e9
"""Shear modulus of steel [Pa]."""
POISSON = 0.3
PARTS = 16
"""Parts into which a section is cut, for sections that taper."""
SLACK = 1e-6
"""Overlap or gap of sections that counts as none [m]."""


class Twist(NamedTuple):
    """Torsional compliance between two places on a shaft [rad/(N·m)], and what was assumed."""

    compliance: float
    assumed: str = ""


def twist_between(of: Gearing, shaft: Component, start: float, stop: float) -> Twist:
    """Return how far a shaft twists between two places along it [m].

    ∫ du / (G I_p) with I_p = π (D⁴ − d⁴)/32. The shaft is rigid if its sections do not cover the
    way, or if they overlap, because it is then unclear which of them is the shaft.
    """
    reached, yields, notes = start, 0.0, set[str]()
    for at, length, section in _in_order(of, shaft):
        low, high = max(at, start), min(at + length, stop)
        if high <= low:
            continue
        if low > reached + SLACK:
            break
        if low < reached - SLACK:
            return Twist(0.0, "rigid, as its sections overlap")
        shear, assumed = _shear_modulus(of.model, section, shaft)
        outer, inner = _diameters(section, "outer", notes), _diameters(section, "inner", notes)
        notes.add(assumed)
        step = (high - low) / PARTS
        for k in range(PARTS):
            part = (low + (k + 0.5) * step - at) / length
            polar = math.pi / 32.0 * (_between(outer, part) ** 4 - _between(inner, part) ** 4)
            if polar <= 0.0:
                return Twist(0.0, "rigid, as a section has no diameter, or a bore as large")
            yields += step / (shear * polar)
        reached = high
    if reached < stop - SLACK or yields <= 0.0:
        return Twist(0.0, "rigid, as its sections do not cover it")
    return Twist(yields, "; ".join(sorted(notes - {""})))


def _in_order(of: Gearing, shaft: Component) -> list[tuple[float, float, Component]]:
    """Return the sections of a shaft in order, each with its beginning and length [m]."""
    found = [
        (at, length, section)
        for section in of.sections(shaft)
        if (at := section.number("u_coordinate_on_shaft")) is not None
        and (length := section.number("length") or 0.0) > 0.0
    ]
    return sorted(found, key=lambda each: each[:2])


def _diameters(section: Component, side: str, notes: set[str]) -> tuple[float, float]:
    """Return the diameters of a section at its ends [m]; note if one is not given."""
    begin, end = (section.number(f"{side}_diameter_{which}") for which in ("begin", "end"))
    if begin is None and end is None:
        if side == "inner":
            notes.add("solid, as no bore is given")
        return 0.0, 0.0
    if begin is None or end is None:
        notes.add(f"the {side} diameter of a section is that of the one end that is given")
    known = [value for value in (begin, end) if value is not None]
    return known[0], known[-1]


def _between(ends: tuple[float, float], part: float) -> float:
    return ends[0] + part * (ends[1] - ends[0])


def _shear_modulus(model: Model, section: Component, shaft: Component) -> tuple[float, str]:
    """Return the shear modulus of a section [Pa], and what was assumed for it."""
    material = material_of(model, section) or material_of(model, shaft)
    if material is None:
        return STEEL, "steel, G = 79.3 GPa, as no material is given"
    shear, young = material.number("shear_modulus"), material.number("elastic_modulus")
    poisson = material.number("poisson_ratio")
    if shear and shear > 0.0:
        return shear, ""
    if not young or young <= 0.0:
        return STEEL, "steel, G = 79.3 GPa, as its material gives no modulus"
    if poisson is not None and poisson > -1.0:
        return young / (2.0 * (1.0 + poisson)), ""
    return young / (2.0 * (1.0 + POISSON)), "its material gives no Poisson's ratio; 0.3 is assumed"


def material_of(model: Model, part: Component) -> Component | None:
    """Return the material of a shaft, a section or a gear, if it is given."""
    related = model.related("reference", "origin", "referenced")
    return next((m for origin, m in related if origin is part and m.type == "material"), None)
