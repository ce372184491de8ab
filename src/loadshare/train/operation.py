"""The operating point that a case gives a train: input and output, loads, forces, stages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from loadshare import case as spec
from loadshare.train.elements import Stage
from loadshare.train.gear import Gear, Vector
from loadshare.train.offset import vector_of


def stages_of(case: spec.Case) -> tuple[Stage, ...]:
    """Return the stages with their groups of meshes; a stage without groups is one group."""
    groups = {name: s.groups or (s.meshes,) for name, s in case.stages.items()}
    return tuple(Stage(n, tuple(s.meshes), tuple(groups[n])) for n, s in case.stages.items())


def operation_of(case: spec.Case, gears: Mapping[str, Gear]) -> dict[str, Any]:
    """Return input and output, torques and positions of a train, by its attributes."""
    operating, march = case.operating, case.march
    return {
        "input": operating.input,
        "output": operating.output,
        "input_torque": operating.input_torque,
        # A member of a planetary set may turn against the sense in which its rotation is counted.
        "external": {
            n: -t.si if gears[n].ratio < 0.0 else t.si for n, t in operating.external.items()
        },
        "positions": operating.positions,
        "rotating": operating.rotation == "teeth",
        "march": march and (march.gear, march.revolutions, march.steps),
    }


def forces_of(case: spec.Case) -> dict[str, Vector]:
    """Return external forces and weights, by gear."""
    operating = case.operating
    forces = {name: vector_of(force) for name, force in operating.forces.items()}
    if operating.gravity is not None:
        pulls = vector_of(operating.gravity)
        for name, gear in case.gears.items():
            weight = np.multiply.outer(spec.mass_of(gear) or 0.0, pulls)
            forces[name] = forces[name] + weight if name in forces else weight
    return forces
