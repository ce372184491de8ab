"""Machines, and samples of them that open and close contacts, for the tests of the fast method."""

from collections.abc import Callable, Mapping

import numpy as np
from tests.support import coasting, loaded, lost_contact, round_ring, shipped

import loadshare as ls
from benchmarks import families

ERRORS: dict[str, tuple[float, float]] = {
    "errors.6.installation[0] [um]": (-80.0, 80.0),
    "errors.6.installation[1] [um]": (-80.0, 120.0),
    "errors.9.installation[1] [um]": (-120.0, 80.0),
}
SUN = {
    "errors.planet1.installation.amount [um]": (0.0, 60.0),
    "errors.planet1.installation.direction [deg]": (0.0, 360.0),
}


def placed(case: ls.Case) -> ls.Case:
    """Return the seed's transmission with installation errors given by components."""
    return case.replace(
        {"errors.6.installation": ["0 um", "100 um"], "errors.9.installation": ["0 um", "-100 um"]}
    )


def starred(case: ls.Case) -> ls.Case:
    """Return a star whose first planet has an error that can be varied."""
    return case.replace({"errors.planet1.installation": {"amount": "1 um", "direction": "0 deg"}})


def tabled() -> ls.Case:
    """Return a star of three with tabulated laws on the sun's meshes."""
    case = starred(families.star(3))
    table = {
        "torque": ["30 N*m", "90 N*m", "400 N*m"],
        "deflection": ["40 urad", "90 urad", "1 mrad"],
    }
    suns = [m for m in case.meshes if "sun" in m]
    changes = {}
    for mesh in suns:
        changes |= {f'meshes."{mesh}".stiffness': None, f'meshes."{mesh}".table': table}
    return case.replace(changes)


ROLLERS = {"diameter": "50 mm", "rolling": {"rollers": 14, "length": "12 mm"}}


def planets_in_bearings(**law: object) -> ls.Case:
    """Return three planets in bearings with clearance and any law, one on a misplaced pin."""
    at_origin = {"centre": ["0 mm", "0 mm"]}
    return ls.Case(
        {
            "operating": {
                "input": "sun",
                "output": "carrier",
                "torque": "1 kN*m",
                "positions": 3,
            },
            "gears": {
                "sun": {"teeth": 18, "module": "5 mm", **at_origin},
                "ring": {
                    "type": "internal",
                    "teeth": 90,
                    "module": "5 mm",
                    "held": True,
                    **at_origin,
                },
                "carrier": {"type": "carrier", **at_origin},
                "planet": {
                    "copies": 3,
                    "carrier": "carrier",
                    "teeth": 36,
                    "module": "5 mm",
                    "centre": {"angle": "90 deg"},
                },
            },
            "meshes": {
                "sun-planet": {"stiffness": "2e6 N*m/rad", "backlash": "100 um"},
                "planet-ring": {"stiffness": "2e6 N*m/rad", "backlash": "110 um"},
            },
            "errors": {
                "planet2": {
                    "pin": {"tangential": "30 um", "radial": "5 um"},
                    "eccentricity": {"amount": "8 um", "direction": "0 deg"},
                }
            },
            "rings": {"sun": {"radius": "40 um", "stiffness": "5e8 N/m"}},
            "bearings": {"planet": {"clearance": "15 um", **law}},
        }
    )


VARIED: dict[str, tuple[Callable[[], ls.Case], Mapping[str, tuple[float, float]]]] = {
    "errors": (lambda: placed(loaded(shipped("fgfbstts/both_errors"), "900 N*m")), ERRORS),
    "coast flanks": (
        lambda: placed(coasting()),
        {**ERRORS, "operating.torque [N*m]": (0.0, 100.0)},
    ),
    "drums": (
        lambda: shipped("fgfbstts/limit_ring"),
        {**ERRORS, "rings.4.float [um]": (0.0, 9.0), "rings.5.float [um]": (0.0, 9.0)},
    ),
    "splines": (
        lambda: placed(shipped("fgfbstts/spline_clearance")),
        {**ERRORS, "splines.4.clearance [um]": (0.0, 20.0), "splines.5.friction": (0.0, 0.3)},
    ),
    "every element": (
        lambda: shipped("fgfbstts/all_elements"),
        {
            "errors.6.installation[1] [um]": (-80.0, 120.0),
            "errors.1.installation.amount [um]": (0.0, 80.0),
            "rings.5.float.up [um]": (0.0, 9.0),
            "splines.4.clearance [um]": (0.0, 60.0),
            "operating.power [kW]": (10.0, 2000.0),
        },
    ),
    "round ring": (
        lambda: starred(round_ring()),
        {**SUN, "rings.sun.radius [um]": (0.0, 9.0)},
    ),
    "elastic round ring": (
        lambda: starred(round_ring("5e8 N/m")),
        {**SUN, "rings.sun.radius [um]": (0.0, 9.0)},
    ),
    "lost contact": (
        lambda: starred(lost_contact()),
        {**SUN, "operating.torque [N*m]": (1.0, 900.0)},
    ),
    "tables": (tabled, SUN),
}
"""Keys that are varied, and their limits."""


def varied(name: str, count: int, seed: int = 0) -> tuple[ls.Case, dict[str, np.ndarray]]:
    """Return a case and a table of random samples."""
    make, ranges = VARIED[name]
    rng = np.random.default_rng(seed)
    return make(), {key: rng.uniform(low, high, count) for key, (low, high) in ranges.items()}
