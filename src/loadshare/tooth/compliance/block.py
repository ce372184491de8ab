"""Hexahedra of a few teeth with their rim, mapped from the outline of the tooth.

Each tooth's section is four blocks of quadrilaterals: the tooth above the waist (a line across the
fillets), the core under it, and the rim under the two halves of the root spaces.

::

        ┌─────┐           tip
        │ top │
     ───┤     ├───        root, waist
     C− │core │ C+
     ───┴─────┴───        free side of the rim, clamped

Farther away the rim continues without teeth, in ever longer elements, so that it is cut where the
load no longer has an effect. The section is swept over the face width. Every second node of the
grids is a vertex; the nodes between make the hexahedra curved (27 nodes), so a coarse mesh follows
involute and fillet closely.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.spatial import KDTree

from loadshare.tooth.compliance.middle import MiddleSurface, under
from loadshare.tooth.geometry.body import Array, turned

Index = NDArray[np.int64]

ONE_PLACE = 1e-7
"""Distance, over the size of a section, within which nodes of neighbouring blocks are merged."""


@dataclass(frozen=True, slots=True)
class Divisions:
    """Numbers of elements in the mesh.

    Attributes
    ----------
    across : int
        Across the tooth's thickness.
    flank, fillet : int
        Along the flank, and along the fillet above the waist.
    root : int
        Along half of a root space.
    rim : int
        Into the rim.
    width : int
        Over the face width.
    growth : float
        Ratio of the depths of neighbouring elements, from the root into the rim.
    """

    across: int = 4
    flank: int = 4
    fillet: int = 1
    root: int = 2
    rim: int = 3
    width: int = 10
    growth: float = 2.0

    def coarser(self) -> Divisions:
        """Return the divisions of a tooth that carries no load; rim and width must fit."""
        return replace(self, across=2, flank=max(2, self.flank // 2), fillet=1, root=1)

    def heights(self, middle: MiddleSurface) -> Array:
        """Return the z of a tooth's nodes, from the rim's free side to the tip."""
        below = middle.waist - self.depths()[:0:-1] * (1.0 + middle.waist)
        return np.concatenate([below, self.levels(middle)])

    def levels(self, middle: MiddleSurface) -> Array:
        """Return the u of the tooth's nodes, from the waist to the tip."""
        foot = middle.body.foot
        low = np.linspace(middle.waist, foot, 2 * self.fillet + 1)
        return np.concatenate([low, np.linspace(foot, 1.0, 2 * self.flank + 1)[1:]])

    def depths(self) -> Array:
        """Return the places of the nodes between root (0) and free side of the rim (1)."""
        ends = np.concatenate([[0.0], np.cumsum(self.growth ** np.arange(self.rim))])
        ends /= ends[-1]
        nodes = np.arange(2 * self.rim + 1)
        return np.asarray(np.interp(nodes, nodes[::2], ends))

    def stations(self) -> Array:
        """Return the w of the nodes."""
        return np.linspace(0.0, 1.0, 2 * self.width + 1)


@dataclass(frozen=True, eq=False)
class BlockMesh:
    """Hexahedral mesh of the teeth.

    Attributes
    ----------
    points : array (m, layers, 3)
        Section nodes on every layer [m].
    quads : array (q, 3, 3)
        Section nodes of each quadrilateral.
    clamped : array (m,) of bool
        Section nodes on the rim's free side and on the cut sides.
    teeth : dict of array (across, heights) of int
        Section nodes of each tooth by its number, from side −1 to side +1, and from the rim's free
        side to the tip.
    """

    points: Array
    quads: Index
    clamped: NDArray[np.bool_]
    teeth: dict[int, Index] = field(default_factory=dict)

    @property
    def layers(self) -> int:
        """Node layers over the width."""
        return int(self.points.shape[1])

    def over_width(self, nodes: Index) -> Index:
        """Return the nodes (..., layers) of section nodes on every layer."""
        return nodes[..., None] * self.layers + np.arange(self.layers)

    def hexahedra(self) -> Index:
        """Return the nodes (element, 3, 3, 3) as section node · layers + layer."""
        nodes = self.over_width(self.quads)
        first = range(0, self.layers - 2, 2)
        return np.concatenate([nodes[..., k : k + 3] for k in first])


