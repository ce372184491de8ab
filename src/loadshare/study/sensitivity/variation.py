"""The trains of a case as an input varies, and their equations at one position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.results.share import MeshTorques, forces_of, mesh_torques
from loadshare.scene.structure import Structure
from loadshare.settings import SENSITIVITY
from loadshare.study.follow.active import WorkingSet
from loadshare.study.follow.numbers import Numbers, structure_like
from loadshare.study.parameter import Value
from loadshare.study.positions import certified
from loadshare.study.sensitivity.branch import Branch, BranchLost, Setting, figures
from loadshare.study.sensitivity.differences import Derivative, Group, differentiate, whole
from loadshare.study.sensitivity.inputs import twin_of
from loadshare.study.sensitivity.result import Input
from loadshare.train import Train, build_train
from loadshare.train.alike import train_alike
from loadshare.train.build import with_laws
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.geometry import Geometry
from loadshare.train.placed import train_at
from loadshare.train.situations import Situations, situation_of, situations_of


class Trains:
    """The trains of a case as an input varies.

    Parameters
    ----------
    base : (Case, Geometry, Train)
        The case with its mesh laws computed, its geometry and its train.
    case : Case
        The same, except that laws which depend on the input are not computed yet.
    item : Input
    positions : sequence of int
        1-based positions that are differentiated.

    Attributes
    ----------
    at : callable
        Returns the train with the input at a number, in the input's unit. Raises `CaseError` if the
        input cannot take this number.
    """

    def __init__(
        self,
        base: tuple[Case, Geometry, Train],
        case: Case,
        item: Input,
        positions: Sequence[int],
    ) -> None:
        self._base, self._case, self._item = base, case, item
        self._positions = tuple(positions)
        self._at = lru_cache(maxsize=None)(self._built)
        self._situations = lru_cache(maxsize=None)(self._situations_of)
        self._numbers = lru_cache(maxsize=None)(self._numbers_of)

    def at(self, number: float) -> Train:
        """Return the train with the input at a number, in the input's unit.

        Raises
        ------
        CaseError
            If the input cannot take this number.
        """
        return self._at(number)

    def _built(self, number: float) -> Train:
        if number == self._item.value.number:
            return self._base[2]
        key, text = self._item.key, self._item.value.at(number).text
        changes = {key: text} if (twin := twin_of(key)) is None else {key: text, twin: text}
        changed = with_laws(self._case.replace(changes))
        return train_alike(changed, self._base) or build_train(changed)

    def numbers(self, train: Train, position: int, base: Structure) -> Numbers:
        """Return the numbers of a train at a position, in the units of `base`.

        Raises
        ------
        ValueError
            If the train has other elements than `base`.
        """
        if self._is_alone(train, position):
            return Numbers.of(structure_like(base, train), situation_of(train, position))
        return self._numbers(train, base).row(self._positions.index(position))

    def situation(self, train: Train, position: int) -> Situations:
        """Return the situation of a train at a position."""
        if self._is_alone(train, position):
            return situation_of(train, position)
        row = self._positions.index(position)
        return self._situations(train).take(slice(row, row + 1))

    def _is_alone(self, train: Train, position: int) -> bool:
        return bool(train.placed) or position not in self._positions

    def _situations_of(self, train: Train) -> Situations:
        return situations_of(train, self._positions)

    def _numbers_of(self, train: Train, base: Structure) -> Numbers:
        return Numbers.of(structure_like(base, train), self._situations(train))


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
        train, structure = train_at(self._trains.at(number), self.position), self._structure
        if train.flank_positions(self.position) == self.cycle:
            numbers = self._trains.numbers(train, self.position, structure)
            situation = self._trains.situation(train, self.position)
            return Setting(train, structure, situation, numbers)
        return Setting.at(replace(train, held_at=self.cycle), self.position, structure)

    def setting(self, amount: float) -> Setting:
        """Return the train with the input moved by an amount [SI]."""
        return self._setting(self._number(amount))

    def answer(self, amount: float) -> Equilibrium:
        """Return the certified equilibrium with the input moved by an amount [SI].

        Raises
        ------
        CaseError
            If the input cannot take this value.
        Refused
            If there is no certified equilibrium.
        """
        return certified(self.setting(amount).train, self.position).equilibrium

    def change(self, branch: Branch, z: Array) -> Derivative:
        """Return the derivative of a branch's residual and torques at z with respect to the input.

        Raises
        ------
        CaseError
            If the input can be varied to neither side.
        """
        key = branch.active, z.tobytes()
        if key not in self._changes:

            def of(groups: Sequence[Sequence[float]]) -> list[Group]:
                there = [self._beside(branch, numbers) for numbers in groups]
                every = [b for some in there if not isinstance(some, Exception) for b in some]
                found = iter(figures(every, z))
                return [
                    some if isinstance(some, Exception) else whole([next(found) for _ in some])
                    for some in there
                ]

            self._changes[key] = differentiate(of, self.value, branch.rounding(z))
        return self._changes[key]

    def _beside(self, branch: Branch, numbers: Sequence[float]) -> list[Branch] | Exception:
        """Return a branch at some numbers of the input, or why it does not exist at one of them."""
        try:
            return [branch.beside(self._setting(number)) for number in numbers]
        except (CaseError, ValueError, BranchLost) as why:
            return why

    def steps(self, sign: float, step: float) -> tuple[str, ...]:
        """Return meshes that pass to another point of their cycle right next to the value."""
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


def torques_of(train: Train, found: Equilibrium) -> MeshTorques:
    """Return the torques of an equilibrium on the drivers of the meshes [N·m]."""
    return mesh_torques(train, forces_of(train, [found.flank_force]))
