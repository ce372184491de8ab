"""An input at a position: trains, scenes and certified answers as it varies.

Every mesh is held at the place of its cycle where it stands: a change of input that lets it pass to
the next place is a step of the answer, no derivative.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from loadshare.array_types import Array
from loadshare.results.share import flank_torques
from loadshare.scene.structure import Structure
from loadshare.settings import SENSITIVITY
from loadshare.study.answers import certified
from loadshare.study.follow.active import WorkingSet
from loadshare.study.parameter import Value
from loadshare.study.sensitivity.branch import Branch, BranchLost, Setting
from loadshare.study.sensitivity.differences import Derivative, differentiate
from loadshare.study.sensitivity.trains import Trains
from loadshare.train import Train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.placed import standing


class Variation:
    """An input of a case, at one position.

    Parameters
    ----------
    trains : Trains
    value : Value
    position : int
        1-based.
    structure : Structure
        At the value itself.
    """

    def __init__(self, trains: Trains, value: Value, position: int, structure: Structure) -> None:
        self._trains, self.value, self.position = trains, value, position
        self._structure = structure
        self.cycle = trains.at(value.number).flank_positions(position)
        self._setting = lru_cache(maxsize=None)(self._at)
        self._changes: dict[tuple[WorkingSet, bytes], Derivative] = {}

    def _number(self, amount: float) -> float:
        return self.value.number + amount / self.value.factor

    def _at(self, number: float) -> Setting:
        train, structure = standing(self._trains.at(number), self.position), self._structure
        if train.flank_positions(self.position) == self.cycle:
            return Setting(train, structure, self._trains.numbers(train, self.position, structure))
        return Setting.at(replace(train, held_at=self.cycle), self.position, structure)

    def setting(self, amount: float) -> Setting:
        """Return the train with the input moved by an amount [SI]."""
        return self._setting(self._number(amount))

    def answer(self, amount: float) -> Equilibrium:
        """Return the certified equilibrium with the input moved by an amount [SI].

        Raises
        ------
        CaseError
            If the input cannot be there.
        Refused
            If there is no certified equilibrium.
        """
        return certified(self.setting(amount).train, self.position).equilibrium

    def change(self, branch: Branch, z: Array) -> Derivative:
        """Return the derivative of a branch's residual and torques at z, by the input.

        Raises
        ------
        CaseError
            If the input can be varied to neither side.
        """
        key = branch.active, z.tobytes()
        if key not in self._changes:

            def of(number: float) -> Array:
                there = Branch(self._setting(number), branch.active)
                if there.size != branch.size:
                    raise BranchLost("a limit without play is another element than one with some")
                return there.figures(z)

            self._changes[key] = differentiate(of, self.value, branch.rounding(z))
        return self._changes[key]

    def steps(self, sign: float, step: float) -> tuple[str, ...]:
        """Meshes that pass to another place of their cycle right next to the value."""
        least = min(step, SENSITIVITY.beside * max(abs(self.value.si), step))
        for amount in (step, least):
            train = self._trains.at(self._number(sign * amount))
            there = train.flank_positions(self.position)
            passing = tuple(
                mesh.name
                for mesh in train.meshes.values()
                if any(there[f] != self.cycle[f] for f in map(mesh.flank_name, mesh.flanks))
            )
            if not passing:
                return ()
        return passing


def torques_of(train: Train, found: Equilibrium) -> dict[str, float]:
    """Torque of every mesh of an equilibrium, drive flank less coast flank [N·m]."""
    flanks = flank_torques(train, found.flank_force)
    return {name: sum(both) for name, both in flanks.items()}
