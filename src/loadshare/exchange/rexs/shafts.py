"""Torsion of a REXS shaft between two places, from its sections."""

from __future__ import annotations

import math

from loadshare.exchange.rexs.gearing import Gearing
from loadshare.exchange.rexs.model import Component, Model

STEEL = 79.3e9
"""Shear modulus of steel [Pa]."""
PARTS = 16
"""Parts into which a section is cut, for sections that taper."""


def torsion_between(of: Gearing, shaft: Component, start: float, stop: float) -> float | None:
    """Return the torsional stiffness [N·m/rad] between two places along a shaft [m].

    1/K = ∫ du / (G I_p) with I_p = π (D⁴ − d⁴)/32. None where sections do not cover the way.
    """
    covered, yields = 0.0, 0.0
    for section in of.sections(shaft):
        at, length = section.number("u_coordinate_on_shaft"), section.number("length")
        if at is None or not length or length < 0.0:
            continue
        low, high = max(at, start), min(at + length, stop)
        if high <= low:
            continue
        covered += high - low
        step = (high - low) / PARTS
        for k in range(PARTS):
            part = (low + (k + 0.5) * step - at) / length
            polar = math.pi / 32.0 * (_outer(section, part) - _inner(section, part))
            if polar <= 0.0:
                return None
            yields += step / (_shear_modulus(of.model, shaft) * polar)
    if covered < (stop - start) * (1.0 - 1e-6) or yields <= 0.0:
        return None
    return 1.0 / yields


def _outer(section: Component, part: float) -> float:
    """Fourth power of the outer diameter at a part of a section's length."""
    begin, end = (section.number(f"outer_diameter_{which}") or 0.0 for which in ("begin", "end"))
    return float((begin + part * (end - begin)) ** 4)


def _inner(section: Component, part: float) -> float:
    begin, end = (section.number(f"inner_diameter_{which}") or 0.0 for which in ("begin", "end"))
    return float((begin + part * (end - begin)) ** 4)


def _shear_modulus(model: Model, shaft: Component) -> float:
    for origin, material in model.related("reference", "origin", "referenced"):
        if origin is shaft and material.type == "material":
            shear, young = material.number("shear_modulus"), material.number("elastic_modulus")
            poisson = material.number("poisson_ratio")
            if shear and shear > 0.0:
                return shear
            if young and young > 0.0 and poisson is not None and poisson > -1.0:
                return young / (2.0 * (1.0 + poisson))
    return STEEL
