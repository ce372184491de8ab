"""Pictures of the loaded flank: load on the contact lines, and contact pattern."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from loadshare.numbers import MILLIMETRE, counted, significant
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import axis, heading, hover
from loadshare.report.figures.paths import Point
from loadshare.report.palette import FAINT, SOFT
from loadshare.report.vega_lite import Channel, Row, channel, joined, layer, panel
from loadshare.tooth.analysis.result import LineLoad, Ltca
from loadshare.tooth.geometry.body import ToothBody

WIDTH, HEIGHT = 460, 230
SHADES = "tealblues"
"""Light to dark in one direction, so that it can be read in grey."""
MOST = 0.99
"""Part of the loaded length that the range of shades covers."""
BELOW = "99 % of the loaded length below"
STEPS = 65
"""Points of a profile."""


@dataclass(frozen=True, eq=False)
class Plane:
    """A flank rolled out flat: along the tooth, and along the profile from the fillet's end [m]."""

    foot: float
    length: float
    u: np.ndarray
    height: np.ndarray

    def at(self, uw: np.ndarray) -> np.ndarray:
        """Return the places (n, 2) [m] of flank coordinates (n, 2)."""
        return np.column_stack([self.length * uw[:, 1], np.interp(uw[:, 0], self.u, self.height)])

    @property
    def size(self) -> Point:
        """Length of the tooth and of its profile [m]."""
        return self.length, float(self.height[-1])


