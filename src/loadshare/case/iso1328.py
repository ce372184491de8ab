"""Tolerances of teeth by flank tolerance class, ISO 1328-1:2013."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from loadshare.case.gears import Gear

RANGES = {
    "teeth": (5, 1000, ""),
    "reference diameter": (5.0, 15000.0, " mm"),
    "module": (0.5, 70.0, " mm"),
    "face width": (4.0, 1200.0, " mm"),
    "helix angle": (0.0, 45.0, " deg"),
}
"""Ranges for which the standard holds."""


@dataclass(frozen=True, slots=True)
class FlankTolerances:
    """Tolerances of a gear's teeth [m], unrounded.

    Attributes
    ----------
    single_pitch, cumulative_pitch : float
        f_pT and F_pT.
    profile_slope, profile_form, profile : float
        f_HαT, f_fαT and F_αT.
    helix_slope, helix_form, helix : float or None
        f_HβT, f_fβT and F_βT; None without a face width.
    runout : float
        F_rT, twice the largest eccentricity.
    """

    single_pitch: float
    cumulative_pitch: float
    profile_slope: float
    profile_form: float
    profile: float
    helix_slope: float | None
    helix_form: float | None
    helix: float | None
    runout: float


def tolerances_of(gear: Gear) -> FlankTolerances | None:
    """Return the tolerances of a gear's teeth; None if no class or no teeth are given.

    The formulas are those of section 5.3, with lengths in mm and tolerances in µm, for class 5;
    each class is wider than the one before by a factor of √2.

    Parameters
    ----------
    gear : Gear
    """
    tooth = gear.tooth
    if tooth is None or gear.tolerance_class is None:
        return None
    d, m = 2e3 * tooth.radius, 1e3 * tooth.module
    scale = 1e-6 * math.sqrt(2.0) ** (gear.tolerance_class - 5)
    cumulative = scale * (0.002 * d + 0.55 * math.sqrt(d) + 0.7 * m + 12.0)
    profile = scale * (0.4 * m + 0.001 * d + 4.0), scale * (0.55 * m + 5.0)
    helix: tuple[float | None, float | None, float | None] = (None, None, None)
    if gear.face_width is not None:
        b = 1e3 * gear.face_width.si
        slope = scale * (0.05 * math.sqrt(d) + 0.35 * math.sqrt(b) + 4.0)
        form = scale * (0.07 * math.sqrt(d) + 0.45 * math.sqrt(b) + 4.0)
        helix = slope, form, math.hypot(slope, form)
    return FlankTolerances(
        single_pitch=scale * (0.001 * d + 0.4 * m + 5.0),
        cumulative_pitch=cumulative,
        profile_slope=profile[0],
        profile_form=profile[1],
        profile=math.hypot(*profile),
        helix_slope=helix[0],
        helix_form=helix[1],
        helix=helix[2],
        runout=0.9 * cumulative,
    )


def outside(gear: Gear) -> Iterator[str]:
    """Yield, in words, each property of a gear's teeth for which the standard does not hold."""
    tooth = gear.tooth
    if tooth is None:
        return
    found = {
        "teeth": tooth.teeth,
        "reference diameter": 2e3 * tooth.radius,
        "module": 1e3 * tooth.module,
        "helix angle": math.degrees(abs(tooth.helix_angle)),
    }
    if gear.face_width is not None:
        found["face width"] = 1e3 * gear.face_width.si
    for name, value in found.items():
        low, high, unit = RANGES[name]
        if not low <= value <= high:
            yield f"a {name} of {value:.6g}{unit}: ISO 1328-1 holds for {low:g} to {high:g}{unit}"
