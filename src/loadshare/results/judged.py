"""Figures of positions that were certified one by one."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from loadshare.array_types import Array
from loadshare.results.figures import Figures
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations, situations_of
from loadshare.train.train import Train

if TYPE_CHECKING:
    from loadshare.results.result import Position


def figures_of(positions: Sequence[Position]) -> list[Figures]:
    """Return the figures of positions, those of one train together."""
    groups: list[list[Position]] = []
    for position in positions:
        if not (groups and groups[-1][0].train is position.train):
            groups.append([])
        groups[-1].append(position)
    found: list[Figures] = []
    for group in groups:
        train, answers = group[0].train, Equilibria.empty(group[0].train, len(group))
        for row, position in enumerate(group):
            answers.put(row, position.equilibrium)
        situations = situations_of(train, [position.position for position in group])
        found.append(_Judged(train, situations, answers, group))
    return found


class _Judged(Figures):
    """Figures of positions, each with its own certificate."""

    def __init__(
        self,
        train: Train,
        situations: Situations,
        answers: Equilibria,
        positions: Sequence[Position],
    ) -> None:
        proved = np.array([p.certificate.proved for p in positions])
        super().__init__(train, situations, answers, [p.undetermined for p in positions], proved)
        self._positions = positions

    @cached_property
    def torque_bound(self) -> Array:
        """Bounds of torques as the certificates have them; not a number where there is none."""
        bounds = [p.certificate.bound.torque for p in self._positions]
        return np.array([[b.get(mesh, np.nan) for mesh in self.train.meshes] for b in bounds])
