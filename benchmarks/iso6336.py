"""Mesh stiffness of a cylindrical pair by the formulas of ISO 6336-1, method B."""

from __future__ import annotations

import math
from dataclasses import dataclass


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
    teeth: tuple[int, int],
    *,
    profile_shift: tuple[float, float],
    dedendum: tuple[float, float],
    contact_ratio: float,
    pressure_angle: float = math.radians(20.0),
    helix_angle: float = 0.0,
    blank_factor: float = 1.0,
) -> FormulaStiffness:
    """Stiffness of an external steel pair by formula.

    q' is the flexibility of a pair of discs fitted by the standard's series, c'_th = 1/q',
    c' = 0.8 c'_th C_R C_B cos β, c_γα = c' (0.75 ε_α + 0.25), c_γβ = 0.85 c_γα.
    Source: ISO 6336-1; example 1 of ISO/TR 6336-30.

    Parameters
    ----------
    teeth : tuple of two ints
        z1, z2.
    profile_shift : tuple of two floats
        x1, x2, from −0.5 to 2 in sum.
    dedendum : tuple of two floats
        h_fP of both basic racks in modules; their mean counts.
    contact_ratio : float
        Transverse contact ratio ε_α; the mesh formula holds from 1.2 for spur gears.
    pressure_angle, helix_angle : float
        α_n and β [rad].
    blank_factor : float
        C_R, 1 for a solid disc.

    Raises
    ------
    ValueError
        If a value is outside what the formulas were fitted to.
    """
    if not -0.5 <= sum(profile_shift) <= 2.0:
        raise ValueError(
            f"x1 + x2 = {sum(profile_shift):.4g}: the formula holds for −0.5 ≤ x1 + x2 ≤ 2"
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
    single = 0.8 * theoretical * blank_factor * rack_factor * math.cos(helix_angle)
    mesh = single * (0.75 * contact_ratio + 0.25)
    return FormulaStiffness((z1, z2), theoretical, single, mesh, 0.85 * mesh)
