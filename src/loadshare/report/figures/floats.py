"""Where the floats rest: each centre in its region, true to shape and strongly enlarged."""

from __future__ import annotations

import math
from typing import Any

from loadshare.certify import Touch
from loadshare.errors import LoadshareError
from loadshare.numbers import MICROMETRE, engineering, read_best
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.labels import Labels
from loadshare.report.figures.marks import Panel, hover, path_rows
from loadshare.report.figures.paths import Point, arrow, circle
from loadshare.report.figures.region import CentreRegion, Journey
from loadshare.report.flanks import reaction_size
from loadshare.report.palette import FAINT, INK, SOFT, WARNING, Look, palette_of
from loadshare.report.vega_lite import Drawing, Row, joined, panel
from loadshare.report.words import boundary_name, direction_name, places_text
from loadshare.results import Result
from loadshare.train import Train

SIDE = 284
"""Side of a panel [px]: 75 mm at 96 px an inch, for which the magnification is given."""
SAME = 0.008
"""Points closer than this part of the panel's side are one point with several numbers."""
NUMBERED = 8
"""Number of points up to which all are numbered; of more, every fifth is."""


def floats(result: Result, train: Train) -> Figure:
    """Draw each float's centre in its region.

    Parameters
    ----------
    result : Result
    train : Train
        Train of the same case.

    Returns
    -------
    Figure
        One panel for each float, in µm and with equal scales: the region between the exact arcs
        and stops (formulation, section 6), the circles at which a spline begins to slip and has
        used up its clearance (section 5), the numbered places at the positions, the ring's
        reaction where it is largest, and in words where the float rests.

    Raises
    ------
    LoadshareError
        If no gear of the case floats.
    """
    gears = list(result.positions[0].floats)
    if not gears:
        raise LoadshareError(
            f"{result.stamp.case}: no gear floats, so there is nothing to draw. A gear floats with "
            'support = "free", on a spline, in a ring or in a bearing with clearance.'
        )
    palette = palette_of(result)
    journeys = [Journey(result, train, gear) for gear in gears]
    most = max(len(journey.subtitle) for journey in journeys)
    panels = [_Panel(journey, palette.gear(journey.gear)).chart(most) for journey in journeys]
    subtitle = [
        result.stamp.title or result.stamp.case,
        "grey: where the centre may be; points: where it is, with the numbers of the positions; "
        "arrow: reaction of the ring on the gear where it is largest",
    ]
    grid = joined("concat", panels, columns=3 if len(panels) != 4 else 2)
    return marks.figure("floats", grid, "Where the floats rest", subtitle)


