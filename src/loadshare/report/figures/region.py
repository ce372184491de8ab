"""The region in which a float's centre may move, as outlines to be drawn.

All of it in metres, in the gear's transverse frame, the centre's own place being the origin. Arcs
are the exact arcs of the rings, not the faces by which the solver approaches them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from loadshare.report.figures.marks import Point, circle
from loadshare.train import Train
from loadshare.train.ring import DrumRing, RoundRing

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
        As the certificate names it, without the ring.
    path : list of (float, float)
        The part within the window [m].
    outward : (float, float)
        Unit vector out of the region at the middle of the path.
    """

    name: str
    path: list[Point]
    outward: Point


@dataclass(frozen=True, slots=True)
class Region:
    """Where a centre may be.

    Attributes
    ----------
    pieces : list of list of (float, float)
        Closed outlines [m]; one, unless errors pinch a drum.
    boundaries : list of Boundary
    """

    pieces: list[list[Point]]
    boundaries: list[Boundary]


def features(train: Train, gear: str) -> dict[str, float]:
    """Distance [m] from the gear's centre to each boundary of its ring, by name."""
    ring = train.rings.get(gear)
    if ring is None:
        return {}
    if isinstance(ring, RoundRing):
        return {"ring": ring.radius + float(np.linalg.norm(ring.offset))}
    arcs = {f"arc {n}": c for n, c in zip(ring.neighbours, ring.clearances, strict=True)}
    return {"upper stop": ring.up, "lower stop": ring.down, **arcs}


def region(
    train: Train,
    gear: str,
    position: int,
    displacement: Mapping[str, tuple[float, float]],
    window: float,
) -> Region | None:
    """Region of a float at a position; None for a gear without a ring.

    Parameters
    ----------
    train : Train
    gear : str
    position : int
        1-based; errors that turn may shift the arcs.
    displacement : mapping of gear to (float, float)
        Of every gear [m]: the arcs move with the neighbours.
    window : float
        Half the side of the square in which the region is drawn [m].
    """
    ring = train.rings.get(gear)
    if ring is None:
        return None
    if isinstance(ring, RoundRing):
        return _disc(train, ring)
    return _drum(train, ring, position, displacement, window)


def _disc(train: Train, ring: RoundRing) -> Region:
    x, y = (float(v) for v in train.gears[ring.gear].frame @ ring.offset)
    outline = circle((x, y), ring.radius)
    # Named at the upper right, where neither axis stands.
    outward = (math.sqrt(0.5), math.sqrt(0.5))
    return Region([outline], [Boundary("ring", outline, outward)])


@dataclass(frozen=True, slots=True)
class _Disc:
    """Disc that a neighbour's ring keeps the centre out of: (along, across) and radius [m]."""

    name: str
    along: float
    across: float
    radius: float

    def chord(self, across: float) -> float | None:
        """Half the chord [m] on the line at `across`; None where the line misses the disc."""
        left = self.radius**2 - (across - self.across) ** 2
        return math.sqrt(left) if left > 0.0 else None


def _drum(
    train: Train,
    ring: DrumRing,
    position: int,
    displacement: Mapping[str, tuple[float, float]],
    window: float,
) -> Region:
    gear = train.gears[ring.gear]
    across = gear.frame @ ring.across
    along = np.array([across[1], -across[0]])
    situation = train.situation(position)
    discs = []
    for side, name in enumerate(ring.neighbours):
        exclusion = train.arc(ring, side, situation)
        moved = np.array(displacement[name]) @ train.gears[name].frame
        middle = gear.frame @ (moved - exclusion.start)
        radius = exclusion.distance - exclusion.clearance
        discs.append(_Disc(f"arc {name}", float(middle @ along), float(middle @ across), radius))

    def place(u: float, v: float) -> Point:
        x, y = u * along + v * across
        return float(x), float(y)

    low, high = max(-ring.down, -window), min(ring.up, window)
    rows = [_row(discs, low + (high - low) * k / (ROWS - 1), window) for k in range(ROWS)]
    pieces: list[list[Point]] = []
    for run in _runs(rows):
        left = [place(r.left, r.across) for r in run]
        right = [place(r.right, r.across) for r in run]
        pieces.append([*left, *reversed(right), left[0]])
    boundaries = []
    for disc in discs:
        on_left = disc.along < 0.0
        path = [
            place(r.left if on_left else r.right, r.across)
            for r in rows
            if r is not None and disc.name in (r.left_by, r.right_by)
        ]
        if path:
            boundaries.append(Boundary(disc.name, path, place(-1.0 if on_left else 1.0, 0.0)))
    tick = 0.1 * window
    for name, limit, row, sign in (
        ("upper stop", ring.up, rows[-1], 1.0),
        ("lower stop", -ring.down, rows[0], -1.0),
    ):
        if row is not None and abs(limit) <= window:
            # Drawn a little beyond the drum: a drum without clearance has no width.
            ends = (row.left - tick, row.right + tick)
            path = [place(max(min(u, window), -window), limit) for u in ends]
            boundaries.append(Boundary(name, path, place(0.0, sign)))
    return Region(pieces, boundaries)


@dataclass(frozen=True, slots=True)
class _Row:
    """Admissible stretch of a line across the drum, and what bounds it [m]."""

    across: float
    left: float
    right: float
    left_by: str
    right_by: str


def _row(discs: list[_Disc], across: float, window: float) -> _Row | None:
    left, right, left_by, right_by = -window, window, "", ""
    for disc in discs:
        half = disc.chord(across)
        if half is None:
            continue
        if disc.along < 0.0 and disc.along + half > left:
            left, left_by = disc.along + half, disc.name
        elif disc.along >= 0.0 and disc.along - half < right:
            right, right_by = disc.along - half, disc.name
    if right - left < -TOUCHING:
        return None
    if right < left:
        left = right = (left + right) / 2
    return _Row(across, left, right, left_by, right_by)


def _runs(rows: list[_Row | None]) -> list[list[_Row]]:
    """Consecutive admissible rows."""
    whole = groupby(rows, key=lambda row: row is not None)
    return [[row for row in run if row is not None] for there, run in whole if there]
