"""The trains of a case as an input varies, and the numbers of their equations."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from loadshare.case import Case
from loadshare.scene.structure import Structure
from loadshare.study.follow.numbers import Numbers, structure_like
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
    case : Case
        Its mesh laws computed.
    geometry : Geometry
    train : Train
    item : Input
    positions : sequence of int
        1-based, at which they are looked at.
    """

    def __init__(
        self, case: Case, geometry: Geometry, train: Train, item: Input, positions: Sequence[int]
    ) -> None:
        self._base, self._item, self._positions = (case, geometry, train), item, tuple(positions)
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
        case, _, train = self._base
        if number == self._item.value.number:
            return train
        changed = with_laws(case.replace({self._item.key: self._item.value.at(number).text}))
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
