"""Coordinates of a scene: which there are, and how the motions of gears follow from them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.train.train import Train


@dataclass(frozen=True, slots=True)
class Rotation:
    """How a gear turns with the coordinates: φ = rate · x[index], from where it is at zero.

    Attributes
    ----------
    index : int or None
        Coordinate (an arc length on the base circle [m]), or None for a gear that cannot turn.
    rate : float
        [rad/m].
    """

    index: int | None
    rate: float


@dataclass(frozen=True, slots=True)
class Coordinates:
    """Coordinates of a train, and those that were left out.

    Attributes
    ----------
    names : tuple of str
        Rotations, displacements, slips; every coordinate is a length [m].
    rotation : mapping of gear to Rotation
    lag : ndarray, shape (gears, shafts)
        Rotation of every gear at zero coordinates, per clocking of every rigid shaft.
    displacement : mapping of gear to slice
        The two displacement components of a moving gear.
    slip : mapping of gear to slice
        The two components of the slip of a spline that remembers it.
    frame : mapping of gear to ndarray, shape (2, 3)
        Unit vectors along which the components are taken.
    removed : tuple of (str, str)
        Names of what is not a coordinate, and why.
    """

    names: tuple[str, ...]
    rotation: dict[str, Rotation]
    lag: Array
    displacement: dict[str, slice]
    slip: dict[str, slice]
    frame: dict[str, Array]
    removed: tuple[tuple[str, str], ...]

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return len(self.names)

    def components(self, where: slice) -> Array:
        """Return the matrix (2, n) that picks two components."""
        return np.asarray(np.eye(self.size)[where])

    def turned(self, *arms: tuple[str, float]) -> Array:
        """Return the row (n,) of a sum of rotations times arms [m]; with arms of 1, of angles."""
        row = np.zeros(self.size)
        for gear, arm in arms:
            rotation = self.rotation[gear]
            if rotation.index is not None:
                row[rotation.index] += arm * rotation.rate
        return row

    def moved(self, gear: str) -> Array:
        """Return a gear's displacement as a matrix (3, n); zero if it cannot move."""
        matrix = np.zeros((3, self.size))
        if gear in self.displacement:
            matrix[:, self.displacement[gear]] = self.frame[gear].T
        return matrix


def coordinates_of(train: Train) -> Coordinates:
    """Give every gear that can turn, move or slip its coordinates."""
    names: list[str] = []
    removed: list[tuple[str, str]] = []

    def pair(what: str) -> slice:
        names.extend((f"{what} x", f"{what} y"))
        return slice(len(names) - 2, len(names))

    rotation, lag = _rotations(train, names, removed)
    displacement: dict[str, slice] = {}
    for name, gear in train.gears.items():
        if gear.moves:
            displacement[name] = pair(f"gear {name}")
        else:
            removed.append((f"gear {name} x, y", "its bearing is rigid"))
    remembering = train.splines if train.slip is not None else ()
    slip = {gear: pair(f"spline {gear} slip") for gear in remembering}
    frame = {name: gear.frame for name, gear in train.gears.items()}
    return Coordinates(tuple(names), rotation, lag, displacement, slip, frame, tuple(removed))


def _rotations(
    train: Train, names: list[str], removed: list[tuple[str, str]]
) -> tuple[dict[str, Rotation], Array]:
    """Return a rotation coordinate per set of gears on rigid shafts (none if held), and `lag`."""
    lag = np.zeros((len(train.gears), len(train.shafts)))
    sets: dict[str, str] = {}
    for seed in (*train.held, *train.gears):
        if seed in sets:
            continue
        sets[seed] = seed
        queue = [seed]
        while queue:
            here = queue.pop()
            for s, shaft in enumerate(train.shafts.values()):
                ends = (shaft.first, shaft.second)
                if not math.isinf(shaft.stiffness) or here not in ends:
                    continue
                forward = here == ends[0]
                other = ends[1] if forward else ends[0]
                if other not in sets:
                    sets[other] = seed
                    lag[train.order[other]] = lag[train.order[here]]
                    lag[train.order[other], s] = -1.0 if forward else 1.0
                    removed.append((f"gear {other} rotation", f"rigid shaft {shaft.name}"))
                    queue.append(other)
    removed.append((f"gear {train.output} rotation", "the output gear is held"))
    removed += [(f"gear {name} rotation", "the housing holds it") for name in train.held[1:]]
    where: dict[str, int] = {}
    for name in train.gears:
        root = sets[name]
        if root not in where and root not in train.held:
            where[root] = len(names)
            names.append(f"gear {root} rotation")
    rotation = {
        name: Rotation(where.get(root), 1.0 / train.gears[root].base_radius)
        for name, root in sets.items()
    }
    return rotation, lag