class _Panel(Panel):
    """The picture of one float; everything it holds is in the panel's unit of length."""

    def __init__(self, journey: Journey, look: Look) -> None:
        self.journey, self.look = journey, look
        middle, half = journey.view
        self.unit = unit = engineering([half], "m")
        self.half = unit.of(half)
        low, high = (
            (unit.of(middle[0]) + side, unit.of(middle[1]) + side)
            for side in (-self.half, self.half)
        )
        names = [direction_name(v) for v in journey.result.frames[journey.gear]]
        titles = [unit.title(f"displacement along {name}") for name in names]
        super().__init__(low, high, titles, tickCount=5)
        self.labels = Labels(low, high, SIDE / (2.0 * self.half))
        self.places = self._here(journey.path)

    def chart(self, lines: int) -> Drawing:
        """Return the panel, with `lines` lines of words so that all plots begin at one height."""
        self._feel()
        layers = [
            *self._region(),
            *self._circles(),
            *self._origin(),
            *self._reaction(),
            *self._names(),
            # On top: what lies over a point would keep the pointer from it.
            *self._path(),
        ]
        subtitle = [*self.journey.subtitle, *[" "] * (lines - len(self.journey.subtitle))]
        title = {"text": f"Gear {self.journey.gear}", "subtitle": subtitle}
        return panel(layers, SIDE, SIDE, title=title)

    def _here(self, points: list[Point]) -> list[Point]:
        return [(self.unit.of(x), self.unit.of(y)) for x, y in points]

    def _feel(self) -> None:
        """Tell the labels what is drawn, before any is placed."""
        region = self.journey.region
        for boundary in region.boundaries if region else ():
            self.labels.avoid(self._here(boundary.path))
        for radius in self.journey.circles.values():
            self.labels.avoid(self._here(circle((0.0, 0.0), radius)))
        self.labels.avoid(self.places)
        self.labels.avoid(self._shaft())

    def _region(self) -> list[Any]:
        region: CentreRegion | None = self.journey.region
        if region is None:
            return []
        outlines = [
            row
            for number, piece in enumerate(region.pieces)
            for row in path_rows(self._here(piece), piece=number)
        ]
        touches = {boundary_name(t.name): t for t in self.journey.hardest_rest.boundaries}
        lines: list[Row] = []
        for boundary in region.boundaries:
            facts = _facts(boundary.name, touches.get(boundary.name))
            lines += path_rows(self._here(boundary.path), **facts)
        tooltip = hover(
            "boundary:N", ("margin:Q", "margin [µm]", ".3f"), ("force:Q", "force [N]", ".2f")
        )
        area = self.line(outlines, "piece", clip=True, filled=True, color=FAINT, stroke=FAINT)
        edges = self.line(lines, "boundary", tooltip, clip=True, color=INK, strokeWidth=1.6)
        return [*area, *edges]

    def _circles(self) -> list[Any]:
        rows = [
            row
            for name, radius in self.journey.circles.items()
            for row in path_rows(self._here(circle((0.0, 0.0), radius)), circle=name)
        ]
        style = {"clip": True, "color": SOFT, "strokeWidth": 1.2, "strokeDash": [5, 3]}
        return self.line(rows, "circle", hover("circle:N"), **style)

    def _origin(self) -> list[Any]:
        """Return a cross at the centre's place without displacement."""
        arm = 0.04 * self.half
        rows = [
            *path_rows([(-arm, 0.0), (arm, 0.0)], bar=1),
            *path_rows([(0.0, -arm), (0.0, arm)], bar=2),
        ]
        return self.line(rows, "bar", clip=True, color=SOFT, strokeWidth=1)

    def _path(self) -> list[Any]:
        journey = self.journey
        # Where points coincide, the uppermost lists the positions of all of them.
        called = {n: places_text(numbers) for _, numbers in self._spots() for n in numbers}
        rows = [
            {
                "x": x,
                "y": y,
                "order": k,
                "position": p.position,
                "called": called[p.position],
                "rests": rest.boundary or rest.state,
                "margin": None if rest.margin is None else MICROMETRE.of(rest.margin),
                "reaction": math.hypot(*rest.reaction),
                "spline": rest.spline,
            }
            for k, ((x, y), p, rest) in enumerate(
                zip(self.places, journey.positions, journey.rests, strict=True)
            )
        ]
        tooltip = hover(
            ("called:N", "position"),
            ("x:Q", self.unit.title("x"), ".3f"),
            ("y:Q", self.unit.title("y"), ".3f"),
            "rests:N",
            ("margin:Q", "margin [µm]", ".3f"),
            ("reaction:Q", "reaction of the ring [N]", ".2f"),
            *(["spline:N"] if journey.circles else []),
        )
        look = self.look
        return [
            *self.line(rows, clip=True, color=look.colour, strokeWidth=1, opacity=0.6),
            *self.points(rows, tooltip, filled=True, color=look.colour, shape=look.shape, size=55),
        ]

    def _shaft(self) -> list[Point]:
        """Return the path of the reaction's arrow; empty without a reaction."""
        reaction = self.journey.hardest_rest.reaction
        size = reaction_size(self.journey.positions[self.journey.hardest], self.journey.gear)
        if not size:
            return []
        x, y = self.places[self.journey.hardest]
        length = 0.45 * self.half
        tip = (x + length * reaction[0] / size, y + length * reaction[1] / size)
        return arrow((x, y), tip, 0.08 * self.half)

    def _reaction(self) -> list[Any]:
        shaft = path_rows(self._shaft())
        return self.line(shaft, clip=True, color=WARNING, strokeWidth=2, strokeCap="round")

    def _names(self) -> list[Any]:
        """Return the words in the picture; the most important come first, for the best places."""
        journey, labels = self.journey, self.labels
        shaft = self._shaft()
        if shaft:
            size = math.hypot(*journey.hardest_rest.reaction)
            labels.place(read_best(size, "N"), [shaft[1]], colour=WARNING)
        spots = self._spots() if len(self.places) > 1 else []
        for place, numbers in spots if len(spots) <= NUMBERED else spots[::5]:
            others = [other for other, _ in spots if other != place]
            labels.place(places_text(numbers), [place], gap=7.0, others=others, colour=INK)
        for boundary in journey.region.boundaries if journey.region else ():
            path = self._here(boundary.path)
            # Anywhere along the boundary, its middle before its ends.
            parts = [path[round(part * (len(path) - 1))] for part in (0.5, 0.3, 0.7, 0.1, 0.9)]
            inside = [p for p in parts if self._within(p)] or parts[:1]
            labels.place(boundary.name, inside, boundary.outward)
        for name, radius in journey.circles.items():
            ring = self._here(circle((0.0, 0.0), radius, 12))
            labels.place(name.split(" beyond")[0].split(" used")[0], ring)
        return labels.layers(self.x, self.y)

    def _within(self, point: Point) -> bool:
        return all(a <= v <= b for a, v, b in zip(self.low, point, self.high, strict=True))

    def _spots(self) -> list[tuple[Point, list[int]]]:
        """Return places with the numbers of their positions, coincident places as one."""
        spots: list[tuple[Point, list[int]]] = []
        for place, position in zip(self.places, self.journey.positions, strict=True):
            near = (n for spot, n in spots if math.dist(spot, place) <= SAME * 2.0 * self.half)
            numbers = next(near, None)
            if numbers is None:
                numbers = []
                spots.append((place, numbers))
            numbers.append(position.position)
        return spots


def _facts(name: str, touch: Touch | None) -> dict[str, Any]:
    if touch is None:
        return {"boundary": name, "margin": None, "force": None}
    # Round-off of a zero margin would read as a negative zero.
    margin = round(MICROMETRE.of(touch.margin), 6) + 0.0
    return {"boundary": name, "margin": margin, "force": touch.force}
