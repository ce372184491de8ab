"""The cases of the seed paper, and the quantities that every chapter needs."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare.case import Case, load_case
from loadshare.errors import LoadshareError
from loadshare.job import solve
from loadshare.report.palette import Palette
from loadshare.train import build_train

if TYPE_CHECKING:
    from loadshare.results import Position
    from loadshare.tooth.pair.file import PairFile

GEARS = tuple(str(n) for n in range(1, 11))
PAIRS = {"4": ("6-10", "7-10"), "5": ("8-10", "9-10")}
"""Output meshes of each pinion's two branches."""
PINIONS = tuple(PAIRS)
DIVIDING = ("1-2", "1-3")
"""Meshes of stage I."""


class Seed:
    """The folder of shipped cases.

    Parameters
    ----------
    folder : pathlib.Path
        Contains ``fgfbstts`` and, for Fig. 7, ``pairs``.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._cases: dict[str, Case] = {}
        self._pairs: dict[str, PairFile] = {}

    def case(self, name: str) -> Case:
        """Return a case of the seed's transmission.

        Raises
        ------
        LoadshareError
            If the folder does not contain it.
        """
        path = self.folder / "fgfbstts" / f"{name}.toml"
        if not path.is_file():
            raise LoadshareError(
                f"{path}: does not exist; --cases names the folder of the shipped cases"
            )
        if name not in self._cases:
            self._cases[name] = load_case(path)
        return self._cases[name]

    def pair(self, name: str) -> PairFile | None:
        """Return a pair of gears with its teeth; None if the folder does not contain it."""
        path = self.folder / "fgfbstts" / "pairs" / f"{name}.toml"
        if name not in self._pairs and path.is_file():
            from loadshare.tooth.pair.file import load_pair

            self._pairs[name] = load_pair(path)
        return self._pairs.get(name)

    @property
    def used(self) -> dict[str, str]:
        """Hash of the physical content of every file that was read so far, by path."""
        cases = {f"fgfbstts/{name}.toml": case.hash for name, case in self._cases.items()}
        pairs = {f"fgfbstts/pairs/{name}.toml": pair.hash for name, pair in self._pairs.items()}
        return dict(sorted((cases | pairs).items()))

    @cached_property
    def palette(self) -> Palette:
        """Return the looks of gears and meshes that all pictures of this train share."""
        case = self.case("base")
        ends = {name: (mesh.driver, mesh.driven) for name, mesh in case.meshes.items()}
        return Palette(list(case.gears), ends)


def first(case: Case, changes: Mapping[str, Any] | None = None) -> Position:
    """Return the equilibrium of position 1; without marching, all positions are the same."""
    changed = case.replace(changes) if changes else case
    (position,) = solve(changed, positions=[1]).positions
    return position


def pair_omega(position: Position, pinion: str) -> float:
    """Return the largest Ω of a pinion's pair."""
    return max(position.pair_share[mesh] or 0.0 for mesh in PAIRS[pinion])


def stage_omega(position: Position, stage: str) -> float:
    """Return Ω of stage I, or of stage II within the pairs."""
    if stage == "I":
        return max(position.share[mesh] or 0.0 for mesh in DIVIDING)
    return max(pair_omega(position, pinion) for pinion in PINIONS)


def push_on(case: Case, position: Position, pinion: str) -> float:
    """Return the size of the resultant force [N] of a pinion's meshes on its bearing.

    It is summed from the torques and the lines of action (formulation, section 2).
    """
    train = build_train(case)
    total = np.zeros(3)
    for mesh in train.meshes.values():
        force = position.torque[mesh.name] / mesh.radii[0]
        if mesh.driver == pinion:
            total -= force * mesh.drive_normal
        elif mesh.driven == pinion:
            total += force * mesh.drive_normal
    return float(np.linalg.norm(total))
