"""One float over the positions of a result, and the region in which its centre may move.

All lengths are in metres, in the gear's transverse frame, with the origin at the centre's place
without displacement. Arcs are the exact arcs of the rings, not the solver's tangent faces.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from loadshare.certify import FloatState
from loadshare.contact.radial import spline_law
from loadshare.numbers import MICROMETRE, significant
from loadshare.report.figures.paths import Point, circle
from loadshare.report.flanks import least_force
from loadshare.report.words import boundary_name, rest_lines, spline_lines
from loadshare.results import Position, Result
from loadshare.train import Train
from loadshare.train.placed import train_at
from loadshare.train.ring import DrumRing, RoundRing
from loadshare.train.situations import situation_of

ROWS = 121
"""Lines across a drum on which its width is computed."""
TOUCHING = 1e-13
"""Width [m] below which two arcs that cross only do so by round-off."""


@dataclass(frozen=True, slots=True)
class Boundary:
    """One boundary of a region.

    Attributes
    ----------
    name : str
        Name in the certificate, without that of the ring.
    path : list of (float, float)
        The part within the window [m].
    outward : (float, float)
        Unit vector out of the region at the middle of the path.
    """

    name: str
    path: list[Point]
    outward: Point


@dataclass(frozen=True, slots=True)
class CentreRegion:
    """Region in which a centre may be.

    Attributes
    ----------
    pieces : list of list of (float, float)
        Closed outlines [m]; one, unless errors pinch a drum. Empty if several limits hold a gear:
        their common region is not drawn.
    boundaries : list of Boundary
    """

    pieces: list[list[Point]]
    boundaries: list[Boundary]


def features(train: Train, gear: str) -> dict[str, float]:
    """Return the distance [m] from the gear's centre to each boundary of its limits, by name."""
    found: dict[str, float] = {}
    for limit in train.limits.get(gear, ()):
        if isinstance(limit, RoundRing):
            found[boundary_name(limit.name)] = limit.radius + float(np.linalg.norm(limit.offset))
            continue
        found |= {"upper stop": limit.up, "lower stop": limit.down}
        found |= {f"arc {n}": c for n, c in zip(limit.neighbours, limit.clearances, strict=True)}
    return found


def region(
    train: Train,
    gear: str,
    position: int,
    displacement: Mapping[str, tuple[float, float]],
    window: float,
) -> CentreRegion | None:
    """Return the region of a float at a position; None for a gear without limits.

    Parameters
    ----------
    train : Train
    gear : str
    position : int
        1-based; errors that turn may shift the arcs.
    displacement : mapping of gear to (float, float)
        Displacement of every gear [m]: the arcs move with the neighbours.
    window : float
        Half the side of the square in which the region is drawn [m].
    """
    train = train_at(train, position)
    found = [
        _disc(train, limit)
        if isinstance(limit, RoundRing)
        else _drum(train, limit, position, displacement, window)
        for limit in train.limits.get(gear, ())
    ]
    if not found:
        return None
    pieces = found[0].pieces if len(found) == 1 else []
    return CentreRegion(pieces, [edge for each in found for edge in each.boundaries])


def _disc(train: Train, ring: RoundRing) -> CentreRegion:
    x, y = (float(v) for v in train.gears[ring.gear].plane @ ring.offset)
    outline = circle((x, y), ring.radius)
    # It is labelled at the upper right, away from both axes.
    outward = (math.sqrt(0.5), math.sqrt(0.5))
    return CentreRegion([outline], [Boundary(boundary_name(ring.name), outline, outward)])


def _drum(
    train: Train,
    ring: DrumRing,
    position: int,
    displacement: Mapping[str, tuple[float, float]],
    window: float,
) -> CentreRegion:
    """Return the drum between the rings of two neighbours, line by line across it."""
    gear = train.gears[ring.gear]
    across = gear.plane @ ring.across
    along = np.array([across[1], -across[0]])

    def path(us: Any, vs: Any) -> list[Point]:
        points = np.multiply.outer(us, along) + np.multiply.outer(vs, across)
        return [(float(x), float(y)) for x, y in points]

    low, high = max(-ring.down, -window), min(ring.up, window)
    lines = low + (high - low) * np.arange(ROWS) / (ROWS - 1)
    whole = np.full(ROWS, window)
    situation = situation_of(train, position)
    arcs: list[tuple[str, float, np.ndarray]] = []
    for side, name in enumerate(ring.neighbours):
        exclusion = situation.arc(ring, side)
        moved = np.array(displacement[name]) @ train.gears[name].plane
        middle = gear.plane @ (moved - exclusion.start)
        radius = exclusion.distance - exclusion.clearance
        u, v = middle @ along, middle @ across
        left_over = radius**2 - (lines - v) ** 2
        outward = -1.0 if u < 0.0 else 1.0
        # A line that misses the neighbour's ring is bounded by the window alone.
        edge = u - outward * np.sqrt(np.maximum(left_over, 0.0))
        arcs.append((f"arc {name}", outward, np.where(left_over > 0.0, edge, outward * window)))
    left, right = (
        outward * np.min([whole, *(out * edge for _, out, edge in arcs if out == outward)], axis=0)
        for outward in (-1.0, 1.0)
    )
    open_ = right - left >= -TOUCHING
    at = {
        name: open_ & (edge == (left if outward < 0.0 else right)) & (np.abs(edge) < window)
        for name, outward, edge in arcs
    }
    closed = right < left
    left[closed] = right[closed] = (left[closed] + right[closed]) / 2
    boundaries = [
        Boundary(
            name,
            path((left if outward < 0.0 else right)[at[name]], lines[at[name]]),
            *path([outward], [0.0]),
        )
        for name, outward, _ in arcs
        if at[name].any()
    ]
    tick = 0.1 * window
    for name, limit, end, upward in (
        ("upper stop", ring.up, -1, 1.0),
        ("lower stop", -ring.down, 0, -1.0),
    ):
        if open_[end] and abs(limit) <= window:
            # Drawn a little beyond the drum: a drum without clearance has no width.
            ends = np.clip([left[end] - tick, right[end] + tick], -window, window)
            boundaries.append(Boundary(name, path(ends, [limit, limit]), *path([0.0], [upward])))
    rows = np.flatnonzero(open_)
    pieces = []
    for run in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if rows.size else ():
        outline = path(left[run], lines[run]) + path(right[run][::-1], lines[run][::-1])
        pieces.append([*outline, outline[0]])
    return CentreRegion(pieces, boundaries)


