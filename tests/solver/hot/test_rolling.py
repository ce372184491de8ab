"""The search moves floats along round walls on which they roll. Source: formulation, section 6."""

import math
from typing import Any

import numpy as np
import pytest

import loadshare as ls
from benchmarks.reference import reference
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.train import build_train

LAWS = {
    "s-p0": (0.0, 2.5e-8, 0.0),
    "p0-r": (0.0, 1e-7, 2.7e-7),
    "s-p1": (0.0, 1.4e-8, 0.0),
    "p1-r": (1.6e-6, 2.2e-8, 0.0),
    "s-p2": (8e-6, 2.3e-7, 1.3e-6),
    "p2-r": (0.0, 1e-6, 2e-8),
    "s-p3": (1.1e-5, 2.1e-8, 1.8e-7),
    "p3-r": (0.0, 1.1e-7, 2.6e-7),
}
"""Coefficients a, b and c of every mesh, for torques in N·m."""
BACKLASH = dict(zip(LAWS, (77, 141, 100, 236, 202, 78, 117, 127), strict=True))
"""Backlash of every mesh [µm]."""


def set_on_a_round_wall(torque: float) -> ls.Case:
    """Return a set whose carrier rolls in a rigid ring, with a force on its floating ring gear.

    The torque is light: the carrier rolls by 60 degrees from its first contact with the wall.
    """
    gears: dict[str, Any] = {
        "s": {"base_radius": "108 mm", "centre": ["0 mm", "0 mm"], "support": "rigid"},
        "r": {"type": "internal", "base_radius": "310 mm", "centre": ["0 mm", "0 mm"]},
        "c": {"type": "carrier", "centre": ["0 mm", "0 mm"], "held": True, "support": "free"},
    }
    gears["r"]["support"] = "free"
    supports = "free", "1.25e9 N/m", "free", "1.23e9 N/m"
    for k, (angle, support) in enumerate(zip((241.0, -27.0, 65.3, 150.9), supports, strict=True)):
        gears[f"p{k}"] = {
            "base_radius": "101 mm",
            "carrier": "c",
            "support": support,
            "centre": [f"{222.64 * f(math.radians(angle)):.9f} mm" for f in (math.cos, math.sin)],
        }
    return ls.Case(
        {
            "operating": {
                "input": "r",
                "output": "s",
                "torque": f"{torque} N*m",
                "running": "clockwise",
                "forces": {"r": ["-485 N", "-33 N", "0 N"]},
            },
            "gears": gears,
            "meshes": {
                name: {
                    "backlash": f"{BACKLASH[name]} um",
                    "law": {
                        "a": f"{a} rad",
                        "b": f"{b} rad/(N*m)",
                        "c": f"{c} rad/(N*m)^(2/3)",
                    },
                }
                for name, (a, b, c) in LAWS.items()
            },
            "splines": {
                "p0": {
                    "bending_stiffness": "2.5e8 N/m",
                    "clearance": "22 um",
                    "friction_force": "3.9 N",
                }
            },
            "errors": {
                "p0": {"pin": {"radial": "-29 um", "tangential": "30 um"}},
                "p1": {"pin": {"radial": "20 um", "tangential": "-32 um"}},
                "r": {"installation": ["39 um", "38 um"]},
            },
            "bearings": {"p2": {"clearance": "2.6 um", "stiffness": "rigid"}},
            "rings": {
                "r": {"radius": "3.65 um", "stiffness": "1.3e9 N/m"},
                "c": {"radius": "29.7 um", "stiffness": "rigid"},
            },
        }
    )


@pytest.mark.parametrize("torque", [0.9, 1.0, 1.1, 1.26])
@pytest.mark.quick(1)
def test_a_carrier_that_has_far_to_roll_is_found(torque: float) -> None:
    train = build_train(set_on_a_round_wall(torque))
    machine = Machine(train)
    found = machine.answer(machine.situations([1]), 1e-9, engine_named("vectorised", 1))
    assert found.searched.all()
    assert found.passed.all()
    answer = found.equilibria.one(0, 1)
    exact = reference(train, 1, answer)
    forces = np.array([float(exact.force[name]) for name in answer.flank_force])
    assert list(answer.flank_force.values()) == pytest.approx(forces, abs=1e-9 * forces.max())
