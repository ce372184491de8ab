"""Load-sharing coefficients (formulation, section 10)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from loadshare.train.train import Stage


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
