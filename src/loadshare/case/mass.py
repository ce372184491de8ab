"""Mass and polar inertia of gears, as given or else from teeth and dimensions."""

from __future__ import annotations

import math
from collections.abc import Iterator

from loadshare.case.gears import Gear

STEEL = 7850.0
"""Density where none is given [kg/m³]."""


def mass_of(gear: Gear) -> float | None:
    """Return the mass of a gear [kg]; None if it is not given and does not follow.

    A gear is taken as rings of its face width: an external gear from its bore to its reference
    circle, an internal one from its reference circle to the outside of its body. With a thin web,
    only the rim has the face width; the web has its own thickness. Teeth above the reference circle
    fill the spaces below it, except for profile shift and root clearance; hubs, shafts and holes
    are neglected.

    Parameters
    ----------
    gear : Gear
    """
    if gear.mass is not None:
        return gear.mass.si
    rings = list(_rings(gear))
    return math.fsum(mass for mass, _, _ in rings) if rings else None


def inertia_of(gear: Gear) -> float | None:
    """Return the polar moment of inertia of a gear [kg m²]; None if its teeth do not give it.

    It is that of the rings of `mass_of`; a given mass is distributed as in these.

    Parameters
    ----------
    gear : Gear
    """
    rings = list(_rings(gear))
    if not rings:
        return None
    inertia = math.fsum(0.5 * mass * (inner**2 + outer**2) for mass, inner, outer in rings)
    if gear.mass is not None:
        inertia *= gear.mass.si / math.fsum(mass for mass, _, _ in rings)
    return inertia


def _rings(gear: Gear) -> Iterator[tuple[float, float, float]]:
    """Yield mass [kg], inner and outer radius [m] of the rings that make up a gear."""
    tooth = gear.tooth
    if tooth is None or gear.face_width is None:
        return
    density = gear.density.si if gear.density is not None else STEEL

    def ring(inner: float, outer: float, width: float) -> tuple[float, float, float]:
        return math.pi * (outer**2 - inner**2) * width * density, inner, outer

    width, rim = gear.face_width.si, gear.rim_depth
    if tooth.internal:
        if rim is not None:
            yield ring(tooth.radius, tooth.root + rim, width)
        return
    bore = gear.bore.si / 2.0 if gear.bore is not None else 0.0
    below = max(tooth.root - rim, bore) if rim is not None else bore
    if gear.web is None or below == bore:
        yield ring(bore, tooth.radius, width)
        return
    yield ring(below, tooth.radius, width)
    yield ring(bore, below, min(gear.web.si, width))
