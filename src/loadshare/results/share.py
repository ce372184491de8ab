"""Load-sharing coefficients (formulation, section 10)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from loadshare.array_types import Array
from loadshare.case.table import Table
from loadshare.settings import CERTIFY
from loadshare.train.elements import Stage
from loadshare.train.train import Train

Torque = TypeVar("Torque", float, Array)
NO_STAGES = "No stages are named, so there is no load-sharing coefficient."


@dataclass(frozen=True, eq=False)
class MeshTorques:
    """Torques of S answers on the drivers of the meshes.

    Attributes
    ----------
    meshes : tuple of str
    net : ndarray, shape (S, meshes)
        Drive flank less coast flank [N·m].
    largest : ndarray, shape (S,)
        Largest torque on any flank [N·m].
    """

    meshes: tuple[str, ...]
    net: Array
    largest: Array


def forces_of(train: Train, answers: Iterable[Mapping[str, float]]) -> Array:
    """Return the forces of flanks of S answers, given by name [N], as `mesh_torques` takes them."""
    flanks = [flank for each in train.driving.values() for flank, _ in each]
    rows = [[force[flank] for flank in flanks] for force in answers]
    return np.array(rows, dtype=float).reshape(-1, len(flanks))


def carries(mean: Torque, largest: Torque) -> Any:
    """Return whether a mesh or group carries, from its mean torque and the largest on any flank.

    Flanks may press against one another, and branches brace one another, while almost no torque
    passes through: a coefficient over a mean that is round-off is meaningless.
    """
    return abs(mean) > CERTIFY.carries * largest


def largest(
    shares: Iterable[Mapping[str, float | None]], stages: Iterable[Stage]
) -> dict[str, float | None]:
    """Return the largest Ω of each stage over branches and positions, and of the system (Ω_Z)."""
    found: dict[str, float | None] = {}
    for stage in stages:
        values = [s[m] for s in shares for m in stage.meshes]
        known = [v for v in values if v is not None]
        found[stage.name] = max(known, default=None)
    known = [v for v in found.values() if v is not None]
    found["system"] = max(known, default=None)
    return Table(found)


def is_load_factor(train: Train) -> bool:
    """Return whether Ω is K_γ in every stage: with drivers of one size, forces share as torques."""
    return all(
        math.isclose(train.meshes[m].first_radius, train.meshes[stage.meshes[0]].first_radius)
        for stage in train.stages
        for m in stage.meshes
    )


def load_factors(train: Train, torque: Mapping[str, float], stage: Stage) -> dict[str, float]:
    """Return K_γ of every mesh of a stage: its force over the mean of the stage (ISO 6336-1).

    Parameters
    ----------
    train : Train
    torque : mapping of mesh to float
        On the drivers [N·m].
    stage : Stage
        One that carries.
    """
    force = {m: torque[m] / train.meshes[m].first_radius for m in stage.meshes}
    mean = math.fsum(force.values()) / len(force)
    return {m: f / mean for m, f in force.items()}


def torques_of_flanks(train: Train, force: Array) -> Array:
    """Return the torque that each force of a flank [N] exerts on the driver [N·m], (S, flanks)."""
    lever = np.array([lever for flanks in train.driving.values() for _, lever in flanks])
    return np.asarray(force * lever)


def over_meshes(train: Train, figures: Array) -> Array:
    """Return figures of flanks, (S, flanks), summed over the flanks of every mesh."""
    flanks = [*map(len, train.driving.values())]
    if len(set(flanks)) != 1:
        return np.asarray(np.add.reduceat(figures, np.cumsum([0, *flanks[:-1]]), axis=1))
    first, *others = (figures[:, k :: flanks[0]] for k in range(flanks[0]))
    return np.asarray(sum(others, first))


def mesh_torques(train: Train, force: Array) -> MeshTorques:
    """Return the torques that forces of flanks, (S, flanks) [N], exert on the drivers."""
    torque = torques_of_flanks(train, force)
    largest = np.abs(torque).max(axis=1, initial=0.0)
    return MeshTorques(tuple(train.meshes), over_meshes(train, torque), largest)


def shares(torques: MeshTorques, stages: Iterable[Stage], pairs: bool = False) -> Array:
    """Return Ω of every mesh, shape (S, meshes): its torque over the mean of its stage or group.

    NaN for a mesh of no stage, and where a group carries nothing.

    Parameters
    ----------
    torques : MeshTorques
    stages : iterable of Stage
    pairs : bool
        Whether over the mean of the branch's group, such as the two idlers of one pinion.
    """
    found = np.full_like(torques.net, np.nan)
    order = {m: k for k, m in enumerate(torques.meshes)}
    for stage in stages:
        for group in stage.groups if pairs else (stage.meshes,):
            columns = [order[m] for m in group]
            of_group = torques.net[:, columns]
            # Column by column, so that no digit depends on the number of answers.
            mean = sum(of_group.T, np.zeros(len(found))) / len(group)
            mean = np.where(carries(mean, torques.largest), mean, np.nan)
            found[:, columns] = of_group / mean[:, None]
    return found


def largest_shares(
    torques: MeshTorques, stages: Sequence[Stage], pairs: bool = False
) -> dict[str, Array]:
    """Return the largest Ω of each stage and of the system, shape (S,) each; NaN without one.

    Parameters
    ----------
    torques, stages, pairs
        As for `shares`.
    """
    found, order = shares(torques, stages, pairs), {m: k for k, m in enumerate(torques.meshes)}
    columns = {stage.name: [order[m] for m in stage.meshes] for stage in stages}
    every = {stage: np.fmax.reduce(found[:, own], axis=1) for stage, own in columns.items()}
    # Without stages there are torques, but no shares.
    none = np.full(len(torques.net), np.nan)
    return {**every, "system": np.fmax.reduce([none, *every.values()])}
