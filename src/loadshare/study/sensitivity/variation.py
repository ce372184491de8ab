"""An input at a position: trains, scenes and certified answers as it varies.

Every mesh is held at the place of its cycle where it stands: a change of input that lets it pass to
the next place is a step of the answer, no derivative.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from loadshare.scene import assemble
from loadshare.scene.scene import Array, Scene
from loadshare.study.answers import certified
from loadshare.study.branch import ActiveSet, Branch
from loadshare.study.branch.system import BranchLost
from loadshare.study.differences import Derivative, differentiate
from loadshare.study.parameter import Value
from loadshare.train import Train
from loadshare.train.equilibrium import Equilibrium

BESIDE = 1e-6
"""Change of an input, relative to its value, within which a step of the answer is told."""


class Variation:
    """An input of a case, at one position.

    Parameters
    ----------
    trains : callable
        Train with a number, in the input's unit.
    value : Value
    position : int
        1-based.
    """

    def __init__(self, trains: Callable[[float], Train], value: Value, position: int) -> None:
        self._trains, self.value, self.position = trains, value, position
        self.cycle = trains(value.number).situation(position).mesh_position
        self._scene = lru_cache(maxsize=None)(self._assembled)
        self._changes: dict[tuple[ActiveSet, frozenset[str], bytes], Derivative] = {}

    def _number(self, amount: float) -> float:
        return self.value.number + amount / self.value.factor

    def _assembled(self, number: float) -> Scene:
        return assemble(held(self._trains(number), self.cycle), self.position)

    def scene(self, amount: float) -> Scene:
        """Return the scene with the input moved by an amount [SI]."""
        return self._scene(self._number(amount))

    def answer(self, amount: float) -> Equilibrium:
        """Return the certified equilibrium with the input moved by an amount [SI].

        Raises
        ------
        CaseError
            If the input cannot be there.
        Refused
            If there is no certified equilibrium.
        """
        return certified(self.scene(amount).train, self.position).equilibrium

    def change(self, branch: Branch, z: Array) -> Derivative:
        """Return the derivative of a branch's residual and torques at z, by the input.

        Raises
        ------
        CaseError
            If the input can be varied to neither side.
        """
        key = branch.active, branch.tied, z.tobytes()
        if key not in self._changes:

            def of(number: float) -> Array:
                there = Branch(self._scene(number), branch.active, branch.units, branch.tied)
                if there.size != branch.size:
                    raise BranchLost("a limit without play is another element than one with some")
                return np.concatenate([there.residual(z), torques(there, z)])

            rounding = np.concatenate([branch.rounding(z), torque_rounding(branch, z)])
            self._changes[key] = differentiate(of, self.value, rounding)
        return self._changes[key]

    def steps(self, sign: float, step: float) -> tuple[str, ...]:
        """Meshes that pass to another place of their cycle right beside the value."""
        least = min(step, BESIDE * max(abs(self.value.si), step))
        for amount in (step, least):
            there = self._trains(self._number(sign * amount)).situation(self.position)
            passing = tuple(m for m, k in there.mesh_position.items() if k != self.cycle[m])
            if not passing:
                return ()
        return passing


def held(train: Train, cycle: Mapping[str, int]) -> Train:
    """Return a train whose meshes have the laws and gaps of one place of their cycle only."""
    return replace(
        train,
        meshes={
            name: replace(mesh, laws=(mesh.law(cycle[name]),), gaps=(mesh.gap(cycle[name], True),))
            for name, mesh in train.meshes.items()
        },
    )


def torques(branch: Branch, z: Array) -> Array:
    """Torque of every mesh, drive flank less coast flank, as results tell it [N·m]."""
    contacts = branch.contacts(z)
    return np.array(
        [
            sum(mesh.lever(d) * contacts[mesh.flank_name(d)][0] for d in mesh.flanks)
            for mesh in branch.scene.train.meshes.values()
        ]
    )


def torque_gradients(branch: Branch, z: Array) -> Array:
    """Derivatives (meshes, size) of the torques with respect to z."""
    contacts = branch.contacts(z)
    found = np.zeros((len(branch.scene.train.meshes), branch.size))
    for row, mesh in zip(found, branch.scene.train.meshes.values(), strict=True):
        for drive in mesh.flanks:
            row += mesh.lever(drive) * contacts[mesh.flank_name(drive)][1]
    return found


def torque_rounding(branch: Branch, z: Array) -> Array:
    """Bound on the round-off of the torques [N·m]."""
    gradients = np.abs(torque_gradients(branch, z))
    size = np.abs(torques(branch, z)) + gradients @ np.abs(z)
    return np.asarray(8.0 * np.finfo(float).eps * size)


def torques_of(train: Train, found: Equilibrium) -> dict[str, float]:
    """Torque of every mesh of an equilibrium, drive flank less coast flank [N·m]."""
    return {
        name: sum(mesh.lever(d) * found.flank_force[mesh.flank_name(d)] for d in mesh.flanks)
        for name, mesh in train.meshes.items()
    }
