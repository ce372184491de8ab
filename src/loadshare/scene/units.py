"""Units of force and length that suit a train, so that all numbers of a scene are of order one."""

from __future__ import annotations

import math
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from loadshare.settings import CONTACT
from loadshare.train.situations import Situations

if TYPE_CHECKING:
    from loadshare.scene.structure import Structure


def units_of(structure: Structure, here: Situations) -> tuple[float, float]:
    """Return the units of force [N] and length [m] that suit a train with these elements.

    Parameters
    ----------
    structure : Structure
    here : Situations
        Situation of that train or of one of the same shape, at its first position.
    """
    force, length = _measures(structure, here)
    return 8.0 ** round(math.log(force, 8.0)), 2.0 ** round(math.log2(length))


def _measures(structure: Structure, here: Situations) -> tuple[float, float]:
    """Return typical force and length of a scene (see `Scene`)."""
    train, flanks = here.train, [(m, drives) for m, _, drives in structure.flanks]
    radius = [g.base_radius for g in train.gears.values()]
    force = float((np.abs(here.torque[0]) / radius).max(initial=0.0))
    force = max(force, float(np.abs(here.push[0]).max(initial=0.0))) or 1.0
    meshes = tuple(train.meshes.values())
    changes = any(mesh.changes for mesh in meshes)
    positions = train.mesh_positions(here.position) if changes else dict.fromkeys(train.meshes, 0)
    gaps = structure.gaps_of_flanks(here)[0]
    drive = [(e, meshes[m]) for e, (m, drives) in enumerate(flanks) if drives]
    if not drive:
        return force, CONTACT.least_length
    yielded = median(mesh.law(positions[mesh.name]).compression(force) for _, mesh in drive)
    return force, max(yielded, CONTACT.of_gaps * max(abs(gaps[e]) for e, _ in drive))
