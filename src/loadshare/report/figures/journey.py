"""One float over the positions of a result, and what of its surroundings belongs in a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from loadshare.certify import FloatState
from loadshare.contact.radial import spline_law
from loadshare.report.figures.marks import Point
from loadshare.report.figures.region import Region, features, region
from loadshare.report.figures.rest import rest_told, spline_told
from loadshare.report.numbers import significant
from loadshare.report.units import MICROMETRE
from loadshare.results import Position, Result
from loadshare.train import Train

MILLIMETRES = 75.0
"""Width of a panel for which the enlargement is told [mm]."""
WITHIN = 4.0
"""A boundary up to so many times as far as the float moved is in the picture."""
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
    def region(self) -> Region | None:
        """Region at the position with the largest reaction."""
        here = self.positions[self.hardest]
        return region(self.train, self.gear, here.position, here.displacement, 1.5 * self._reach)

    @cached_property
    def circles(self) -> dict[str, float]:
        """Radii, within the picture, at which the spline changes its stage, by what they are."""
        return {name: radius for name, radius in self._stages.items() if radius <= self._far}

    @cached_property
    def view(self) -> tuple[Point, float]:
        """Middle and half the side of the square that shows it all."""
        points = [*self.path, (0.0, 0.0)]
        for piece in self.region.pieces if self.region else ():
            points += piece
        for radius in self.circles.values():
            points += [(-radius, -radius), (radius, radius)]
        lows = [min(p[k] for p in points) for k in (0, 1)]
        highs = [max(p[k] for p in points) for k in (0, 1)]
        # Room for arrows and words on all sides.
        half = 0.68 * max(highs[0] - lows[0], highs[1] - lows[1])
        return ((lows[0] + highs[0]) / 2, (lows[1] + highs[1]) / 2), max(half, LEAST)

    @property
    def told(self) -> list[str]:
        """Where the float rests, and how the picture is drawn, in words."""
        factor = MILLIMETRES / 1e3 / (2.0 * self.view[1])
        enlarged = float(f"{factor:.2g}")
        stages = [n if n in self.circles else f"{n} (not shown)" for n in self._stages]
        outside = ", ".join(self._outside)
        return [
            *rest_told(self.rests, [p.position for p in self.positions]),
            *spline_told(self.rests),
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
        """Distance up to which what is around belongs in the picture."""
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