MILLIMETRES = 75.0
"""Width of a panel for which the magnification is given [mm]."""
WITHIN = 4.0
"""A boundary is in the picture if it is at most this many times as far as the float moved."""
LEAST = 1e-9
"""Half the side of a picture in which nothing has an extent [m]."""


@dataclass(frozen=True)
class Journey:
    """One float over the positions; lengths in metres, in the gear's transverse frame.

    Attributes
    ----------
    result : Result
    train : Train
    gear : str
    """

    result: Result
    train: Train
    gear: str

    @property
    def positions(self) -> tuple[Position, ...]:
        """Positions of the result."""
        return self.result.positions

    @cached_property
    def rests(self) -> list[FloatState]:
        """Rest at each position."""
        return [p.floats[self.gear] for p in self.positions]

    @cached_property
    def path(self) -> list[Point]:
        """Place at each position."""
        return [p.displacement[self.gear] for p in self.positions]

    @cached_property
    def hardest(self) -> int:
        """Index of the position with the largest reaction of the ring."""
        sizes = [math.hypot(*rest.reaction) for rest in self.rests]
        return sizes.index(max(sizes))

    @property
    def hardest_rest(self) -> FloatState:
        """Rest where the reaction of the ring is largest."""
        return self.rests[self.hardest]

    @cached_property
    def region(self) -> CentreRegion | None:
        """Region at the position with the largest reaction."""
        here = self.positions[self.hardest]
        return region(self.train, self.gear, here.position, here.displacement, 1.5 * self._reach)

    @cached_property
    def circles(self) -> dict[str, float]:
        """Radii, within the picture, at which the spline changes its stage, by description."""
        return {name: radius for name, radius in self._stages.items() if radius <= self._far}

    @cached_property
    def view(self) -> tuple[Point, float]:
        """Middle and half the side of the square that shows everything."""
        points = [*self.path, (0.0, 0.0)]
        if self.region:
            for piece in self.region.pieces or [edge.path for edge in self.region.boundaries]:
                points += piece
        for radius in self.circles.values():
            points += [(-radius, -radius), (radius, radius)]
        lows = [min(p[k] for p in points) for k in (0, 1)]
        highs = [max(p[k] for p in points) for k in (0, 1)]
        # Room for arrows and words on all sides.
        half = 0.68 * max(highs[0] - lows[0], highs[1] - lows[1])
        return ((lows[0] + highs[0]) / 2, (lows[1] + highs[1]) / 2), max(half, LEAST)

    @property
    def subtitle(self) -> list[str]:
        """Where the float rests, and how the picture is drawn, in words."""
        least = max(map(least_force, self.positions))
        factor = MILLIMETRES / 1e3 / (2.0 * self.view[1])
        enlarged = float(f"{factor:.2g}")
        stages = [n if n in self.circles else f"{n} (not shown)" for n in self._stages]
        outside = ", ".join(self._outside)
        return [
            *rest_lines(self.rests, [p.position for p in self.positions], least),
            *spline_lines(self.rests, least),
            *([", ".join(stages)] if stages else []),
            *([f"outside the picture: {outside}"] if outside else []),
            f"enlarged about {enlarged:,.0f} : 1 at a width of {MILLIMETRES:g} mm",
        ]

    @cached_property
    def _stages(self) -> dict[str, float]:
        """Radii at which the spline changes its stage, at its least and its most friction."""
        spline = self.train.splines.get(self.gear)
        if spline is None:
            return {}
        bounds = [rest.friction or 0.0 for rest in self.rests]
        radii: dict[str, float] = {}
        for bound in dict.fromkeys((min(bounds), max(bounds))):
            law = spline_law(spline.bending_stiffness, spline.stick_limit, spline.clearance, bound)
            for k, piece in enumerate(law.pieces[1:], start=1):
                what = {"slip": "slips beyond", "stop": "clearance used up at"}[piece.name]
                radii[f"{what} {_length(law.start(k))}"] = law.start(k)
        return radii

    @cached_property
    def _moved(self) -> float:
        return max(math.hypot(*place) for place in self.path)

    @cached_property
    def _around(self) -> dict[str, float]:
        """Distances of everything that bounds the float or marks a stage of its spline."""
        return features(self.train, self.gear) | self._stages

    @cached_property
    def _far(self) -> float:
        """Distance up to which boundaries and stages belong in the picture."""
        nearest = min((d for d in self._around.values() if d > 0.0), default=0.0)
        return WITHIN * max(self._moved, nearest)

    @cached_property
    def _reach(self) -> float:
        return max(self._moved, *(d for d in self._around.values() if d <= self._far), LEAST)

    @property
    def _outside(self) -> list[str]:
        distances = features(self.train, self.gear)
        return [f"{name} at {_length(d)}" for name, d in distances.items() if d > self._far]


def _length(value: float) -> str:
    return f"{significant(MICROMETRE.of(value), 3)} µm"
