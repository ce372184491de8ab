"""The place of least norm of an equilibrium, and the ranges of its undetermined coordinates.

Coordinates that move independently of one another are treated separately: each part is a convex
region of one or a few unknowns. A part's least and largest values are exact, also in round regions
and on level pieces. The outside of an open arc is not convex: there each arc is replaced by a face
behind which all of the float lies, and the values may be too far out by about the sagitta.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from loadshare.array_types import Array
from loadshare.contact.left_open import Round
from loadshare.contact.problem import Row
from loadshare.later import Later
from loadshare.scene.scene import Scene
from loadshare.settings import PLACES
from loadshare.solver.undetermined.free_set import FreeSet
from loadshare.solver.undetermined.region import Disc, Region
from loadshare.train.equilibrium import Range


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """The place of least norm that the forces of an equilibrium allow, and the ranges.

    Attributes
    ----------
    x : ndarray, shape (n,)
        The place of least norm [m]; the known one itself, if it is that.
    ranges : mapping of name to (float, float)
        Least and largest value of what the forces leave undetermined: [rad] of a gear's rotation,
        [m] of a displacement or slip; infinite where nothing limits it.
    """

    x: Array
    ranges: Mapping[str, Range]


def places(free: FreeSet) -> Places:
    """Return the place of least norm of an equilibrium, and what is undetermined.

    Parameters
    ----------
    free : FreeSet
        Its places (see `free_set`).
    """
    limits = [v[None] for v in free.vectors] + [a.relative for a in free.arcs]
    limits += [r.radial.matrix for r in free.rounds]
    parts = [_Part(free, moves) for moves in independent(free.moves, free.norm.root, limits)]
    moved = [part for part in parts if part.moves_to_least]
    x = free.x
    for part in moved:
        x = x + part.across @ (part.least - part.start) * part.unit
    if not moved:
        return Places(x, Later(lambda: _ranges(free, parts, x)))
    ranges = _ranges(free, parts, x)
    return Places(x, ranges) if ranges else Places(free.x, {})


def _ranges(free: FreeSet, parts: Sequence[_Part], x: Array) -> dict[str, Range]:
    """Return least and largest values of all reported quantities, around the least place x."""
    scene = free.scene
    least_play = PLACES.play * scene.length_unit() + PLACES.inside * float(
        np.abs(x).max(initial=0.0)
    )
    ranges: dict[str, Range] = {}
    for names, where, weights in _reported(scene):
        low = high = float(weights @ x[where])
        for part in parts:
            along = (weights / free.norm.root[where]) @ part.moves[where]
            if np.abs(weights @ part.moves[where]).max() > PLACES.loose:
                low, high = low - part.reach(-along), high + part.reach(along)
        if high - low > least_play:
            ranges |= {
                name: (shift + rate * low, shift + rate * high) for name, shift, rate in names
            }
    return ranges


def _reported(scene: Scene) -> Iterator[tuple[list[tuple[str, float, float]], list[int], Array]]:
    """Yield the reported quantities: names with constant and rate; coordinates; their weights."""
    one = np.ones(1)
    turned = {
        gear: moved
        for gear, moved in scene.displacement.items()
        if scene.train.gears[gear].is_tilted
    }
    across = {k for where in turned.values() for k in range(where.start, where.stop)}
    for k, coordinate in enumerate(scene.coordinates):
        turning = [
            (f"gear {gear} rotation", scene.turned[gear], r.rate)
            for gear, r in scene.rotation.items()
            if r.index == k
        ]
        if k not in across:
            yield turning or [(coordinate, 0.0, 1.0)], [k], one
    for name, where in turned.items():
        gear = scene.train.gears[name]
        for axis, weights in zip("xy", gear.plane @ gear.frame.T, strict=True):
            yield [(f"gear {name} {axis}", 0.0, 1.0)], [where.start, where.start + 1], weights


class _Part:
    """Moves that are independent of all others.

    Attributes
    ----------
    moves : ndarray, shape (n, d)
        Lengths y, orthonormal.
    unit : float
        Length [m] in which their shares u are counted.
    start, least : ndarray, shape (d,)
        u of the known place, and of the one of least norm.
    """

    def __init__(self, free: FreeSet, moves: Array) -> None:
        self.free, self.moves = free, moves
        self.across = moves / free.norm.root[:, None]
        limits = free.vectors @ self.across
        sizes = np.linalg.norm(limits, axis=1)
        met = sizes > PLACES.loose
        self.limits, rooms = limits[met] / sizes[met, None], free.rooms[met] / sizes[met]
        rounds = [
            r for r in free.rounds if np.linalg.norm(r.radial.matrix @ self.across) > PLACES.loose
        ]
        self.arcs = [
            a for a in free.arcs if np.linalg.norm(a.relative @ self.across) > PLACES.loose
        ]
        shares = moves.T @ free.norm.lengths(free.x)
        sizes_met = [*rooms, *(r.radius for r in rounds), float(np.abs(shares).max())]
        self.unit = max(*sizes_met, free.scene.length_unit())
        self.start = shares / self.unit
        self.bounds = rooms / self.unit + self.limits @ self.start
        self.discs = tuple(self._disc(r) for r in rounds)
        self.least = self._least()

    @property
    def moves_to_least(self) -> bool:
        """Whether the least place differs from the known one."""
        return float(np.abs(self.least - self.start).max()) > PLACES.inside

    def reach(self, direction: Array) -> float:
        """Return how far along a direction (d,) the part may move from its least place [m]."""
        end = self._around.furthest(direction)
        if end is None:
            return np.inf
        # A part that is pinched up to round-off stays where it is.
        pinched = self._around.beyond(end) > PLACES.almost
        return 0.0 if pinched else float(direction @ (end - self.least)) * self.unit

    def _disc(self, held: Round) -> Disc:
        radial, matrix = held.radial, held.radial.matrix @ self.across
        offset = radial.offset(self.free.x) / self.unit
        return Disc(matrix, matrix @ self.start - offset, held.radius / self.unit)

    def _least(self) -> Array:
        """Return the point of least norm.

        Faces of arcs are renewed starting from the least place behind wide faces, because the
        tangent faces of opposite arcs that nearly touch would let nothing pass; failing that, from
        the known place.
        """
        if self.arcs:
            u, arrived = self._renewed(self._wide(self.start).least(), inside=False)
            if arrived and self._region(self._faces(u)).beyond(u) <= PLACES.inside:
                return u
        return self._renewed(self.start, inside=True)[0]

    def _renewed(self, u: Array, *, inside: bool) -> tuple[Array, bool]:
        """Renew faces of arcs until the least point stays; return it, and whether it came to that.

        With `inside`, faces are moved so that the point at which they are renewed is behind them.
        """
        for _ in range(PLACES.renewals):
            region = self._region(self._faces(u), u if inside else None)
            found = region.least()
            if region.beyond(found) > PLACES.almost:
                # A part that is pinched up to round-off stays where it is.
                break
            arrived = not self.arcs or float(np.abs(found - u).max()) <= PLACES.inside
            u = found
            if arrived:
                return u, True
        return u, False

    @cached_property
    def _around(self) -> Region:
        """The region, with one face for each arc, behind which all of the float lies."""
        return self._wide(self.least)

    def _wide(self, inside: Array) -> Region:
        rest = np.zeros(self.free.scene.size)
        return self._region([arc.row(rest, wide=True) for arc in self.arcs], inside)

    def _faces(self, u: Array) -> list[Row]:
        """Return the tangent faces of arcs at a point u."""
        x = self._place(u)
        return [arc.row(x) for arc in self.arcs]

    def _place(self, u: Array) -> Array:
        """Return the coordinates x (n,) [m] of a point u."""
        moved: Array = self.across @ (u - self.start) * self.unit
        return self.free.x + moved

    def _region(self, faces: Sequence[Row], inside: Array | None = None) -> Region:
        """Return the region with faces of its arcs, moved if need be to have a point inside."""
        limits, bounds = [self.limits], [self.bounds]
        at = self.start if inside is None else inside
        x = self._place(at)
        for face in faces:
            limit = face.vector @ self.across
            size = float(np.linalg.norm(limit))
            if size > PLACES.loose and np.isfinite(face.gap):
                room = face.gap - float(face.vector @ x)
                room = room if inside is None else max(room, 0.0)
                limits.append(limit[None] / size)
                bounds.append(np.array([room / self.unit + float(limit @ at)]) / size)
        return Region(np.vstack(limits), np.concatenate(bounds), self.discs)


def independent(moves: Array, root: Array, limits: Iterable[Array]) -> Iterator[Array]:
    """Yield groups of moves (n, d) that nothing couples to the others.

    Parameters
    ----------
    moves : ndarray, shape (n, d)
        All of them, in lengths y, orthonormal.
    root : ndarray, shape (n,)
        Lengths per coordinate.
    limits : iterable of ndarray, shape (…, n)
        What limits them, in coordinates.
    """
    projector = moves @ moves.T
    together = np.abs(projector) > PLACES.loose
    for matrix in limits:
        meets = (np.abs(matrix / root @ projector) > PLACES.loose).any(axis=0)
        together |= np.outer(meets, meets)
    for _ in range(len(together).bit_length()):
        together = (together.astype(int) @ together) > 0
    left = together.diagonal().copy()
    while left.any():
        part = together[int(left.argmax())]
        left &= ~part
        values, vectors = np.linalg.eigh(projector * np.outer(part, part))
        yield vectors[:, values > 0.5]
