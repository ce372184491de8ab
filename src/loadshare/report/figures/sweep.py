"""Pictures of a sweep: lines over one parameter, maps over two."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from loadshare.errors import LoadshareError
from loadshare.libraries import xr
from loadshare.numbers import Unit, engineering, printed_unit
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import (
    BREADTH,
    LETTER,
    TOP,
    axis,
    curves,
    heading,
    hover,
    padded,
    rules,
)
from loadshare.report.palette import WARNING, Look, Palette, ends_from_names, look
from loadshare.report.vega_lite import Drawing, Row, channel, joined, layer, panel

Event = tuple[float, str]

NAMED_BY = ("stage", "mesh", "float", "gear")
"""Dimensions of which each name is a line or a map."""
WIDTH, HEIGHT = 460, 280
MAP = 300
"""Side of a map [px]."""
LEAST = {"m": 1e-9, "rad": 1e-9, "N": 1e-3, "N·m": 1e-3}
"""Least range of an axis, SI: below it, round-off would look like a result."""
SHARE = 1e-4
"""The same, over the largest value."""


def sweep(
    data: xr.Dataset,
    show: str = "omega",
    *,
    names: Sequence[str] | None = None,
    position: int | None = None,
    events: Sequence[Event] = (),
) -> Figure:
    """Draw a figure over the parameters of a sweep.

    Parameters
    ----------
    data : xarray.Dataset
        Dataset of a sweep. The dimensions of ``status`` are the parameters, one or two; their
        coordinates have the attribute ``units``. The variable shown has these dimensions, and
        in addition any of ``position``, ``component`` (x, y: the size is shown), and one of
        ``stage``, ``mesh``, ``float``, ``gear`` with a line or map for each name; its attributes
        are ``units`` (SI) and ``long_name``. NaN marks what was not certified.
    show : str
        Variable: "omega", "pair_omega", "torque", "share", "pair_share", "displacement", "margin",
        "reaction" or any other of that form.
    names : sequence of str, optional
        Stages, meshes or floats to show; all by default.
    position : int, optional
        Position to show; by default the largest value over the positions.
    events : sequence of (float, str)
        Values of the one parameter at which something happens, and what.

    Returns
    -------
    Figure
        Lines with a rule for each event, or one map for each name.

    Raises
    ------
    LoadshareError
        If the dataset has no such variable or name, or not one or two parameters.
    """
    parameters = [str(d) for d in data["status"].dims] if "status" in data else []
    if len(parameters) not in (1, 2):
        raise LoadshareError(
            f"a sweep over {len(parameters)} parameters cannot be drawn. Allowed: 1 or 2, as the "
            "dimensions of its variable status"
        )
    shown = _shown(data, parameters, show, names, position)
    title = shown.axis
    subtitle = [str(data.attrs.get("title") or data.attrs.get("case", "")), _refused(data)]
    if len(parameters) == 1:
        drawing = _lines(data, shown, parameters[0], events)
    else:
        drawing = _maps(data, shown, parameters)
    return marks.figure(f"sweep_{show}", drawing, f"{title[:1].upper()}{title[1:]}", subtitle)


@dataclass(frozen=True)
class _Shown:
    """Values (name, parameters) in `unit`, and how they are named."""

    names: list[str]
    by: str
    values: np.ndarray
    unit: Unit
    title: str
    looks: dict[str, Look]
    least: float

    @property
    def axis(self) -> str:
        """Title of an axis of the values."""
        return self.unit.title(self.title)

    def domain(self, share: float) -> list[float]:
        """Return the range of an axis, with a margin over the range of the values."""
        finite = self.values[np.isfinite(self.values)]
        low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
        return padded(low, high, max(self.least, SHARE * max(abs(low), abs(high))), share)


def _shown(
    data: xr.Dataset,
    parameters: list[str],
    show: str,
    names: Sequence[str] | None,
    position: int | None,
) -> _Shown:
    if show not in data:
        there = ", ".join(str(n) for n, v in data.items() if set(parameters) < set(v.dims))
        if not there:
            raise LoadshareError("no point of the sweep has an answer, so nothing can be drawn")
        raise LoadshareError(f"the sweep has no variable {show!r}. Allowed: {there}")
    variable = data[show]
    title = str(variable.attrs.get("long_name", show))
    if "component" in variable.dims:
        variable = (variable**2).sum("component", skipna=False) ** 0.5
    if "position" in variable.dims:
        if position is not None:
            if position not in variable["position"].values:
                raise LoadshareError(f"the sweep has no position {position}")
            variable = variable.sel(position=position)
            title += f" at position {position}"
        elif variable.sizes["position"] > 1:
            variable = variable.max("position")
            title += ", largest over positions"
        else:
            variable = variable.isel(position=0)
    by = next((d for d in NAMED_BY if d in variable.dims), None)
    if by is None:
        variable, by = variable.expand_dims("name"), "name"
        known = [show]
    else:
        known = [str(n) for n in variable[by].values]
    wanted = _default_names(data, show, variable, by, known) if names is None else list(names)
    wrong = [name for name in wanted if name not in known]
    if wrong:
        raise LoadshareError(f"no {by} {', '.join(wrong)}. Allowed: {', '.join(known)}")
    values = variable.transpose(by, *parameters).values[[known.index(n) for n in wanted]]
    keep = [k for k in range(len(wanted)) if np.isfinite(values[k]).any()]
    if not keep:
        raise LoadshareError(f"the sweep has no value of {show} at any point: nothing can be drawn")
    si = str(data[show].attrs.get("units", "1"))
    unit = engineering(values[np.isfinite(values)], si)
    wanted = [wanted[k] for k in keep]
    looks = _looks(data, by, wanted)
    least = LEAST.get(si, 1e-6) * unit.factor
    return _Shown(wanted, by, values[keep] * unit.factor, unit, title, looks, least)


def _default_names(
    data: xr.Dataset, show: str, variable: xr.DataArray, by: str, names: list[str]
) -> list[str]:
    """Return the names shown by default: none that repeats another, or has nothing to show."""
    if show == "reaction" and "margin" in data:
        # Without a ring there is no reaction, and no margin either.
        return [n for n in names if bool(data["margin"].sel({by: n}).notnull().any())] or names
    if show == "displacement":
        # A gear on rigid bearings stays where it is.
        return [n for n in names if bool((variable.sel({by: n}) != 0.0).any())] or names
    if by != "stage" or "system" not in names:
        return names
    whole = variable.sel(stage="system").values
    others = [name for name in names if name != "system"]
    repeated = any(
        np.array_equal(variable.sel(stage=name).values, whole, equal_nan=True) for name in others
    )
    return others if repeated else names


def _looks(data: xr.Dataset, by: str, names: list[str]) -> dict[str, Look]:
    gears = [str(n) for n in data["gear"].values] if "gear" in data.coords else []
    meshes = [str(n) for n in data["mesh"].values] if "mesh" in data.coords else []
    palette = Palette(gears, ends_from_names(meshes, gears))
    if by == "mesh":
        return {name: palette.mesh(name) for name in names}
    if by in ("float", "gear"):
        return {name: palette.gear(name) for name in names}
    return {name: look(number) for number, name in enumerate(names)}


def _refused(data: xr.Dataset) -> str:
    refused = int((data["status"] != "certified").sum())
    return f"{refused} of {data['status'].size} points not certified" if refused else ""


def _parameter(data: xr.Dataset, name: str) -> tuple[np.ndarray, str]:
    """Return the values of a parameter as given, and the title of its axis."""
    units = str(data[name].attrs.get("units", ""))
    return data[name].values, Unit("" if units == "1" else printed_unit(units)).title(name)


def _lines(data: xr.Dataset, shown: _Shown, name: str, events: Sequence[Event]) -> Drawing:
    grid, title = _parameter(data, name)
    rows: list[Row] = [
        {"x": float(x), "y": float(y) if np.isfinite(y) else None, "name": line}
        for line, values in zip(shown.names, shown.values, strict=True)
        for x, y in zip(grid, values, strict=True)
    ]
    y_axis = axis("y:Q", shown.axis, shown.domain(0.08))
    x_axis = axis("x:Q", title, scale={"zero": False})
    tooltip = hover(("name:N", shown.by), ("x:Q", title), ("y:Q", shown.axis, ".6~g"))
    layers = curves(rows, "name", shown.looks, shown.by, x=x_axis, y=y_axis, tooltip=tooltip)
    if events:
        ends = [*grid, *(value for value, _ in events)]
        pixels = WIDTH / ((max(ends) - min(ends)) or 1.0)
        marked: list[Row] = [
            {"x": float(value), "text": text, "top": _clear(shown, grid, value, text, pixels)}
            for value, text in events
        ]
        event_tooltip = hover(("text:N", "event"), ("x:Q", title))
        layers += rules(marked, x_axis, pixels, tooltip=event_tooltip)
    return panel(layers, WIDTH, HEIGHT)


def _clear(shown: _Shown, grid: np.ndarray, at: float, text: str, pixels: float) -> float:
    """Return how far below its rule's upper end an event's words are clear of the lines [px]."""
    low, high = shown.domain(0.08)
    # Most words are on the left of their rule.
    near = at + np.linspace(-BREADTH, 0.2 * BREADTH, 5) / pixels
    rising = np.argsort(grid)
    lines = [np.interp(near, grid[rising], line[rising]) for line in shown.values]
    places = (high - np.concatenate(lines)) / (high - low) * HEIGHT
    length = LETTER * len(text) + TOP
    for top in np.arange(TOP, HEIGHT - length, TOP):
        if not ((places > top - TOP) & (places < top + length)).any():
            return float(top)
    return TOP


def _maps(data: xr.Dataset, shown: _Shown, parameters: list[str]) -> Drawing:
    (xs, x_title), (ys, y_title) = (_parameter(data, name) for name in parameters)
    x_edges, y_edges = _edges(xs), _edges(ys)
    colour = channel(
        "value:Q",
        title=textwrap.wrap(shown.axis, 36),
        # Light to dark in one direction, so that it can be read in grey.
        scale={"scheme": "tealblues", "domain": shown.domain(0.0), "nice": False},
        legend={"titleLimit": 240, "gradientLength": 200},
    )
    where: dict[str, Any] = {
        name: axis(f"{name}:Q", title, [float(e.min()), float(e.max())], grid=False)
        for name, title, e in (("x", x_title, x_edges), ("y", y_title, y_edges))
    }
    tooltip = hover(("a:Q", x_title), ("b:Q", y_title), ("value:Q", shown.axis, ".6~g"))
    where |= {"x2": channel("x2"), "y2": channel("y2"), "tooltip": tooltip}
    panels = []
    for name, values in zip(shown.names, shown.values, strict=True):
        certified: list[Row] = []
        refused: list[Row] = []
        for (i, j), value in np.ndenumerate(values):
            sides = {"x": x_edges[i], "x2": x_edges[i + 1], "y": y_edges[j], "y2": y_edges[j + 1]}
            cell = {k: float(v) for k, v in {**sides, "a": xs[i], "b": ys[j]}.items()}
            if np.isfinite(value):
                certified.append({**cell, "value": float(value)})
            else:
                refused.append({**cell, "value": None})
        # Each cell extends under the next ones, because seams would look like lines of the map.
        coloured = where | {"color": colour}
        layers = [layer("rect", certified, coloured, x2Offset=0.5, y2Offset=-0.5)]
        if refused:
            crossed = {"fillOpacity": 0, "stroke": WARNING, "strokeDash": [2, 2]}
            layers.append(layer("rect", refused, where, **crossed))
        called = name if name == "system" else f"{shown.by} {name}"
        title = heading(called[:1].upper() + called[1:])
        panels.append(panel(layers, MAP, MAP, title=title))
    return joined("concat", panels, columns=2)


def _edges(values: np.ndarray) -> np.ndarray:
    """Return the edges of cells around grid values: half-way between them, and at both ends."""
    values = np.asarray(values, dtype=float)
    if len(values) == 1:
        half = 0.5 * abs(values[0]) or 0.5
        return np.array([values[0] - half, values[0] + half])
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([values[:1], middle, values[-1:]])
