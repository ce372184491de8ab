r"""A convex region of few unknowns: half-planes and discs; its least point and its extremes.

.. math:: \{u : L u \le b,\; \lVert M_j u - m_j \rVert \le R_j\}

A second-order cone programme finds which bounds are reached; on these the point is then solved
exactly, as an equilibrium is (formulation, section 4). One unknown needs no programme.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np

from loadshare.array_types import Array, Numbers
from loadshare.contact.backends.clarabel_ import settings_of
from loadshare.scene.statics import unresisted
from loadshare.settings import PLACES


@dataclass(frozen=True, slots=True, eq=False)
class Disc:
    """‖M u − m‖ ≤ R.

    Attributes
    ----------
    matrix : ndarray, shape (2, d)
    centre : ndarray, shape (2,)
    radius : float
    """

    matrix: Array
    centre: Array
    radius: float

    def beyond(self, u: Array) -> float:
        """Return how far u lies outside."""
        return float(np.linalg.norm(self.matrix @ u - self.centre)) - self.radius

    def face(self, u: Array) -> tuple[Array, Array]:
        """Return the outward normal (d,) at u and its derivative (d, d)."""
        offset = self.matrix @ u - self.centre
        size = float(np.linalg.norm(offset))
        if size == 0.0:
            # At the centre of a disc that is almost a point, any direction will do.
            return self.matrix.T @ np.array([1.0, 0.0]), np.zeros((self.matrix.shape[1],) * 2)
        along = offset / size
        turning = (np.eye(2) - np.outer(along, along)) / size
        return self.matrix.T @ along, self.matrix.T @ turning @ self.matrix


@dataclass(frozen=True, eq=False)
class Region:
    """A region of d unknowns, in lengths of about one.

    Attributes
    ----------
    limits : ndarray, shape (k, d)
        L.
    bounds : ndarray, shape (k,)
        b.
    discs : tuple of Disc
    """

    limits: Array
    bounds: Array
    discs: tuple[Disc, ...]

    @property
    def size(self) -> int:
        """Number of unknowns d."""
        return int(self.limits.shape[1])

    @cached_property
    def cones(self) -> tuple[Any, Array, list[Any], Any]:
        """Rows, bounds and cones of the region as Clarabel takes them, and its settings."""
        import clarabel
        from scipy.sparse import csc_matrix

        rows, bounds = [self.limits], [self.bounds]
        cones: list[Any] = [clarabel.NonnegativeConeT(len(self.bounds))] if len(self.bounds) else []
        for disc in self.discs:
            rows += [np.zeros((1, self.size)), -disc.matrix]
            bounds += [np.array([disc.radius]), -disc.centre]
            cones.append(clarabel.SecondOrderConeT(3))
        settings = settings_of(PLACES.cone)
        return csc_matrix(np.vstack(rows)), np.concatenate(bounds), cones, settings

    def beyond(self, u: Array) -> float:
        """Return how far u lies outside; zero inside."""
        outside = [float((self.limits @ u - self.bounds).max(initial=0.0))]
        return max(*outside, *(disc.beyond(u) for disc in self.discs), 0.0)

    def least(self) -> Array:
        """Return the point of least norm, shape (d,); zero, outside, if round-off leaves none."""
        rest = np.zeros(self.size)
        if self.beyond(rest) <= 0.0:
            return rest
        if self.size == 1:
            low, high = self._interval()
            return np.array([min(max(0.0, low), high)])
        found = self._optimum(1.0, rest)
        return rest if found is None else found

    def furthest(self, direction: Array) -> Array | None:
        """Return the point furthest along a direction (d,), or None if nothing limits it."""
        if self.size == 1:
            low, high = self._interval()
            end = high if direction[0] > 0.0 else low
            return np.array([end]) if np.isfinite(end) else None
        along = self._ways_out.T @ direction
        if _pushed(self.limits @ self._ways_out, along) > PLACES.balanced:
            return None
        found = self._optimum(0.0, -direction)
        # Bounds that are nearly opposite meet so far away that round-off decides where.
        return None if found is None or float(direction @ found) > PLACES.far else found

    @cached_property
    def _ways_out(self) -> Array:
        """Moves (d, m) that no disc limits; those that no half-plane limits either have no end."""
        return unresisted(stacked((row for disc in self.discs for row in disc.matrix), self.size))

    def _interval(self) -> tuple[float, float]:
        """Return the ends of a region of one unknown."""
        slope = self.limits[:, 0]
        ends = self.bounds[slope != 0.0] / slope[slope != 0.0]
        rising = slope[slope != 0.0] > 0.0
        highs, lows = [*ends[rising], np.inf], [*ends[~rising], -np.inf]
        for disc in self.discs:
            along = disc.matrix[:, 0]
            square = float(along @ along)
            middle = float(along @ disc.centre) / square
            across = disc.centre - middle * along
            half = np.sqrt(max(disc.radius**2 - float(across @ across), 0.0) / square)
            lows.append(middle - half)
            highs.append(middle + half)
        low, high = max(lows), min(highs)
        # Bounds that touch may cross by round-off.
        return (low, high) if low <= high else (0.5 * (low + high),) * 2

    def _optimum(self, curvature: float, slope: Array) -> Array | None:
        """Return the u of least ½ curvature ‖u‖² + slope·u in the region; None if none is found."""
        found = _proposed(self, curvature, slope)
        if found is None:
            return None
        near, *pushes = found
        for rows, rounds in self._reached(near, curvature * near + slope, *pushes):
            exact = self._settled(near, curvature, slope, rows, rounds)
            if exact is not None:
                return exact
        return near

    def _reached(
        self, u: Array, slope: Array, limits: Array, discs: Array
    ) -> Iterator[tuple[Numbers, Numbers]]:
        """Yield guesses, rows and discs, of the bounds that an optimum near u reaches."""
        slack = self.bounds - self.limits @ u
        gap = np.array([-disc.beyond(u) for disc in self.discs])
        pushing = np.flatnonzero(limits > slack), np.flatnonzero(discs > gap)
        yield pushing
        yield self._holding(u, -slope, *pushing)
        yield np.flatnonzero(slack < PLACES.almost), np.flatnonzero(gap < PLACES.almost)

    def _holding(
        self, u: Array, pulled: Array, rows: Numbers, rounds: Numbers
    ) -> tuple[Numbers, Numbers]:
        """Return those of some bounds that hold a pull (d,) at u, no more than it takes."""
        from scipy.optimize import nnls

        normals = [*self.limits[rows], *(self.discs[j].face(u)[0] for j in rounds.tolist())]
        push = nnls(stacked(normals, self.size).T, pulled)[0] if normals else np.zeros(0)
        return rows[push[: len(rows)] > 0.0], rounds[push[len(rows) :] > 0.0]

    def _settled(
        self,
        u: Array,
        curvature: float,
        slope: Array,
        rows: Numbers,
        rounds: Numbers,
    ) -> Array | None:
        """Return the optimum if it reaches these bounds, by Newton's method; None otherwise."""
        faces, discs = self.limits[rows], [self.discs[j] for j in rounds.tolist()]
        d, count = self.size, len(rows) + len(discs)
        pushes, reached = np.zeros(count), faces
        for _ in range(PLACES.passes):
            normals, bends = [], curvature * np.eye(d)
            for disc, push in zip(discs, pushes[len(rows) :], strict=True):
                normal, turning = disc.face(u)
                normals.append(normal)
                bends = bends + max(push, 0.0) * turning
            reached = np.vstack([faces, np.array(normals).reshape(-1, d)])
            matrix = np.zeros((d + count, d + count))
            matrix[:d, :d], matrix[:d, d:], matrix[d:, :d] = bends, reached.T, reached
            misfit = [*(self.bounds[rows] - faces @ u), *(-disc.beyond(u) for disc in discs)]
            right = np.concatenate([-curvature * u - slope, misfit])
            step = np.linalg.lstsq(matrix, right, rcond=PLACES.inside)[0]
            u, pushes = u + step[:d], step[d:]
            if float(np.abs(step[:d]).max(initial=0.0)) <= PLACES.arrived * max(
                1.0, np.abs(u).max()
            ):
                break
        scale = max(1.0, float(np.abs(u).max()))
        pulled = -(curvature * u + slope)
        inside = self.beyond(u) <= PLACES.inside * scale
        # Bounds that contradict one another are not all reached.
        missed = [*(self.bounds[rows] - faces @ u), *(disc.beyond(u) for disc in discs)]
        met = float(np.abs(missed).max(initial=0.0)) <= PLACES.inside * scale
        return u if inside and met and _pushed(reached, pulled) <= PLACES.balanced * scale else None


