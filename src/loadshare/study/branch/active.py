"""The active set of an equilibrium: which contacts are closed, where each radial element stands."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from loadshare.contact.law import Law
from loadshare.contact.radial import RadialLaw
from loadshare.scene.scene import Array, Scene
from loadshare.train.equilibrium import Equilibrium

CARRIES = 1e-11
"""Force over the load from which on a contact counts as closed."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a radial element stands on its graph.

    Attributes
    ----------
    piece : str
        Name of the piece; on a vertical step, of the piece behind it, empty for a rigid end.
    corner : bool
        Whether it stands on the step in front of that piece.
    """

    piece: str
    corner: bool = False

    @property
    def label(self) -> str:
        """Words for it."""
        if not self.corner:
            return self.piece
        return f"about to {self.piece}" if self.piece else "on boundary"


@dataclass(frozen=True, slots=True)
class ActiveSet:
    """Closed contacts and places of the radial elements, by name.

    Attributes
    ----------
    closed : frozenset of str
    places : tuple of (str, Place)
    """

    closed: frozenset[str]
    places: tuple[tuple[str, Place], ...]

    def state(self, element: str) -> str:
        """Words for the state of an element."""
        for name, place in self.places:
            if name == element:
                return place.label
        return "closed" if element in self.closed else "open"

    def changes(self, other: ActiveSet) -> tuple[str, ...]:
        """Names of the elements whose state differs."""
        moved = [n for (n, p), (_, q) in zip(self.places, other.places, strict=True) if p != q]
        return (*sorted(self.closed ^ other.closed), *moved)


def read_set(
    scene: Scene, found: Equilibrium, units: tuple[float, float]
) -> tuple[ActiveSet, Array, dict[str, float], dict[str, Array]]:
    """Read the active set of an equilibrium.

    Parameters
    ----------
    scene : Scene
    found : Equilibrium
        A certified one of this scene.
    units : (float, float)
        Force [N] and length [m] by which nearness is measured.

    Returns
    -------
    ActiveSet
    ndarray, shape (n,)
        Coordinates [m].
    dict of contact to float
        Forces [N].
    dict of radial element to ndarray, shape (2,)
        Forces along their offsets [N].
    """
    x = coordinates(scene, found)
    forces = {**found.flank_force, **found.ring_force}
    largest = max([units[0], *forces.values()])
    closed = {name for name, force in forces.items() if force > CARRIES * largest}
    pulls, places = {}, []
    for radial in scene.radials:
        frame = scene.train.gears[radial.gear].frame
        pulls[radial.name] = -(frame @ found.radial_reaction[radial.name])
        law = radial.law(scene.train.transmitted(radial.gear, found.flank_force))
        radius = float(np.linalg.norm(radial.matrix @ x - radial.centre))
        size = float(np.linalg.norm(pulls[radial.name]))
        places.append((radial.name, _nearest(law, radius, size, units)))
    return ActiveSet(frozenset(closed), tuple(places)), x, forces, pulls


def coordinates(scene: Scene, found: Equilibrium) -> Array:
    """Coordinates x [m] of an equilibrium."""
    x = np.zeros(scene.size)
    for gear, where in scene.displacement.items():
        x[where] = scene.train.gears[gear].frame @ found.displacement[gear]
    for gear, rotation in scene.rotation.items():
        if rotation.index is not None:
            x[rotation.index] = (found.rotation[gear] - rotation.constant) / rotation.rate
    return x


def is_rigid(law: Law) -> bool:
    """Whether a contact does not yield at all."""
    return law.compression(1.0) == 0.0


def _nearest(law: RadialLaw, radius: float, size: float, units: tuple[float, float]) -> Place:
    """Place on a graph that is nearest to a radius [m] and force [N]."""
    force_unit, length_unit = units
    near: list[tuple[float, Place]] = []
    for k, piece in enumerate(law.pieces):
        begin = law.start(k)
        inner = min(max(radius - begin, 0.0), piece.length)
        force = piece.force + (piece.stiffness * inner if piece.stiffness else 0.0)
        off = np.hypot((radius - begin - inner) / length_unit, (size - force) / force_unit)
        near.append((float(off), Place(piece.name)))
    for k in range(len(law.pieces) + 1):
        low, high = law.step(k)
        if high > low:
            force = min(max(size, low), high)
            off = np.hypot((radius - law.start(k)) / length_unit, (size - force) / force_unit)
            near.append((float(off), corner(law, k)))
    return min(near, key=lambda candidate: candidate[0])[1]


def corner(law: RadialLaw, k: int) -> Place:
    """Place on the step in front of piece k."""
    return Place(law.pieces[k].name if k < len(law.pieces) else "", corner=True)


def index_of(law: RadialLaw, place: Place) -> int | None:
    """Number of the piece that a place names on a graph, or None where the graph lacks it."""
    if place.corner and not place.piece:
        return len(law.pieces)
    names: Mapping[str, int] = {piece.name: k for k, piece in enumerate(law.pieces)}
    return names.get(place.piece)
