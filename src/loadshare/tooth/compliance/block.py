"""Hexahedra of a few teeth with their rim, mapped from the outline of the tooth.

Each tooth's section is four blocks of quadrilaterals: the tooth above the waist (a line across the
fillets), the core under it, and the rim under the two halves of the root spaces.

::

        ┌─────┐           tip
        │ top │
     ───┤     ├───        root, waist
     C− │core │ C+
     ───┴─────┴───        free side of the rim, clamped

Farther away the rim goes on without teeth, in elements that grow longer, so that the cut sides
stand where the load is no longer felt. The section is swept over the face width. Every second node
of the grids is a vertex; the nodes between make the hexahedra curved (27 nodes), so a coarse mesh
follows involute and fillet closely.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.compliance.middle import MiddleSurface, under
from loadshare.tooth.geometry.body import Array

Index = NDArray[np.int64]
Key = tuple[object, ...]

GROWTH = 2.0
"""Ratio of the depths of neighbouring elements, from the root into the rim."""


@dataclass(frozen=True, slots=True)
class Divisions:
    """Elements of the mesh.

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
    """

    across: int = 4
    flank: int = 4
    fillet: int = 1
    root: int = 2
    rim: int = 3
    width: int = 10

    def coarser(self) -> Divisions:
        """Return the divisions of a tooth that carries no load; rim and width must fit."""
        return Divisions(2, max(2, self.flank // 2), 1, 1, self.rim, self.width)

    def levels(self, middle: MiddleSurface) -> Array:
        """The u of the nodes of the tooth, from the waist to the tip."""
        foot = middle.body.foot
        low = np.linspace(middle.waist, foot, 2 * self.fillet + 1)
        return np.concatenate([low, np.linspace(foot, 1.0, 2 * self.flank + 1)[1:]])

    def depths(self) -> Array:
        """Place of the nodes between root (0) and free side of the rim (1)."""
        ends = np.concatenate([[0.0], np.cumsum(GROWTH ** np.arange(self.rim))])
        ends /= ends[-1]
        nodes = np.arange(2 * self.rim + 1)
        return np.asarray(np.interp(nodes, nodes[::2], ends))

    def stations(self) -> Array:
        """The w of the nodes."""
        return np.linspace(0.0, 1.0, 2 * self.width + 1)


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """A mapped block of one section: names (a, b) of its grid nodes, points (a, b, w, 3)."""

    names: list[list[Key]]
    points: Array


@dataclass(frozen=True, eq=False)
class BlockMesh:
    """Teeth in hexahedra.

    Attributes
    ----------
    points : array (m, layers, 3)
        Section nodes on every layer [m].
    number : dict
        Section node of each name.
    quads : array (q, 3, 3)
        Section nodes of each quadrilateral.
    clamped : array (m,) of bool
        Section nodes on the rim's free side and on the cut sides.
    """

    points: Array
    number: dict[Key, int]
    quads: Index
    clamped: NDArray[np.bool_]

    @property
    def layers(self) -> int:
        """Node layers over the width."""
        return int(self.points.shape[1])

    def hexahedra(self) -> Index:
        """Nodes (element, 3, 3, 3) as section node · layers + layer."""
        first = np.arange(0, self.layers - 2, 2)
        layer = first[:, None] + np.arange(3)
        nodes = self.quads[None, :, :, :, None] * self.layers + layer[:, None, None, None, :]
        return nodes.reshape(-1, 3, 3, 3)


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
    number: dict[Key, int] = {}
    points: list[Array] = []
    quads: list[Index] = []
    ends = reach + np.cumsum([0, *bare])
    blocks = [
        block
        for k in range(-reach, reach + 1)
        for block in _tooth(middle, k, loaded if k == 0 else others)
    ]
    for first, last in pairwise(ends.tolist()):
        blocks.append(_bare_rim(middle, first + 1, last + 1, others))
        blocks.append(_bare_rim(middle, -last, -first, others))
    for block in blocks:
        ids = np.empty((len(block.names), len(block.names[0])), dtype=np.int64)
        for a, row in enumerate(block.names):
            for b, name in enumerate(row):
                if name not in number:
                    number[name] = len(points)
                    points.append(block.points[a, b])
                ids[a, b] = number[name]
        quads += [
            ids[a : a + 3, b : b + 3]
            for a in range(0, ids.shape[0] - 1, 2)
            for b in range(0, ids.shape[1] - 1, 2)
        ]
    floor = len(loaded.depths()) - 1
    cut = {("space", -int(ends[-1])), ("space", int(ends[-1]) + 1)}
    clamped = np.array([name[-1] == ("rim", floor) or name[:2] in cut for name in number])
    return BlockMesh(np.array(points), number, np.array(quads), clamped)


def _tooth(middle: MiddleSurface, k: int, n: Divisions) -> Iterable[Block]:
    """Blocks of tooth k."""
    body = middle.body
    w = n.stations()
    levels, depths = n.levels(middle), n.depths()
    t = np.linspace(0.0, 1.0, 2 * n.across + 1)
    turn = _turn(2.0 * np.pi * k / body.teeth)

    def sweep(low: Array, high: Array, at: Array) -> Array:
        return (1.0 - at)[..., None] * low + at[..., None] * high

    sides = {s: body.outline(levels[:, None], w[None, :], s) for s in (-1, 1)}
    top = sweep(sides[-1][None], sides[1][None], t[:, None, None])
    names = [[_in_tooth(k, i, j) for j in range(len(levels))] for i in range(len(t))]
    yield Block(names, top @ turn.T)

    waist = top[:, 0]
    core = sweep(waist[:, None], under(body, waist)[:, None], depths[None, :, None])
    names = [[_in_core(k, i, j) for j in range(len(depths))] for i in range(len(t))]
    yield Block(names, core @ turn.T)

    u = np.linspace(0.0, middle.waist, 2 * n.root + 1)
    for side in (-1, 1):
        root = body.outline(u[:, None], w[None, :], side)
        rim = sweep(root[:, None], under(body, root)[:, None], depths[None, :, None])
        edge = 0 if side < 0 else len(t) - 1
        names = [
            [_in_rim(k, side, i, j, len(u) - 1, edge) for j in range(len(depths))]
            for i in range(len(u))
        ]
        yield Block(names, rim @ turn.T)


def _bare_rim(middle: MiddleSurface, first: int, last: int, n: Divisions) -> Block:
    """The rim from one root space to another, without its teeth."""
    body, depths = middle.body, n.depths()
    pitch = 2.0 * np.pi / body.teeth
    space = body.outline(0.0, n.stations(), -1)
    sections = []
    for place in (first, 0.5 * (first + last), last):
        root = space @ _turn(pitch * place).T
        free = under(body, root)
        sections.append((1.0 - depths)[:, None, None] * root + depths[:, None, None] * free)
    starts: tuple[Key, ...] = (("space", first), ("bare", first), ("space", last))
    names = [[(*start, ("rim", j)) for j in range(len(depths))] for start in starts]
    return Block(names, np.array(sections))


def _in_tooth(k: int, i: int, j: int) -> Key:
    return ("tooth", k, i, ("level", j))


def _in_core(k: int, i: int, j: int) -> Key:
    return _in_tooth(k, i, 0) if j == 0 else ("core", k, i, ("rim", j))


def _in_rim(k: int, side: int, i: int, j: int, last: int, edge: int) -> Key:
    if i == last:
        return _in_core(k, edge, j)
    if i == 0:  # shared with the next tooth
        return ("space", k + (side > 0), ("rim", j))
    return ("root", k, side, i, ("rim", j))


def flank_name(level: int, across: int, side: int) -> Key:
    """Name of a node on a flank of tooth 0: its level, and the elements across the tooth."""
    return _in_tooth(0, 0 if side < 0 else 2 * across, level)


def middle_names(k: int, n: Divisions) -> list[Key]:
    """Names of the nodes on the middle surface of tooth k, from the rim's free side to the tip."""
    under_tooth = [_in_core(k, n.across, j) for j in range(2 * n.rim, 0, -1)]
    return under_tooth + [_in_tooth(k, n.across, j) for j in range(2 * (n.fillet + n.flank) + 1)]


def _turn(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