def _pushed(reached: Array, pulled: Array) -> float:
    """Return how far a pull (d,) is from what bounds with outward normals (k, d) can hold."""
    from scipy.optimize import nnls

    if not reached.size:
        return float(np.abs(pulled).max(initial=0.0))
    return float(nnls(reached.T, pulled)[1])


def _proposed(region: Region, curvature: float, slope: Array) -> tuple[Array, Array, Array] | None:
    """Return an interior-point answer: point, pushes of half-planes, pushes of discs."""
    import clarabel

    d, k = region.size, len(region.bounds)
    if not k and not region.discs:
        return None if slope.any() else (np.zeros(d), np.zeros(0), np.zeros(0))
    bends, cones = _bends(curvature, d), region.cones
    answer = clarabel.DefaultSolver(bends, slope, *cones).solve()
    u, dual = np.array(answer.x), np.array(answer.z)
    if "DualInfeasible" in str(answer.status) or not np.isfinite([*u, *dual]).all():
        return None
    return u, dual[:k], dual[k::3]


@cache
def _bends(curvature: float, size: int) -> Any:
    from scipy.sparse import csc_matrix

    return csc_matrix(curvature * np.eye(size))


def stacked(rows: Iterable[Array], size: int) -> Array:
    """Stack rows (size,) into a matrix, also where there are none."""
    return np.array(list(rows)).reshape(-1, size)
