"""Load-sharing coefficients (formulation, section 10)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from loadshare.train.equilibria import Equilibria
from loadshare.train.train import Stage

Array = NDArray[np.float64]


def coefficients(
    torque: Mapping[str, float], groups: Iterable[tuple[str, ...]]
) -> dict[str, float | None]:
    """Ω of every branch: its torque over its group's mean; None where a group carries nothing.

    Parameters
    ----------
    torque : mapping of mesh to float
        [N·m].
    groups : iterable of tuple of str
        Meshes that share a torque.
    """
    shares: dict[str, float | None] = {}
    for group in groups:
        mean = math.fsum(torque[m] for m in group) / len(group)
        shares |= {m: torque[m] / mean if mean else None for m in group}
    return shares


def stage_shares(torque: Mapping[str, float], stages: Iterable[Stage]) -> dict[str, float | None]:
    """Ω over the mean of the whole stage."""
    return coefficients(torque, [s.meshes for s in stages])


def pair_shares(torque: Mapping[str, float], stages: Iterable[Stage]) -> dict[str, float | None]:
    """Ω over the mean of the branch's group, such as the two idlers of one pinion."""
    return coefficients(torque, [g for s in stages for g in s.groups])


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
    return found


def mesh_torques(answers: Equilibria) -> tuple[Array, tuple[str, ...]]:
    """Return torques at the drivers [N·m], drive less coast, (S, meshes), and the meshes."""
    meshes = answers.names.train.meshes
    lever = np.zeros((answers.flank_force.shape[1], len(meshes)))
    flank = 0
    for m, mesh in enumerate(meshes.values()):
        for drive in mesh.flanks:
            lever[flank, m] = mesh.lever(drive)
            flank += 1
    return answers.flank_force @ lever, tuple(meshes)


def shares(
    torque: Array, meshes: tuple[str, ...], stages: Iterable[Stage], pairs: bool = False
) -> Array:
    """Return Ω of every mesh, shape (S, meshes): over its stage's mean, or over its group's.

    NaN for a mesh of no stage, and where a group carries nothing.
    """
    found = np.full_like(torque, np.nan)
    order = {m: k for k, m in enumerate(meshes)}
    with np.errstate(invalid="ignore", divide="ignore"):
        for stage in stages:
            for group in stage.groups if pairs else (stage.meshes,):
                columns = [order[m] for m in group]
                mean = torque[:, columns].mean(axis=1)
                found[:, columns] = (
                    torque[:, columns] / np.where(mean != 0.0, mean, np.nan)[:, None]
                )
    return found
