"""Shapes that a page draws: floats in their regions, the train with its forces."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.numbers import MICROMETRE, MILLIMETRE, read_best
from loadshare.report.figures.layout import DrawnGear, DrawnTrain, layout_of
from loadshare.report.figures.paths import Point, circle
from loadshare.report.figures.region import Journey
from loadshare.report.flanks import carrying, reaction_size
from loadshare.report.palette import Palette, palette_of
from loadshare.report.words import direction_name
from loadshare.results import Position, Result
from loadshare.train import Train, build_train
from loadshare.train.gear import Vector

Plain = dict[str, Any]
PLACES = 4
"""Decimals of lengths to draw, in µm or mm: far below a pixel."""


def float_shapes(result: Result, shown: Position) -> Iterator[Plain]:
    """Yield every float: its region at the shown position, and its centre at all positions.

    Lengths are in µm, in the gear's transverse frame, from the centre without displacement.
    """
    palette = palette_of(result)
    here = replace(result, positions=(shown,))
    for gear in shown.floats:
        journey = Journey(here, shown.train, gear)
        region, rest = journey.region, journey.rests[0]
        view = _square(journey.view, [p.displacement[gear] for p in result.positions])
        size = reaction_size(shown, gear)
        yield {
            "gear": gear,
            "colour": palette.gear(gear).colour,
            "axes": [direction_name(v) for v in result.frames[gear]],
            "view": [MICROMETRE.of(v) for v in view],
            "pieces": [_path(piece) for piece in region.pieces] if region else [],
            "edges": [[b.name, _path(b.path), list(b.outward)] for b in region.boundaries]
            if region
            else [],
            "circles": [
                [name, _path(circle((0.0, 0.0), r))] for name, r in journey.circles.items()
            ],
            "path": [_point(p.displacement[gear]) for p in result.positions],
            "here": _point(shown.displacement[gear]),
            "reaction": [v / size for v in rest.reaction] if size else None,
            "force": read_best(size, "N") if size else "",
            "lines": journey.subtitle[:-1],
        }


def _square(view: tuple[Point, float], path: list[Point]) -> tuple[float, float, float]:
    """Return the middle and half the side of a square that holds a view and, with room, a path."""
    middle, half = view
    lows = [min(m - half, *(1.1 * p[k] - 0.1 * m for p in path)) for k, m in enumerate(middle)]
    highs = [max(m + half, *(1.1 * p[k] - 0.1 * m for p in path)) for k, m in enumerate(middle)]
    x, y = (0.5 * (low + high) for low, high in zip(lows, highs, strict=True))
    return x, y, 0.5 * max(high - low for low, high in zip(lows, highs, strict=True))


def force_shapes(train: Train, shown: Position) -> Iterator[Plain]:
    """Yield every flank that carries: its force and, as a unit vector, its push on the driven gear.

    Parameters
    ----------
    train : Train
        In the places in which it is drawn, whatever has turned at the position.
    shown : Position
    """
    for flank in carrying(shown):
        mesh = train.meshes[flank.mesh]
        normal = mesh.drive_normal if flank.drive else mesh.coast_normal
        yield {
            "mesh": flank.mesh,
            "force": flank.force,
            "push": normal.round(6).tolist(),
            "text": f"{flank.where}, on gear {mesh.driven}: {read_best(flank.force, 'N')}",
        }


def train_shapes(case: Case) -> Plain | None:
    """Return the train to scale, seen along the axis of most gears and from the side, in mm.

    None if no train can be built, or no gear has a place.
    """
    try:
        train = build_train(case)
    except CaseError:
        return None
    layout = layout_of(case, train)
    if not layout.bodies:
        return None
    return {"views": [_view(layout, frame) for frame in layout.frames]}


def _view(layout: DrawnTrain, frame: Vector) -> Plain:
    bodies = layout.large_first
    reach = np.vstack([_flat(b.circle(layout.reach(b)), frame) for b in bodies])
    low, high = reach.min(axis=0), reach.max(axis=0)
    palette = layout.palette
    return {
        "title": f"Seen against {direction_name(np.cross(frame[0], frame[1]))}",
        "axes": [direction_name(v) for v in frame],
        "frame": frame.tolist(),
        "low": low.round(PLACES).tolist(),
        "high": high.round(PLACES).tolist(),
        "gears": [_gear(layout, palette, body, frame) for body in bodies],
        "shafts": [_line((layout.bodies[n].centre for n in ends), frame) for ends in layout.shafts],
        "meshes": [
            {"name": pair.name, "at": _line([pair.pitch_point], frame)[0]} for pair in layout.pairs
        ],
    }


def _gear(layout: DrawnTrain, palette: Palette, body: DrawnGear, frame: Vector) -> Plain:
    full, dashed = layout.radii(body)
    is_round = body.is_round(frame)
    return {
        "name": body.name,
        "colour": palette.gear(body.name).colour,
        "centre": _line([body.centre], frame)[0],
        "round": is_round,
        "full": [_ring(body, radius, frame, is_round) for radius in full.values()],
        "dashed": [_ring(body, radius, frame, is_round) for radius in dashed.values()],
        "held": body.held,
        "role": body.role,
        "sense": body.sense if is_round else 0,
    }


def _ring(body: DrawnGear, radius: float, frame: Vector, is_round: bool) -> Any:
    """Return the radius of a circle seen as one, or the path of one seen from the side."""
    if is_round:
        return round(MILLIMETRE.of(radius), PLACES)
    return _flat(body.circle(radius), frame).round(PLACES).tolist()


def _flat(points: Vector, frame: Vector) -> Vector:
    return np.asarray(MILLIMETRE.factor * points @ frame.T)


def _line(points: Iterable[Vector], frame: Vector) -> list[list[float]]:
    found: list[list[float]] = _flat(np.array(list(points)), frame).round(PLACES).tolist()
    return found


def _point(point: Point) -> list[float]:
    return [round(MICROMETRE.of(v), PLACES) for v in point]


def _path(points: Iterable[Point]) -> list[list[float]]:
    return [_point(p) for p in points]
