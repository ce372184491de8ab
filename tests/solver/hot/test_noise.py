"""Without a torque, round-off in contacts does not count as force. Source: formulation, section 5.

Nor does a shaft that winds by a thousand turns add its round-off to the load sharing.
"""

import math
import tomllib
from typing import Any

import numpy as np
import pytest

import loadshare as ls
from benchmarks import families
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.train import build_train

FORCE, STIFFNESS, CLEARANCE, FRICTION = 1950.0, 1.38e8, 13.9e-6, 157.0
LAWS = {
    "s-p0": (1.1e-5, 2.6e-7),
    "q0-r": (2.5e-5, 9.3e-7),
    "s-p1": (0.0, 5.2e-8),
    "q1-r": (0.0, 3.8e-7),
    "s-p2": (0.0, 8.4e-6),
    "q2-r": (2.8e-5, 2e-8),
}
"""Coefficients a and c of every mesh, for torques in N·m."""


def unloaded_set(direction: float) -> ls.Case:
    """Return a stepped set without torque; a spline alone takes a force on its ring gear."""
    gears: dict[str, Any] = {
        "s": {"base_radius": "113 mm", "centre": ["0 mm", "0 mm"], "support": "free"},
        "r": {"type": "internal", "base_radius": "242 mm", "held": True, "support": "free"},
        "c": {"type": "carrier", "centre": ["0 mm", "0 mm"], "support": "1e8 N/m"},
    }
    gears["r"]["centre"] = gears["s"]["centre"]
    for k, (angle, support) in enumerate(((-5.25, "rigid"), (85.6, "free"), (175.5, "5e7 N/m"))):
        turned = math.radians(angle)
        at = [f"{200.0 * f(turned):.9f} mm" for f in (math.cos, math.sin)]
        pin = {"centre": at, "carrier": "c"}
        gears[f"p{k}"] = {"base_radius": "74.5 mm", "support": "free", **pin}
        gears[f"q{k}"] = {"base_radius": "54.5 mm", "support": support, **pin}
    shafts = enumerate(("rigid", "rigid", "4.4e6 N*m/rad"))
    push = [f"{FORCE * f(direction)} N" for f in (math.cos, math.sin)]
    return ls.Case(
        {
            "operating": {
                "input": "s",
                "output": "c",
                "torque": "0 N*m",
                "forces": {"r": [*push, "0 N"]},
            },
            "gears": gears,
            "meshes": {
                name: {
                    "law": {
                        "a": f"{a} rad",
                        "b": "0 rad/(N*m)",
                        "c": f"{c} rad/(N*m)^(2/3)",
                    }
                }
                for name, (a, c) in LAWS.items()
            },
            "shafts": {f"{k}": {"ends": [f"p{k}", f"q{k}"], "stiffness": v} for k, v in shafts},
            "rings": {"s": {"radius": "15.9 um", "stiffness": "rigid"}},
            "errors": {"q1": {"pin": {"radial": "28 um", "tangential": "-24 um"}}},
            "bearings": {"q1": {"clearance": "2.5 um", "stiffness": "rigid"}},
            "splines": {
                "r": {
                    "bending_stiffness": f"{STIFFNESS} N/m",
                    "clearance": f"{CLEARANCE} m",
                    "friction_force": f"{FRICTION} N",
                }
            },
        }
    )


@pytest.mark.parametrize("turn", range(12))
@pytest.mark.quick(2)
def test_a_set_without_torque_has_none(turn: int) -> None:
    direction = turn * math.pi / 6.0 + 0.1
    train = build_train(unloaded_set(direction))
    machine = Machine(train).at(1)
    found = machine.answer(machine.situations([1]), 1e-9, engine_named("vectorised", 1))
    assert found.passed.all()
    assert not found.equilibria.flank_force.any()
    moved = found.equilibria.displacement[0, list(train.gears).index("r"), :2]
    # It reaches the end of the clearance, and then the shaft of the spline bends.
    expected = CLEARANCE + (FORCE - FRICTION) / STIFFNESS
    assert np.hypot(*moved) == pytest.approx(expected, rel=1e-9)


def test_a_soft_shaft_between_two_splits_costs_no_digits() -> None:
    """It takes the whole load, so no self-stress includes it; the bound used to be 1e-10."""
    star, box = (
        tomllib.loads(case.to_toml())
        for case in (families.star(6), families.two_path("0.0012 rad"))
    )
    case = ls.Case(
        {
            "operating": {"input": "sun", "output": "out", "torque": "1 kN*m"},
            "gears": star["gears"] | box["gears"],
            "meshes": star["meshes"] | box["meshes"],
            "shafts": {**box["shafts"], "ring-in": {"stiffness": "1 N*m/rad"}},
        }
    )
    assert ls.solve(case, engine="vectorised").positions[0].certificate.proved < 1e-12
