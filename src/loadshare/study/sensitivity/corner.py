"""One position of a train, ready to be differentiated by any input."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import lru_cache

import numpy as np

from loadshare.errors import CaseError
from loadshare.scene import assemble
from loadshare.scene.scene import Array, Scene
from loadshare.study.answers import certified
from loadshare.study.branch import Branch
from loadshare.study.branch.system import identified
from loadshare.study.differences import Derivative, differentiate
from loadshare.study.directional import ROUND_OFF, Motion, Neighbourhood
from loadshare.study.parameter import Value
from loadshare.study.sensitivity.result import SIDES, Rates
from loadshare.train import Train


class Corner:
    """One certified position, ready to be differentiated.

    Parameters
    ----------
    train : Train
    position : int
        1-based.

    Attributes
    ----------
    neighbourhood : Neighbourhood
    torque : dict of mesh to float
        On the driver [N·m].
    loose : ndarray of bool, shape (n,)
        Which coordinates the equilibrium leaves undetermined.

    Raises
    ------
    Refused
        If the position has no certified equilibrium.
    """

    def __init__(self, train: Train, position: int) -> None:
        self.train, self.position = train, position
        answer = certified(train, position)
        branch, z = identified(assemble(train, position), answer.equilibrium)
        self.neighbourhood = Neighbourhood(branch, z)
        self.torque = _torques(branch, z)
        self.loose = branch.loose(z)
        self._caught: dict[str, None] = {}

    @property
    def on_the_verge(self) -> tuple[str, ...]:
        """Elements for which the derivatives found so far hold to one side only."""
        return tuple(dict.fromkeys((*self.neighbourhood.verge, *self._caught)))

    def rates(
        self, trains: Callable[[float], Train], value: Value
    ) -> tuple[dict[str, Rates], float]:
        """Return the derivatives to both sides, and the relative error of those of the equations.

        Raises
        ------
        CaseError
            If the input can be varied to neither side.
        """
        scenes = lru_cache(maxsize=None)(lambda number: assemble(trains(number), self.position))
        derivatives: dict[object, Derivative] = {}

        def explicit(branch: Branch, z: Array) -> Derivative:
            if branch.active not in derivatives:

                def of(number: float) -> Array:
                    there = Branch(scenes(number), branch.active, branch.units)
                    return np.concatenate([there.residual(z), list(_torques(there, z).values())])

                derivatives[branch.active] = differentiate(of, value)
            return derivatives[branch.active]

        def shifted(amount: float) -> Scene:
            return scenes(value.number + amount / value.factor)

        found = {}
        here = self.neighbourhood
        both: Motion | None = None
        for side, sign in zip(SIDES, (-1.0, 1.0), strict=True):
            motion = both
            if motion is None:
                try:
                    motion = here.motion(sign, explicit, shifted)
                except CaseError:
                    if not derivatives:
                        raise
            able = next(iter(derivatives.values())).sides[sign > 0] if derivatives else False
            found[side] = self._told(motion if able else None, derivatives)
            caught = motion.caught if motion is not None else ()
            self._caught |= dict.fromkeys(caught)
            both = motion if not here.verge and not caught else None
        return found, max([0.0, *map(_error, derivatives.values())])

    def _told(self, motion: Motion | None, derivatives: dict[object, Derivative]) -> Rates:
        meshes, scene = self.train.meshes, self.neighbourhood.branch.scene
        moved = {
            g: np.full(2, np.nan) if g in scene.displacement else np.zeros(2)
            for g in self.train.gears
        }
        if motion is None:
            nothing = dict.fromkeys(meshes, np.nan)
            return Rates(nothing, dict(nothing), dict(nothing), moved)
        branch = motion.branch
        direct = derivatives[branch.active].value[branch.size :]
        contacts = branch.contacts(motion.z)
        torque = {}
        for (name, mesh), explicit in zip(meshes.items(), direct, strict=True):
            total = float(explicit)
            for drive in mesh.flanks:
                _, gradient = contacts[mesh.flank_name(drive)]
                total += mesh.lever(drive) * float(gradient @ motion.rate)
            torque[name] = total
        for gear, where in scene.displacement.items():
            rate = motion.rate[where] * branch.units.length
            moved[gear] = np.where(self.loose[where], np.nan, rate)
        stages = self.train.stages
        return Rates(
            torque,
            _share_rates(self.torque, torque, [s.meshes for s in stages], meshes),
            _share_rates(self.torque, torque, [g for s in stages for g in s.groups], meshes),
            moved,
        )


def _error(derivative: Derivative) -> float:
    """Relative error of a derivative; 0 where its input does not move the equations."""
    size = float(np.abs(derivative.value).max(initial=0.0))
    if not size * derivative.step > ROUND_OFF:
        return 0.0
    return float(derivative.error.max(initial=0.0)) / size


def _torques(branch: Branch, z: Array) -> dict[str, float]:
    """Torque on the driver of every mesh, drive flank less coast flank [N·m]."""
    contacts = branch.contacts(z)
    return {
        name: sum(mesh.lever(d) * contacts[mesh.flank_name(d)][0] for d in mesh.flanks)
        for name, mesh in branch.scene.train.meshes.items()
    }


def _share_rates(
    torque: dict[str, float],
    rate: dict[str, float],
    groups: Iterable[tuple[str, ...]],
    meshes: Iterable[str],
) -> dict[str, float]:
    """Derivative of Ω = T / mean(T) of every branch."""
    found = dict.fromkeys(meshes, np.nan)
    for group in groups:
        mean = sum(torque[m] for m in group) / len(group)
        slope = sum(rate[m] for m in group) / len(group)
        if mean:
            found |= {m: (rate[m] - torque[m] / mean * slope) / mean for m in group}
    return found
