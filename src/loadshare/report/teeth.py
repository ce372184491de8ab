"""Quantities that follow from teeth and dimensions, row by row, for the screen and the page."""

from __future__ import annotations

import math
from collections.abc import Iterator

from loadshare.case import Case, Gear
from loadshare.case.iso1328 import tolerances_of
from loadshare.case.line_of_action import centre_distance, facing
from loadshare.case.mass import inertia_of, mass_of
from loadshare.case.place import minus
from loadshare.involute import (
    contact_ratio,
    distance_without_backlash,
    normal_backlash,
    working_angle,
)
from loadshare.numbers import NONE, fixed, significant
from loadshare.table import Cell, Record, Table, table

WORDS = ("gear", "mesh", "shaft")
GEARS = ("gear", "x", "y", "z", "reference", "base", "tip", "root", "mass", "inertia")
MESHES = ("mesh", "distance", "tight", "α_wt", "β_b", "ε_α", "ε_β", "backlash")
TOLERANCES = {
    "single_pitch": "f_pT",
    "cumulative_pitch": "F_pT",
    "profile": "F_αT",
    "helix": "F_βT",
    "runout": "F_rT",
}
"""Columns of tolerances, by the attributes of `FlankTolerances`."""


def teeth_tables(case: Case) -> Iterator[Table]:
    """Yield tables of what follows from the teeth of gears and the dimensions of shafts.

    Parameters
    ----------
    case : Case
    """
    for title, fields, rows in (
        ("Gears: centre and radii [mm], mass [kg], polar inertia [kg·m²]", GEARS, _gears(case)),
        (
            "Meshes: centre distance, that without backlash (tight) [mm], working pressure and "
            "base helix angle [deg], contact ratios, normal backlash [µm]",
            MESHES,
            _meshes(case),
        ),
        (
            "Tolerances by ISO 1328-1 [µm]",
            ("gear", "class", *TOLERANCES.values()),
            _tolerances(case),
        ),
        ("Shafts: stiffness [N·m/rad]", ("shaft", "stiffness"), _shafts(case)),
    ):
        found = list(rows)
        if found:
            yield table(title, found, fields, WORDS)


def _gears(case: Case) -> Iterator[Record]:
    centres = case.centres()
    for name, gear in case.gears.items():
        tooth = gear.tooth
        if tooth is None:
            continue
        radii = {
            "reference": tooth.radius,
            "base": tooth.base_radius,
            "tip": tooth.tip,
            "root": tooth.root,
        }
        places = dict(zip("xyz", centres[name], strict=True))
        mass, inertia = mass_of(gear), inertia_of(gear)
        yield {
            "gear": Cell(name),
            **{key: Cell(fixed(1e3 * x, 4), x) for key, x in (places | radii).items()},
            "mass": Cell(NONE if mass is None else significant(mass), mass),
            "inertia": Cell(NONE if inertia is None else significant(inertia), inertia),
        }


def _meshes(case: Case) -> Iterator[Record]:
    centres = case.centres()
    for name, mesh in case.meshes.items():
        driver, driven = case.gears[mesh.driver], case.gears[mesh.driven]
        one, two = driver.tooth, driven.tooth
        if one is None or two is None:
            continue
        apart = centre_distance(driver, minus(centres[mesh.driven], centres[mesh.driver]))
        try:
            without = 1e3 * distance_without_backlash(one, two)
        except ValueError:
            without = None
        figures: dict[str, tuple[float | None, int]] = {
            "distance": (1e3 * apart, 4),
            "tight": (without, 4),
            "α_wt": (math.degrees(working_angle(one, two, apart)), 4),
            "β_b": (math.degrees(abs(one.base_helix_angle)), 4),
            "ε_α": (contact_ratio(one, two, apart), 3),
            "ε_β": (_overlap_ratio(*facing(mesh, case.gears, centres)), 3),
            "backlash": (1e6 * normal_backlash(one, two, apart), 1),
        }
        yield {"mesh": Cell(name)} | {
            key: Cell(fixed(value, places), value) for key, (value, places) in figures.items()
        }


def _overlap_ratio(driver: Gear, driven: Gear) -> float | None:
    """Return ε_β = b sin β/(π m_n), with the smaller face width."""
    tooth, widths = driver.tooth, (driver.face_width, driven.face_width)
    if tooth is None or widths[0] is None or widths[1] is None:
        return None
    width = min(widths[0].si, widths[1].si)
    return width * math.sin(abs(tooth.helix_angle)) / (math.pi * tooth.module)


def _tolerances(case: Case) -> Iterator[Record]:
    for gear_name, gear in case.gears.items():
        found = tolerances_of(gear)
        if found is None:
            continue
        lengths = {column: getattr(found, name) for name, column in TOLERANCES.items()}
        yield {
            "gear": Cell(gear_name),
            "class": Cell(str(gear.tolerance_class), gear.tolerance_class),
            **{k: Cell(fixed(x and 1e6 * x, 1), x) for k, x in lengths.items()},
        }


def _shafts(case: Case) -> Iterator[Record]:
    for name, shaft in case.shafts.items():
        if shaft.stiffness is None:
            stiffness = shaft.torsional_stiffness
            yield {"shaft": Cell(name), "stiffness": Cell(significant(stiffness, 5), stiffness)}
