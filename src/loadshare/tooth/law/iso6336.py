"""Mesh stiffness of a cylindrical pair by the formulas of ISO 6336-1, method B.

It is the stiffness measured on steel teeth under 100 N/mm of face width and more.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from loadshare.involute import contact_ratio
from loadshare.settings import TEETH

if TYPE_CHECKING:
    from loadshare.case import Gear

SHIFTS = (-0.5, 2.0)
"""Least and largest x1 + x2 to which the standard's series was fitted."""
MEASURED = 0.8
"""C_M of the standard."""
LEAST_RATIO = 1.2
"""Transverse contact ratio from which the standard's mesh stiffness holds for spur gears [-]."""
LEAST_LOAD = 100e3
"""Tangential force per face width below which the standard's c' falls [N/m]."""


@dataclass(frozen=True)
class FormulaStiffness:
    """Stiffness per unit of face width [N/m per m = Pa].

    1 N/(mm·µm) is 1e9 Pa.

    Parameters
    ----------
    virtual_teeth : tuple of two floats
        z_n of both gears.
    theoretical : float
        c'_th of one pair of teeth.
    single : float
        c' of one pair of teeth.
    mesh : float
        c_γα, mean of the mesh.
    lead : float
        c_γβ, for the distribution over the face width.
    """

    virtual_teeth: tuple[float, float]
    theoretical: float
    single: float
    mesh: float
    lead: float


def formula_stiffness(
    teeth: tuple[float, float],
    *,
    profile_shift: tuple[float, float],
    dedendum: tuple[float, float],
    contact_ratio: float,
    pressure_angle: float = math.radians(20.0),
    helix_angle: float = 0.0,
    blank_factor: float = 1.0,
    measured_factor: float = MEASURED,
) -> FormulaStiffness:
    """Return the stiffness of a steel pair by formula.

    q' is the flexibility of a pair of discs fitted by the standard's series, c'_th = 1/q',
    c' = C_M c'_th C_R C_B cos β, c_γα = c' (0.75 ε_α + 0.25), c_γβ = 0.85 c_γα.
    Source: ISO 6336-1; example 1 of ISO/TR 6336-30.

    Parameters
    ----------
    teeth : tuple of two floats
        z1, z2, the pinion's first; infinite for an internal gear.
    profile_shift : tuple of two floats
        x1, x2, from −0.5 to 2 in sum.
    dedendum : tuple of two floats
        h_fP of both basic racks in modules; their mean is used.
    contact_ratio : float
        Transverse contact ratio ε_α; the mesh formula holds from `LEAST_RATIO` for spur gears.
    pressure_angle, helix_angle : float
        α_n and β [rad].
    blank_factor : float
        C_R, 1 for a solid disc.
    measured_factor : float
        C_M, by which measured teeth are softer than calculated ones.

    Raises
    ------
    ValueError
        If a value is outside what the formulas were fitted to.
    """
    low, high = SHIFTS
    if not low - TEETH.rounding <= sum(profile_shift) <= high + TEETH.rounding:
        raise ValueError(
            f"x1 + x2 = {sum(profile_shift):.10g}: the formula holds for −0.5 ≤ x1 + x2 ≤ 2"
        )
    if min(teeth) < 1 or contact_ratio <= 0.0 or abs(helix_angle) >= 0.5 * math.pi:
        raise ValueError(
            f"teeth {teeth}, ε_α = {contact_ratio:.4g}, β = {helix_angle:.4g} rad: "
            "give positive teeth and contact ratio, and a helix angle below 90°"
        )
    base_helix = math.asin(math.sin(helix_angle) * math.cos(pressure_angle))
    z1, z2 = (z / (math.cos(base_helix) ** 2 * math.cos(helix_angle)) for z in teeth)
    x1, x2 = profile_shift
    flexibility = (
        0.04723
        + 0.15551 / z1
        + 0.25791 / z2
        - 0.00635 * x1
        - 0.11654 * x1 / z1
        - 0.00193 * x2
        - 0.24188 * x2 / z2
        + 0.00529 * x1**2
        + 0.00182 * x2**2
    )
    theoretical = 1e9 / flexibility
    depth = 0.5 * sum(dedendum)
    angle = 20.0 - math.degrees(pressure_angle)
    rack_factor = (1.0 + 0.5 * (1.2 - depth)) * (1.0 - 0.02 * angle)
    single = measured_factor * theoretical * blank_factor * rack_factor * math.cos(helix_angle)
    mesh = single * (0.75 * contact_ratio + 0.25)
    return FormulaStiffness((z1, z2), theoretical, single, mesh, 0.85 * mesh)


