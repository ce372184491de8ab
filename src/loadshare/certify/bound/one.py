"""The bound of a single claim, by names of meshes, elements and coordinates."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from loadshare.certify.bound.columns import Columns
from loadshare.certify.bound.judge import Bounds
from loadshare.settings import BOUND
from loadshare.train.train import Train


@dataclass(frozen=True, slots=True)
class Bound:
    """Bounds on the distance of a claim from the exact equilibrium.

    Infinite where nothing was proved, and for what an equilibrium does not determine.

    Attributes
    ----------
    relative : float
        Largest error of a mesh's torque, drive less coast, over the largest torque of a flank.
    torque : mapping of mesh to float
        Error of the torque on the driver [N·m].
    force : mapping of element to float
        Error of the force of every flank, bearing, stop, arc, round ring and spline [N], and of the
        torque of every elastic shaft [N·m].
    place : mapping of coordinate to float
        Error of every rotation [rad] and displacement [m].
    """

    relative: float
    torque: Mapping[str, float]
    force: Mapping[str, float]
    place: Mapping[str, float]

    @classmethod
    def none(cls, train: Train) -> Bound:
        """Return the bound of a claim that cannot be judged."""
        return cls(math.inf, dict.fromkeys(train.meshes, math.inf), {}, {})

    @classmethod
    def of(cls, found: Bounds, row: int) -> Bound:
        """Return the bound of one claim, if all errors were found, as they are for few claims.

        Raises
        ------
        ValueError
            If only the largest errors were found.
        """
        if found.torque is None or found.force is None or found.coordinate is None:
            raise ValueError("of so many claims only the largest error of each was found")
        columns, force = found.columns, found.force[row]
        torque: dict[str, float] = {}
        for (mesh, _), error in zip(columns.all_flanks, found.torque[row].tolist(), strict=True):
            torque[mesh.name] = torque.get(mesh.name, 0.0) + error
        forces: dict[str, float] = {}
        for name, error in zip(columns.names, force.tolist(), strict=True):
            forces[name] = math.hypot(forces.get(name, 0.0), error)
        gears = columns.train.gears
        for name in list(forces):
            if name in columns.train.shafts:
                forces[name] *= gears[columns.train.shafts[name].first].base_radius
        units = columns.units
        place = {
            name: float(error / unit)
            for name, error, unit in zip(
                columns.coordinates, found.coordinate[row], units, strict=True
            )
        }
        for gear in gears.values():
            names = [f"{gear.name} {axis}" for axis in "xy"]
            if gear.is_tilted and names[0] in place:
                # Displacements are given along another frame than that of the coordinates.
                weights, errors = np.abs(gear.plane @ gear.frame.T), [place[n] for n in names]
                # An infinite error along a direction with weight zero does not count.
                parts = np.multiply(weights, errors, where=weights > 0.0, out=np.zeros((2, 2)))
                along = parts.sum(axis=1)
                place |= dict(zip(names, along.tolist(), strict=True))
        relative = float(found.relative[row])
        return cls(relative, torque, forces, place)


@lru_cache(maxsize=BOUND.trains)
def columns_of(train: Train) -> Columns:
    """Return the columns of a train, built once."""
    return Columns(train)
