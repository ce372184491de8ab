"""What an engineer sizes by: forces of meshes, torques of shafts, what bearings and mounts take."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.residuals import pushed_by_rings
from loadshare.certify.state import ClaimedState
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of
from loadshare.train.train import Train

Pair = tuple[float, float]
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Loads:
    """The loads of one answer.

    Attributes
    ----------
    train : Train
    answer : Equilibrium
    """

    train: Train
    answer: Equilibrium

    @cached_property
    def _state(self) -> ClaimedState:
        here = situation_of(self.train, self.answer.index)
        return ClaimedState(mechanics_of(self.train), here, Equilibria.of(self.train, self.answer))

    @cached_property
    def meshes(self) -> dict[str, float]:
        """Force of every mesh along its line of action, drive flank less coast flank [N]."""
        force = self.answer.flank_force
        return {
            name: float(sum(force[m.flank_name(d)] * (1.0 if d else -1.0) for d in m.flanks))
            for name, m in self.train.meshes.items()
        }

    @cached_property
    def shafts(self) -> dict[str, float]:
        """Torque of every shaft from its first gear to its second [N·m], of rigid ones as well."""
        torques = self._state.torque[:, 0].tolist() if self.train.shafts else ()
        return dict(zip(self.train.shafts, torques, strict=True))

    @cached_property
    def gears(self) -> dict[str, float]:
        """Torque from outside on every gear [N·m], counter-clockwise about its axis.

        Loads; and on the output and on held gears what balances all others.
        """
        of, state = self._state.of, self._state
        torque = np.broadcast_to(state.here.torque, (len(of.order), 1))[:, 0].copy()
        for group in of.groups:
            for held in (gear for gear in group if gear in of.held):
                torque[held] -= state.moment[group, 0].sum()
        return {
            name: gear.sense * float(value) + 0.0
            for (name, gear), value in zip(self.train.gears.items(), torque, strict=True)
            if gear.rim_of is None
        }

    @cached_property
    def bearings(self) -> dict[str, Pair]:
        """Force of every gear on its bearing, of a planet on its pin [N], in its frame.

        Supports and bearings with clearance together; those of splines and rings stand apart.
        """
        of, state = self._state.of, self._state
        pushing = of.pushing.reshape(-1, len(of.order), 3)
        pushed = -np.einsum("egk,e->gk", pushing, state.claim.flank_force[:, 0])
        pushed += pushed_by_rings(state)[:, :, 0]
        if state.pushed is not None:
            pushed += state.pushed[1][:, :, 0]
        found = {}
        for k, (name, gear) in enumerate(self.train.gears.items()):
            if gear.rim_of is not None:
                continue
            own = (
                gear.plane @ pushed[k]
                if gear.support is None
                else gear.told(state.claim.support_force[k, :, 0])
            )
            bearing = self.train.bearings.get(name)
            if bearing is not None:
                own = own - gear.plane @ state.reaction[of.pulls.index(bearing.name), :, 0]
            found[name] = (float(own[0]), float(own[1]))
        return found
