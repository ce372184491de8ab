"""All places of one equilibrium: the displacements that change no force.

Forces are unique. So a contact that carries one keeps its approach, one that carries none may open
and must not close further, and a radial element stays where its graph admits its force: at one
radius, on a level piece anywhere along it, or anywhere in the disc in which it carries nothing.
That is a convex set; an arc that carries nothing makes it so only as its tangent face. Source:
formulation, section 4.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.problem import ArcRow, of_unit_norm
from loadshare.contact.radial import RadialLaw
from loadshare.scene.scene import GearRadial, Scene
from loadshare.scene.statics import unresisted
from loadshare.settings import PLACES
from loadshare.solver.undetermined.norm import Norm, norm_of


@dataclass(frozen=True, slots=True, eq=False)
class Round:
    """A disc in which a radial element carries nothing: ‖P x − m‖ ≤ R.

    Attributes
    ----------
    radial : GearRadial
    radius : float
        R [m].
    """

    radial: GearRadial
    radius: float


@dataclass(frozen=True, eq=False)
class FreeSet:
    """Displacements of one equilibrium, about one of them.

    Attributes
    ----------
    scene : Scene
    norm : Norm
    x : ndarray, shape (n,)
        One of them [m].
    moves : ndarray, shape (n, d)
        Lengths y along which they differ, orthonormal; without columns if x is the only one.
    vectors : ndarray, shape (k, n)
        What must not close further, in coordinates.
    rooms : ndarray, shape (k,)
        How far these may close from x [m].
    arcs : tuple of ArcRow
        That carry nothing.
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
        [N].
    pulls : mapping of radial name to ndarray, shape (2,)
        Force along its offset [N].
    laws : mapping of radial name to RadialLaw
        At the torques that are transmitted.
    """
    every = [*(abs(f) for f in forces.values()), *(math.hypot(*p) for p in pulls.values())]
    carries = PLACES.carries * max([scene.force_unit(), *every])
    norm = norm_of(scene)
    ties = [*scene.springs, *of_unit_norm(scene.stiffness)]
    vectors: list[Array] = []
    rooms: list[float] = []
    open_arcs: list[ArcRow] = []
    for row in scene.rows:
        if forces.get(row.name, 0.0) > carries:
            ties.append(row.vector)
        else:
            # What counts as no force may be far into a soft contact.
            end = row.gap + row.law.compression(max(forces.get(row.name, 0.0), 0.0))
            vectors.append(row.vector)
            rooms.append(max(end - float(row.vector @ x), 0.0))
    for arc in scene.arcs:
        if forces.get(arc.name, 0.0) > carries:
            # Moved along it, it would push another way.
            ties += list(arc.relative)
        else:
            end = arc.arc.clearance + arc.law.compression(max(forces.get(arc.name, 0.0), 0.0))
            open_arcs.append(replace(arc, arc=replace(arc.arc, clearance=end)))
    rounds: list[Round] = []
    for radial in scene.radials:
        pull, law = pulls[radial.name], laws[radial.name]
        size = float(np.linalg.norm(pull))
        level = law.level(size, carries)
        if level is None:
            ties += list(radial.matrix)
        elif size <= carries and level[1] > 0.0:
            rounds.append(Round(radial, level[1]))
        elif size <= carries:
            # Without play it is a point.
            ties += list(radial.matrix)
        else:
            along = pull / size
            ties.append(np.array([-along[1], along[0]]) @ radial.matrix)
            radius = float(along @ (radial.matrix @ x - radial.centre))
            for sign, end in ((1.0, level[1]), (-1.0, level[0])):
                vectors.append(sign * along @ radial.matrix)
                rooms.append(max(sign * (end - radius), 0.0))
    bounded = np.isfinite(rooms)
    return FreeSet(
        scene,
        norm,
        x,
        unresisted(np.array(ties).reshape(-1, scene.size) / norm.root),
        np.array(vectors).reshape(-1, scene.size)[bounded],
        np.array(rooms)[bounded],
        tuple(open_arcs),
        tuple(r for r in rounds if np.isfinite(r.radius)),
    )