def blank_factor(web: float, rim: float) -> float:
    """Return C_R of a gear with a thin web: 1 + ln(b_s/b) / (5 e^(s_R/5m_n)).

    Parameters
    ----------
    web : float
        Thickness of the web over the face width, limited to 0.2 to 1.2.
    rim : float
        Thickness of the rim in modules; less than 1 counts as 1.
    """
    web, rim = min(max(web, 0.2), 1.2), max(rim, 1.0)
    return 1.0 + math.log(web) / (5.0 * math.exp(rim / 5.0))


def basis_of(gears: tuple[Gear, Gear], distance: float, *, measured: bool) -> str:
    """Say which of the standard's factors a mesh's stiffness includes, and if it is out of range.

    Parameters
    ----------
    gears, distance, measured
        As for `mesh_stiffness`.
    """
    (one, width), (two, other) = (gear.teeth_and_width for gear in gears)
    blank = 0.5 * sum(_blank(gear, min(width, other)) for gear in gears)
    with_measured = "with" if measured else "without"
    body = "solid bodies" if blank == 1.0 else f"C_R {blank:.3g} for thin webs"
    basis = f"ISO 6336-1 method B, {with_measured} C_M, {body}"
    ratio = contact_ratio(one, two, distance)
    if ratio < LEAST_RATIO and one.helix_angle == 0.0:
        return f"{basis}; for spur gears it holds from ε_α = {LEAST_RATIO:g}, here {ratio:.3g}"
    return basis


def least_torque(gears: tuple[Gear, Gear]) -> float:
    """Return the torque on a mesh's first gear from which the standard's stiffness holds [N·m].

    Below F_t K_A/b = 100 N/mm the standard's c' falls in proportion to the load. As a law of a mesh
    that would be a deflection independent of the load or, as a tangent, an unbounded one: no law
    for an equilibrium. K_A counts as 1.

    Source: ISO 6336-1, single stiffness c'.
    """
    (first, width), (_, other) = (gear.teeth_and_width for gear in gears)
    return LEAST_LOAD * min(width, other) * first.radius


def mesh_stiffness(gears: tuple[Gear, Gear], distance: float, *, measured: bool = True) -> float:
    """Return the stiffness of a mesh of two gears along its line of action, c_γα b [N/m].

    Parameters
    ----------
    gears : tuple of two Gear
        Cylindrical gears with teeth and face width.
    distance : float
        Centre distance [m].
    measured : bool
        Whether C_M is applied.

    Raises
    ------
    ValueError
        If a value is outside what the formulas were fitted to.
    """
    # The formula's first gear is the one with fewer teeth; it treats an internal gear as a rack.
    pair = sorted(gears, key=_as_pinion)
    (one, width), (two, other) = (gear.teeth_and_width for gear in pair)
    width = min(width, other)
    ratio = contact_ratio(one, two, distance)
    if ratio < 1.0:
        raise ValueError(
            f"ε_α = {ratio:.4g}: each pair of teeth must meet before the previous one parts"
        )
    found = formula_stiffness(
        (one.teeth, math.inf if two.internal else two.teeth),
        profile_shift=(one.profile_shift, two.profile_shift),
        dedendum=(one.dedendum, two.dedendum),
        contact_ratio=ratio,
        pressure_angle=one.pressure_angle,
        helix_angle=one.helix_angle,
        blank_factor=0.5 * sum(_blank(gear, width) for gear in pair),
        measured_factor=MEASURED if measured else 1.0,
    )
    return found.mesh * width


def _as_pinion(gear: Gear) -> tuple[bool, int, float]:
    """Return a sort key: the pinion first; of equal teeth, the gear with the larger shift."""
    return gear.type == "internal", gear.teeth or 0, -(gear.profile_shift or 0.0)


def _blank(gear: Gear, width: float) -> float:
    if gear.web is None or gear.rim is None or gear.module is None:
        return 1.0
    return blank_factor(gear.web.si / width, gear.rim.si / gear.module.si)
