"""A gear that friction pins is at its pin to the last digit, however strong the friction."""

import math

import numpy as np
import pytest

import loadshare as ls
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.train import build_train


def pinned(friction: str, torque: str) -> ls.Case:
    """Return a torque split over two misplaced idlers, one of them pinned by friction."""
    angle = f"{math.acos(0.22 / math.hypot(0.24, 0.15))!r} rad"
    centres = {"in": (0.0, 0.0), "a": (0.24, 0.15), "b": (0.24, -0.15), "out": (0.48, 0.0)}
    gears = {
        n: {"centre": [f"{x} m", f"{y} m"], "base_radius": "0.12 m" if n in "ab" else "0.1 m"}
        for n, (x, y) in centres.items()
    }
    meshes = {
        n: {"pressure_angle": angle, "stiffness": f"{k} N*m/rad"}
        for n, k in {"in-a": "3e6", "in-b": "2e6", "a-out": "4e6", "b-out": "4e6"}.items()
    }
    tight = {"clearance": "0 m", "stick_limit": "0 m", "friction_force": friction}
    loose = {"clearance": "1 um", "friction_force": "10 N"}
    return ls.Case(
        {
            "operating": {
                "input": "in",
                "output": "out",
                "running": "counter-clockwise",
                "torque": torque,
            },
            "gears": gears,
            "meshes": meshes,
            "splines": {
                "a": {"bending_stiffness": "1e8 N/m", **tight},
                "b": {"bending_stiffness": "1e7 N/m", **loose},
            },
            "errors": {"a": {"installation": ["10 um", "7 um"]}},
        }
    )


@pytest.mark.parametrize("friction", ["1e6 N", "1e12 N"])
@pytest.mark.parametrize("torque", ["1 N*m", "1000 N*m"])
@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
def test_slip_by_rounding_does_no_work(friction: str, torque: str, engine: str) -> None:
    train = build_train(pinned(friction, torque))
    machine = Machine(train)
    found = machine.answer(machine.situations([1]), 1e-9, engine_named(engine, 1))
    assert found.passed[0]
    assert np.array_equal(found.equilibria.displacement[0, list(train.gears).index("a")], [0, 0, 0])