def block_mesh(
    middle: MiddleSurface,
    teeth: int,
    bare: Sequence[int],
    loaded: Divisions,
    others: Divisions,
) -> BlockMesh:
    """Mesh an odd number of teeth around tooth 0.

    Parameters
    ----------
    middle : MiddleSurface
    teeth : int
        Number of teeth, odd.
    bare : sequence of int
        Lengths in pitches of the elements of bare rim on either side, from the teeth outwards.
    loaded, others : Divisions
        Of tooth 0 and of its neighbours; `rim` and `width` must agree.
    """
    reach = teeth // 2
    numbers = range(-reach, reach + 1)
    divisions = [loaded if k == 0 else others for k in numbers]
    columns = [_tooth(middle, k, n) for k, n in zip(numbers, divisions, strict=True)]
    rims = [
        _root(middle, k, side, n)
        for k, n in zip(numbers, divisions, strict=True)
        for side in (-1, 1)
    ]
    ends = (reach + np.cumsum([0, *bare])).tolist()
    for first, last in pairwise(ends):
        rims.append(_bare_rim(middle, (first + 1, 0.5 * (first + last) + 1, last + 1), others))
        rims.append(_bare_rim(middle, (-last, -0.5 * (first + last), -first), others))
    cuts = [_bare_rim(middle, (place,), others) for place in (-ends[-1], ends[-1] + 1)]
    blocks = [*columns, *rims, *cuts]
    points, grids = _merged(blocks)
    clamped = np.zeros(len(points), dtype=bool)
    for grid in grids:
        clamped[grid[:, 0]] = True
    for grid in grids[-len(cuts) :]:
        clamped[grid] = True
    quads = [sliding_window_view(grid, (3, 3))[::2, ::2] for grid in grids[: -len(cuts)]]
    return BlockMesh(
        points,
        np.concatenate([part.reshape(-1, 3, 3) for part in quads]),
        clamped,
        dict(zip(numbers, grids, strict=False)),
    )


def _merged(blocks: Sequence[Array]) -> tuple[Array, list[Index]]:
    """Merge blocks (a, b, layers, 3): section nodes (m, layers, 3), numbers (a, b) in each block.

    Nodes of different blocks at the same place become one node; those of one block never do,
    however thin a tip is.
    """
    points = np.concatenate([block.reshape(-1, *block.shape[2:]) for block in blocks])
    section = points[:, points.shape[1] // 2]
    near = KDTree(section).query_ball_point(section, ONE_PLACE * np.ptp(section))
    sizes = [block.shape[0] * block.shape[1] for block in blocks]
    own = np.repeat(np.arange(len(blocks)), sizes)
    first = [min(j for j in same if j == i or own[j] != own[i]) for i, same in enumerate(near)]
    used, number = np.unique(first, return_inverse=True)
    parts = np.split(number, np.cumsum(sizes)[:-1])
    grids = [part.reshape(block.shape[:2]) for part, block in zip(parts, blocks, strict=True)]
    return points[used], grids


def _tooth(middle: MiddleSurface, k: int, n: Divisions) -> Array:
    """Return tooth k with its core, from side −1 to side +1 and from the free side to the tip."""
    body, levels, w = middle.body, n.levels(middle), n.stations()
    low, high = (body.outline(levels[:, None], w[None, :], s) for s in (-1, 1))
    t = np.linspace(0.0, 1.0, 2 * n.across + 1)[:, None, None, None]
    top = (1.0 - t) * low + t * high
    core = _to_free_side(middle, top[:, 0], n)
    return turned(np.concatenate([core[:, :-1], top], axis=1), _pitches(middle, k))


def _root(middle: MiddleSurface, k: int, side: int, n: Divisions) -> Array:
    """Return the rim under half of a root space, on a side of tooth k."""
    u = np.linspace(0.0, middle.waist, 2 * n.root + 1)
    root = middle.body.outline(u[:, None], n.stations()[None, :], side)
    return turned(_to_free_side(middle, root, n), _pitches(middle, k))


def _bare_rim(middle: MiddleSurface, spaces: Sequence[float], n: Divisions) -> Array:
    """Return the rim from one root space to another, without its teeth."""
    root = middle.body.outline(0.0, n.stations(), -1)
    at = [turned(root, _pitches(middle, place)) for place in spaces]
    return _to_free_side(middle, np.array(at), n)


def _to_free_side(middle: MiddleSurface, root: Array, n: Divisions) -> Array:
    """Return rim points (a, depths, w, 3) under root points (a, w, 3), from the free side up."""
    depth = n.depths()[::-1, None, None]
    free = under(middle.body, root)
    return np.asarray((1.0 - depth) * root[:, None] + depth * free[:, None])


def _pitches(middle: MiddleSurface, number: float) -> float:
    """Return the angle of a number of pitches [rad]."""
    return 2.0 * np.pi * number / middle.body.gear.teeth
