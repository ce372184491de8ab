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


def flank_torques(train: Train, flank_force: Mapping[str, float]) -> dict[str, list[float]]:
    """Return the torques of the flanks of every mesh on its driver [N·m], coast flanks negative.

    Parameters
    ----------
    train : Train
    flank_force : mapping of flank to float
        [N].
    """
    return {
        name: [lever * float(flank_force[flank]) for flank, lever in flanks]
        for name, flanks in train.driving.items()
    }


def largest_of(flanks: Mapping[str, Iterable[float]]) -> float:
    """Largest of the torques of flanks [N·m]."""
    return max((abs(torque) for both in flanks.values() for torque in both), default=0.0)


def carries(mean: Torque, largest: Torque) -> Any:
    """Whether a mesh or a group with a mean torque carries, given the largest on any flank.

    Flanks may press against one another, and branches brace one another, where next to nothing
    passes through: a coefficient over a mean that is round-off says nothing.
    """
    return abs(mean) > CERTIFY.carries * largest


def coefficients(
    torque: Mapping[str, float], groups: Iterable[tuple[str, ...]], largest: float
) -> dict[str, float | None]:
    """Ω of every branch: its torque over its group's mean; None where a group carries nothing.

    Parameters
    ----------
    torque : mapping of mesh to float
        [N·m].
    groups : iterable of tuple of str
        Meshes that share a torque.
    largest : float
        Torque on any flank [N·m].
    """
    found: dict[str, float | None] = {}
    for group in groups:
        mean = math.fsum(torque[m] for m in group) / len(group)
        found |= {m: torque[m] / mean if carries(mean, largest) else None for m in group}
    return Table(found)


def largest(
    shares: Iterable[Mapping[str, float | None]], stages: Iterable[Stage]
) -> dict[str, float | None]:
    """Largest Ω of each stage over branches and positions, and of the system (Ω_Z)."""
    found: dict[str, float | None] = {}
    for stage in stages:
        values = [s[m] for s in shares for m in stage.meshes]
        known = [v for v in values if v is not None]
        found[stage.name] = max(known, default=None)
    known = [v for v in found.values() if v is not None]
    found["system"] = max(known, default=None)
    return Table(found)


def is_load_factor(train: Train) -> bool:
    """Whether Ω is K_γ in every stage: forces are shared as torques are, by drivers of one size."""
    return all(
        math.isclose(train.meshes[m].first_radius, train.meshes[stage.meshes[0]].first_radius)
        for stage in train.stages
        for m in stage.meshes
    )


def load_factors(train: Train, torque: Mapping[str, float], stage: Stage) -> dict[str, float]:
    """K_γ of every mesh of a stage: its force over the mean of the stage (ISO 6336-1).

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


def mesh_torques(train: Train, force: Array) -> MeshTorques:
    """Return the torques that forces of flanks, (S, flanks) [N], exert on the drivers."""
    flanks, torque = [*map(len, train.driving.values())], torques_of_flanks(train, force)
    if len(set(flanks)) == 1:
        net = sum((torque[:, k :: flanks[0]] for k in range(1, flanks[0])), torque[:, :: flanks[0]])
    else:
        net = np.add.reduceat(torque, np.cumsum([0, *flanks[:-1]]), axis=1)
    return MeshTorques(tuple(train.meshes), net, np.abs(torque).max(axis=1, initial=0.0))


def shares(torques: MeshTorques, stages: Iterable[Stage], pairs: bool = False) -> Array:
    """Return Ω of every mesh, shape (S, meshes): its torque over the mean of its stage or group.

    NaN for a mesh of no stage, and where a group carries nothing.

    Parameters
    ----------
    torques : MeshTorques
    stages : iterable of Stage
    pairs : bool
        Over the mean of the branch's group, such as the two idlers of one pinion.
    """
    found = np.full_like(torques.net, np.nan)
    order = {m: k for k, m in enumerate(torques.meshes)}
    for stage in stages:
        for group in stage.groups if pairs else (stage.meshes,):
            columns = [order[m] for m in group]
            of_group = torques.net[:, columns]
            mean = of_group.mean(axis=1)
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
