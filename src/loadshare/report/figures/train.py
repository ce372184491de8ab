"""A drawing of the train that shows a wrong centre at once."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from loadshare.case import Case
from loadshare.case.content import Sections
from loadshare.errors import CaseError, LoadshareError
from loadshare.numbers import MILLIMETRE, significant
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.labels import Labels
from loadshare.report.figures.layout import (
    ELASTIC,
    FIXED,
    FLOATS,
    DrawnGear,
    DrawnMesh,
    DrawnTrain,
    layout_of,
)
from loadshare.report.figures.marks import Panel, heading, hover, path_rows
from loadshare.report.figures.paths import Point, arrow, corners
from loadshare.report.flanks import carrying
from loadshare.report.palette import INK, SOFT, WARNING
from loadshare.report.vega_lite import Drawing, Row, joined, panel
from loadshare.report.words import direction_name
from loadshare.results import Position, Result
from loadshare.train import Train, build_train
from loadshare.train.gear import Vector

WIDTH, HEIGHT = 620.0, 560.0
"""Room for a view [px]."""
SAME = 1.0
"""Centres that are closer than this are one on the drawing [px]."""
SENSE = math.radians(75.0)
"""Extent of the arrow of a running sense."""
HELD = {FIXED: "circle", ELASTIC: "diamond", FLOATS: "circle"}
"""Shapes of the centres, floating ones on top: they may be coaxial with others."""
CENTRE_LINES: dict[str, dict[str, Any]] = {
    "shaft": {"color": SOFT, "strokeWidth": 3, "opacity": 0.35},
    "fits": {"color": SOFT, "strokeWidth": 0.9, "strokeDash": [10, 3, 2, 3]},
    "misfit": {"color": WARNING, "strokeWidth": 3},
}


def train(case: Sections, result: Result | None = None) -> Figure:
    """Draw the train to scale, in mm.

    Parameters
    ----------
    case : Case or Draft
        A case, or what could be read of one: what does not fit is drawn in red, running senses and
        lines of action are left out.
    result : Result, optional
        Result of the case: its first position gives the loaded flanks. Without it, straight arrows
        are those of the drive flanks, whichever way the load acts; for a mesh without backlash,
        that of its only flank, which is the loaded one.

    Returns
    -------
    Figure
        The view along the axis of most gears, and one from the side where heights differ. Full
        circles are pitch circles, which touch where gears mesh as they should; dashed ones are base
        circles, to which the lines of action are tangent.

    Raises
    ------
    LoadshareError
        If no gear could be placed.
    """
    first = result.positions[0] if result else None
    train = _train_of(case)
    layout = layout_of(case, train, list(carrying(first)) if first else None)
    if not layout.bodies:
        raise LoadshareError("no gear has a centre that could be read, so nothing can be drawn")
    views = [_View(layout, frame, plan=k == 0) for k, frame in enumerate(layout.frames)]
    scale = min(view.scale for view in views)
    panels = [view.chart(scale) for view in views]
    subtitle = [
        case.title,
        "full circles: pitch circles; dashed: base circles; bent arrows: running sense",
        _pushes_text(first, train),
        "centres: filled on a bearing, diamond on an elastic bearing, ring floating",
        *(_misfit_text(pair) for pair in layout.pairs if not pair.fits),
    ]
    return marks.figure("train", joined("vconcat", panels), "The train", subtitle)


def _train_of(case: Sections) -> Train | None:
    if not isinstance(case, Case):
        return None
    try:
        return build_train(case)
    except CaseError:
        return None


def _pushes_text(first: Position | None, train: Train | None) -> str:
    turned = train is not None and any(mesh.named_backwards for mesh in train.meshes.values())
    which = "drive flanks (without backlash: loaded flanks)" if turned else "drive flanks"
    which = which if first is None else "flanks that carry"
    where = f" at position {first.position}" if first and first.train.count > 1 else ""
    return f"straight arrows: push of the {which}{where} on the driven gear"


def _misfit_text(pair: DrawnMesh) -> str:
    have, need = (significant(MILLIMETRE.of(v), 6) for v in (pair.distance, pair.needed))
    return (
        f"mesh {pair.name} does not fit: the centres are {have} mm apart, the radii need {need} mm"
    )


class _View(Panel):
    """The train seen along one direction; lengths in millimetres."""

    def __init__(self, layout: DrawnTrain, frame: Vector, *, plan: bool) -> None:
        self.layout, self.palette, self.frame, self.plan = layout, layout.palette, frame, plan
        self.bodies = layout.large_first
        reach = np.vstack([self._flat_array(b.circle(self.layout.reach(b))) for b in self.bodies])
        low, high = reach.min(axis=0), reach.max(axis=0)
        room = 0.04 * float(high[0] - low[0])
        names = [MILLIMETRE.title(direction_name(v)) for v in frame]
        low, high = ((float(x), float(y)) for x, y in (low - room, high + room))
        super().__init__(low, high, names, grid=False, tickCount=6 if plan else 4)

    @property
    def scale(self) -> float:
        """Pixels per millimetre at which the view fits."""
        wide, tall = self._extent
        return min(WIDTH / wide, HEIGHT / tall)

    @property
    def _extent(self) -> Point:
        return self.high[0] - self.low[0], self.high[1] - self.low[1]

    def chart(self, scale: float) -> Drawing:
        """Return the view at `scale` pixels per millimetre."""
        self.labels = Labels(self.low, self.high, scale)
        layers = [
            *self._circles(),
            *self._lines(),
            *(self._actions() if self.plan else []),
            *self._senses(),
            *self._names(),
            # On top: what lies over a centre would keep the pointer from it.
            *self._centres(),
        ]
        wide, tall = self._extent
        towards = direction_name(np.cross(self.frame[0], self.frame[1]))
        title = heading(f"Seen against {towards}")
        return panel(layers, scale * wide, scale * tall, title=title)

    def _flat_array(self, points: Vector) -> Vector:
        return np.asarray(MILLIMETRE.factor * points @ self.frame.T)

    def _flat(self, points: Vector) -> list[Point]:
        return [(float(x), float(y)) for x, y in np.atleast_2d(self._flat_array(points))]

    def _circles(self) -> list[Any]:
        hollow, full, dashed = list[Row](), list[Row](), list[Row]()
        for body in self.bodies:
            colour = self.palette.gear(body.name).colour
            inside = hollow if body.kind == "internal" else full
            for rows, radii in zip((inside, dashed), self.layout.radii(body), strict=True):
                for what, radius in radii.items():
                    points = self._flat(body.circle(radius))
                    label = f"gear {body.name}, {what}: radius {MILLIMETRE.of(radius):.4f} mm"
                    rows += path_rows(corners(points), circle=label, colour=colour)
                    self.labels.avoid(points)
        (tip,) = hover("circle:N")
        return [
            *self.line(hollow, "circle", tip, strokeWidth=1.3),
            *self.line(full, "circle", tip, strokeWidth=1.3, filled=True, fillOpacity=0.05),
            *self.line(dashed, "circle", tip, strokeWidth=1.3, strokeDash=[4, 3]),
        ]

    def _lines(self) -> list[Any]:
        """Return centre lines of meshes, and lines of shafts."""
        rows: dict[str, list[Row]] = {"shaft": [], "fits": [], "misfit": []}
        for first, second in self.layout.shafts:
            rows["shaft"] += path_rows(self._between(first, second), part=f"{first} {second}")
        for pair in self.layout.pairs:
            points = self._between(pair.driver, pair.driven)
            facts = {
                "mesh": pair.name,
                "angle": math.degrees(pair.angle),
                "distance": MILLIMETRE.of(pair.distance),
                "needed": MILLIMETRE.of(pair.needed),
            }
            kind = "fits" if pair.fits else "misfit"
            rows[kind] += path_rows(points, part=pair.name, **facts)
            self.labels.avoid(points)
        tooltip = hover(
            "mesh:N",
            ("angle:Q", "pressure angle [deg]", ".4f"),
            ("distance:Q", "distance [mm]", ".4f"),
            ("needed:Q", "distance needed [mm]", ".4f"),
        )
        return [
            layer
            for kind, own in rows.items()
            for layer in self.line(
                own, "part", None if kind == "shaft" else tooltip, **CENTRE_LINES[kind]
            )
        ]

    def _between(self, first: str, second: str) -> list[Point]:
        """Return the path from one gear's centre to another's."""
        return self._flat(np.array([self.layout.bodies[n].centre for n in (first, second)]))

    def _actions(self) -> list[Any]:
        """Return lines of action between their points of contact with the base circles."""
        rows: list[Row] = []
        head = 0.012 * (self.high[0] - self.low[0])
        pushes = [(pair, push) for pair in self.layout.pairs for push in pair.pushes]
        for pair, push in pushes:
            parts = [r * math.sin(pair.angle) for r in pair.pitch_radii]
            kinds = {self.layout.bodies[name].kind for name in (pair.driver, pair.driven)}
            if kinds != {"external"}:
                # A face gear has no base circle, and an internal one touches the line on the same
                # side as the pinion: the pinion's part is drawn both ways.
                parts = [min(parts)] * 2
            ends = [pair.pitch_point - parts[0] * push, pair.pitch_point + parts[1] * push]
            tail, tip = self._flat(np.array(ends))
            shaft = arrow(tail, tip, head)
            rows += path_rows(shaft, part=pair.name if push is pair.pushes[0] else pair.name + "'")
            self.labels.avoid(shaft)
        return self.line(rows, "part", color=INK, strokeWidth=1.5)

    def _senses(self) -> list[Any]:
        rows: list[Row] = []
        head = 0.014 * (self.high[0] - self.low[0])
        for body in self.bodies:
            if body.sense == 0 or not body.is_round(self.frame):
                continue
            internal = body.kind == "internal"
            radius = self.layout.reach(body) if internal else 0.72 * body.base_radius
            turn = body.sense * SENSE * (0.4 if internal else 1.0)
            bent = body.circle(radius, math.radians(100.0), turn)
            points = self._flat(bent)
            shown = [*points, *arrow(points[-9], points[-1], head)[1:]]
            self.labels.avoid(shown)
            colour = self.palette.gear(body.name).colour
            rows += path_rows(shown, gear=body.name, colour=colour)
        return self.line(rows, "gear", strokeWidth=1.8)

    def _centres(self) -> list[Any]:
        tooltip = hover("gear:N", "kind:N", ("centre:N", "centre [mm]"), "turns:N", "held:N")
        layers: list[Any] = []
        for held, shape in HELD.items():
            rows = [self._centre(body) for body in self.bodies if body.held == held]
            # A floating centre is a ring; white inside, so that hovering finds it.
            style = {"fill": "white" if held == FLOATS else INK, "stroke": INK}
            layers += self.points(rows, tooltip, shape=shape, size=60, strokeWidth=1.4, **style)
        return layers

    def _centre(self, body: DrawnGear) -> Row:
        ((x, y),) = self._flat(body.centre)
        still = "not" if body.role == "held" else "unknown"
        turns = {1: "counter-clockwise", -1: "clockwise", 0: still}[body.sense]
        return {
            "x": x,
            "y": y,
            "gear": body.name,
            "kind": f"{body.kind} {body.role}".strip(),
            "centre": ", ".join(f"{MILLIMETRE.of(v):.4f}" for v in body.centre),
            "turns": f"{turns} against {direction_name(body.axis)}",
            "held": body.held,
        }

    def _names(self) -> list[Any]:
        spots: dict[Point, list[str]] = {}
        for name, body in self.layout.bodies.items():
            (place,) = self._flat(body.centre)
            self.labels.avoid([place])
            # Coaxial gears share one label; a case may give their centres rounded.
            key = next((k for k in spots if math.dist(k, place) < SAME / self.labels.pixels), place)
            spots.setdefault(key, []).append(f"{name} ({body.role})" if body.role else name)
        for place, names in spots.items():
            others = [spot for spot in spots if spot != place]
            self.labels.place(", ".join(names), [place], gap=7.0, others=others, colour=INK)
        for pair in self.layout.pairs if self.plan else ():
            if not pair.fits:
                apart = MILLIMETRE.of(pair.distance - pair.needed)
                text = "too far apart" if apart > 0.0 else "too close"
                text = f"{significant(abs(apart), 3)} mm {text}"
                self.labels.place(text, self._flat(pair.pitch_point), colour=WARNING)
        return self.labels.layers(self.x, self.y, fontWeight="bold")
