"""All places of one equilibrium: the displacements that change no force.

Forces are unique. So a contact that carries one keeps its approach, one that carries none may open
and must not close further, and a radial element stays where its graph admits its force: at one
radius, on a level piece anywhere along it, or anywhere in the disc in which it carries nothing.
This set is convex if an arc that carries nothing is replaced by its tangent face. Source:
formulation, section 4.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.left_open import Round, held_by
from loadshare.contact.problem import ArcRow, of_unit_norm
from loadshare.contact.radial import RadialLaw
from loadshare.scene.scene import Scene
from loadshare.scene.statics import unresisted
from loadshare.solver.undetermined.norm import Norm, norm_of


@dataclass(frozen=True, eq=False)
class FreeSet:
    """Displacements of one equilibrium, relative to one of them.

    Attributes
    ----------
    scene : Scene
    norm : Norm
    x : ndarray, shape (n,)
        One of them [m].
    moves : ndarray, shape (n, d)
        Directions in lengths y in which they differ, orthonormal; no columns if x is the only one.
    vectors : ndarray, shape (k, n)
        Directions in coordinates that must not close further.
    rooms : ndarray, shape (k,)
        How far these may close from x [m].
    arcs : tuple of ArcRow
        Arcs that carry nothing.
    rounds : tuple of Round
    """

    scene: Scene
    norm: Norm
    x: Array
    moves: Array
    vectors: Array
    rooms: Array
    arcs: tuple[ArcRow, ...]
    rounds: tuple[Round, ...]


def free_set(
    scene: Scene,
    x: Array,
    forces: Mapping[str, float],
    pulls: Mapping[str, Array],
    laws: Mapping[str, RadialLaw],
) -> FreeSet:
    """Return the places of an equilibrium.

    Parameters
    ----------
    scene : Scene
    x : ndarray, shape (n,)
        One of them [m].
    forces : mapping of row name to float
        Contact forces [N].
    pulls : mapping of radial name to ndarray, shape (2,)
        Force along its offset [N].
    laws : mapping of radial name to RadialLaw
        Laws at the transmitted torques.
    """
    held, norm = held_by(scene, x, forces, pulls, laws), norm_of(scene)
    ties = [*scene.springs, *of_unit_norm(scene.stiffness), *held.ties]
    limits = [(along, room) for along, room in held.limits if np.isfinite(room)]
    return FreeSet(
        scene,
        norm,
        x,
        unresisted(np.array(ties).reshape(-1, scene.size) / norm.root),
        np.array([along for along, _ in limits]).reshape(-1, scene.size),
        np.array([room for _, room in limits]),
        tuple(held.arcs),
        tuple(r for r in held.rounds if np.isfinite(r.radius)),
    )
