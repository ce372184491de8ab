"""The trains of a case as an input varies, and the numbers of their equations."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from loadshare.case import Case
from loadshare.scene.structure import Structure
from loadshare.study.follow.numbers import Numbers, structure_like
from loadshare.study.sensitivity.inputs import twin_of
from loadshare.study.sensitivity.result import Input
from loadshare.train import Train, build_train
from loadshare.train.alike import train_alike
from loadshare.train.build import with_laws
from loadshare.train.geometry import Geometry
from loadshare.train.situations import situation_of, situations_of


class Trains:
    """The trains of a case as an input varies.

    Parameters
    ----------
    base : (Case, Geometry, Train)
        The case, its mesh laws computed, with its geometry and its train.
    case : Case
        The same, except for laws that follow from the input.
    item : Input
    positions : sequence of int
        1-based, at which they are looked at.
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
        self._numbers = lru_cache(maxsize=None)(self._numbers_of)

    def at(self, number: float) -> Train:
        """Return the train with the input at a number, in its unit.

        Raises
        ------
        CaseError
            If the input cannot be there.
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
        """Return the numbers of one of them, or of one with other laws, in the units of others.

        Raises
        ------
        ValueError
            If it has other elements than these.
        """
        if train.placed or position not in self._positions:
            return Numbers.of(structure_like(base, train), situation_of(train, position))
        return self._numbers(train, base).row(self._positions.index(position))

    def _numbers_of(self, train: Train, base: Structure) -> Numbers:
        return Numbers.of(structure_like(base, train), situations_of(train, self._positions))