def plane_of(body: ToothBody, side: int) -> Plane:
    """Roll a flank of a tooth out flat."""
    u = np.linspace(body.foot, 1.0, STEPS)
    profile = body.outline(u, np.full(STEPS, 0.5), side)
    height = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    ends = body.outline(np.full(2, u[STEPS // 2]), np.array([0.0, 1.0]), side)
    return Plane(body.foot, float(np.linalg.norm(ends[1] - ends[0])), u, height)


def load_map(found: Ltca, planes: Sequence[Plane], title: str) -> Figure:
    """Draw the load per length on every contact line of the cycle, on the driver's flank.

    Parameters
    ----------
    found : Ltca
    planes : sequence of Plane
        The driver's flank and the driven gear's.
    title : str
        Of the pair.

    Returns
    -------
    Figure
        Every line in its place at its position of the cycle; grey where it carries nothing.
    """
    lines = _lines(found)
    rows = [row for number, line in lines for row in _ribbon(planes[0], number, line)]
    top = _top([line.per_length for _, line in lines], lines, 1e-3)
    where = _axes(planes[0])
    colour = _shades(["load per length", "[N/mm]"], top)
    bare = [row for row in rows if row["value"] == 0.0]
    loaded = [row for row in rows if row["value"] > 0.0]
    tooltip = hover("position:Q", ("pair:Q", "pair of teeth"), ("value:Q", "load [N/mm]", ".4~g"))
    ends = {**where, "x2": channel("x2"), "y2": channel("y2")}
    shown = ends | {"color": colour, "tooltip": tooltip}
    # Thin enough that the lines of neighbouring positions do not overlap.
    thick = float(np.clip(0.6 * HEIGHT / max(len(lines), 1), 2.0, 6.0))
    layers = [
        layer("rule", bare, ends, strokeWidth=1, color=SOFT, opacity=0.5),
        layer("rule", loaded, shown, strokeWidth=thick),
    ]
    subtitle = [
        title,
        f"contact lines of {counted(len(found.positions), 'position')} on the driver's flank at "
        f"{significant(found.rated)} N·m; {BELOW} {significant(top, 3)} N/mm",
    ]
    return marks.figure("load_map", panel(layers, WIDTH, HEIGHT), "Load on the flank", subtitle)


def contact_pattern(found: Ltca, planes: Sequence[Plane], title: str) -> Figure:
    """Draw the areas of contact over the cycle on both flanks, by their pressure.

    Parameters as for :func:`load_map`.

    Returns
    -------
    Figure
        One panel for each flank; the bands have the Hertzian width.
    """
    lines = [(number, line) for number, line in _lines(found) if line.loaded]
    top = _top([line.pressure for _, line in lines], lines, 1e-6)
    tooltip = hover(
        "position:Q", ("pair:Q", "pair of teeth"), ("value:Q", "pressure [MPa]", ".4~g")
    )
    panels = []
    for which, (name, plane) in enumerate(zip(("driver", "driven gear"), planes, strict=True)):
        rows = [row for number, line in lines for row in _band(plane, number, line, which)]
        shown = {
            **_axes(plane),
            "order": channel("order:Q"),
            "detail": channel("cell:N"),
            "color": _shades(["pressure", "[MPa]"], top),
            "tooltip": tooltip,
        }
        areas = layer("line", rows, shown, filled=True, interpolate="linear-closed", clip=True)
        called = heading(f"flank of the {name}")
        panels.append(areas | {"width": WIDTH, "height": HEIGHT, "title": called})
    subtitle = [
        title,
        f"areas of contact at {counted(len(found.positions), 'position')} and "
        f"{significant(found.rated)} N·m; {BELOW} {significant(top, 3)} MPa",
    ]
    return marks.figure("contact_pattern", joined("vconcat", panels), "Contact pattern", subtitle)


def _lines(found: Ltca) -> list[tuple[int, LineLoad]]:
    """Return the lines of all positions under the rated torque, with the position, from 1."""
    load = int(np.argmin(np.abs(found.torque - found.rated)))
    return [(k + 1, line) for k, row in enumerate(found.lines) for line in row[load]]


def _axes(plane: Plane) -> dict[str, Any]:
    """Return axes over the whole flank."""
    sizes = [MILLIMETRE.of(size) for size in plane.size]
    titles = ("along the tooth [mm]", "from the fillet to the tip [mm]")
    return {
        name: axis(f"{name}:Q", title, [0.0, size], grid=True, gridColor=FAINT)
        for name, title, size in zip("xy", titles, sizes, strict=True)
    }


def _top(
    values: Sequence[np.ndarray], lines: Sequence[tuple[int, LineLoad]], factor: float
) -> float:
    """Return the value below which most of the loaded length stays.

    A point at an edge of the flank may carry many times what the rest of the line does.
    """
    every = np.concatenate(values)
    length = np.concatenate([line.line.length * (line.force > 0.0) for _, line in lines])
    order = np.argsort(every)
    below = np.cumsum(length[order])
    return factor * float(every[order][np.searchsorted(below, MOST * below[-1])])


def _shades(title: list[str], top: float) -> Channel:
    """Return the channel of a shade from 0 to `top`; values above have the darkest."""
    scale = {"scheme": SHADES, "domain": [0.0, top], "nice": False, "clamp": True}
    legend = {"type": "gradient", "gradientLength": 160}
    return channel("value:Q", title=title, scale=scale, legend=legend)


def _edges(places: np.ndarray) -> np.ndarray:
    """Return the edges (n + 1, 2) of the cells of a line whose middles (n, 2) are given."""
    middle = 0.5 * (places[1:] + places[:-1])
    first, last = 2.0 * places[0] - middle[0], 2.0 * places[-1] - middle[-1]
    return np.vstack([first, middle, last])


def _ribbon(plane: Plane, number: int, line: LineLoad) -> Iterator[Row]:
    """Yield the cells of a line with their load."""
    edges = MILLIMETRE.factor * _edges(plane.at(line.line.driver_uw))
    for start, end, load in zip(edges, edges[1:], 1e-3 * line.per_length, strict=False):
        yield {
            **dict(zip(("x", "y", "x2", "y2"), map(_short, (*start, *end)), strict=True)),
            "value": _short(load),
            "position": number,
            "pair": line.line.pair,
        }


def _band(plane: Plane, number: int, line: LineLoad, which: int) -> Iterator[Row]:
    """Yield the corners of the cells of the area of contact, with their pressure."""
    uw = line.line.driven_uw if which else line.line.driver_uw
    edges = _edges(plane.at(uw))
    along = np.diff(edges, axis=0)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    across *= line.half_width[:, None] / np.linalg.norm(across, axis=1)[:, None]
    for k, wide in enumerate(across):
        if line.force[k] <= 0.0:
            continue
        corners = (edges[k] - wide, edges[k + 1] - wide, edges[k + 1] + wide, edges[k] + wide)
        for order, corner in enumerate(corners):
            yield {
                "x": _short(MILLIMETRE.of(corner[0])),
                "y": _short(MILLIMETRE.of(corner[1])),
                "order": order,
                "cell": f"{number}/{line.line.pair}/{k}",
                "value": _short(1e-6 * line.pressure[k]),
                "position": number,
                "pair": line.line.pair,
            }


def _short(value: float) -> float:
    return float(f"{value:.5g}")
