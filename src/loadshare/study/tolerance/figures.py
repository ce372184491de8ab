"""The figures that are kept of every sample: the largest over positions and branches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.job.block import Block
from loadshare.results.share import largest_shares, mesh_torques
from loadshare.train.equilibria import Equilibria
from loadshare.train.ring import DrumRing
from loadshare.train.train import Train

KINDS = {"omega": "stage", "pair_omega": "group"}
"""Kinds of Ω, as columns name them, and whose mean each is over."""
KIND_OVER = {over: kind for kind, over in KINDS.items()}
SYSTEM = "system"


@dataclass(frozen=True, slots=True, eq=False)
class Figures:
    """Figures of some samples.

    Attributes
    ----------
    columns : mapping of str to ndarray, shape (S,)
        ``omega.STAGE``, ``pair_omega.STAGE`` [-], ``torque.MESH [N*m]``, ``float.GEAR [m]``
        (displacement of the centre) and ``boundary_force.GEAR [N]`` (largest force on a contact of
        its ring): the largest over the positions. NaN where a position is not certified.
    residual : ndarray, shape (S,)
        Largest scaled residual of the certificates.
    message : mapping of int to str
        Why a sample has no certified answer.
    """

    columns: Mapping[str, Array]
    residual: Array
    message: Mapping[int, str]


def figure_names(train: Train) -> list[str]:
    """Return the names of the figures of a train's samples, in the order of their columns."""
    stages = [*(s.name for s in train.stages), SYSTEM]
    return [
        *(f"{kind}.{stage}" for kind in KINDS for stage in stages),
        *(f"torque.{mesh} [N*m]" for mesh in train.meshes),
        *(f"float.{gear} [m]" for gear in train.floating),
        *(f"boundary_force.{gear} [N]" for gear in train.limits),
    ]


def largest_figures(block: Block) -> dict[str, Array]:
    """Return the largest figures over the positions, shape (S,) each; NaN where there is none."""
    every: dict[str, list[Array]] = {}
    for answers in block.equilibria:
        for name, values in _at_position(answers).items():
            every.setdefault(name, []).append(values)
    # fmax ignores a stage at positions where it carries nothing.
    found = {name: np.fmax.reduce(values) for name, values in every.items()}
    for name in (name for name in every if name.startswith("torque.")):
        # If the drive brakes, the largest torque is the most negative one.
        least = np.fmin.reduce(every[name])
        found[name] = np.where(-least > found[name], least, found[name])
    return found


def _at_position(answers: Equilibria) -> dict[str, Array]:
    train = answers.names.train
    torques = mesh_torques(train, answers.flank_force)
    found: dict[str, Array] = {}
    for kind in KINDS:
        omegas = largest_shares(torques, train.stages, pairs=kind == "pair_omega")
        found |= {f"{kind}.{stage}": values for stage, values in omegas.items()}
    found |= {f"torque.{mesh} [N*m]": torques.net[:, m] for m, mesh in enumerate(torques.meshes)}
    gears = {gear: g for g, gear in enumerate(train.gears)}
    for gear in train.floating:
        way = np.linalg.norm(answers.displacement[:, gears[gear]], axis=1)
        found[f"float.{gear} [m]"] = way
    for gear in train.limits:
        found[f"boundary_force.{gear} [N]"] = _boundary_force(answers, gear)
    return found


def _boundary_force(answers: Equilibria, gear: str) -> Array:
    """Return the largest force on a contact of the rings and stops that limit a gear [N]."""
    names, found = answers.names, [np.zeros(len(answers.rotation))]
    radials = [name for name, _ in names.radials]
    for limit in names.train.limits[gear]:
        if isinstance(limit, DrumRing):
            mine = {*limit.stop_names, *(limit.arc_name(n) for n in limit.neighbours)}
            columns = [c for c, name in enumerate(names.contacts) if name in mine]
            found.append(answers.ring_force[:, columns].max(axis=1))
        else:
            reaction = answers.radial_reaction[:, radials.index(limit.name)]
            found.append(np.linalg.norm(reaction, axis=1))
    return np.asarray(np.max(found, axis=0))
