"""Pictures of torque and share, branch by branch and stage by stage.

One panel for each stage. A figure that changes over the positions is drawn as lines; one that does
not is drawn as bars, one for each branch, which say more than level lines.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

from loadshare.arguments import one_of
from loadshare.errors import LoadshareError
from loadshare.numbers import ALIKE, Unit, decimals, engineering, fixed
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import axis, heading
from loadshare.report.palette import SOFT, Look, palette_of
from loadshare.report.vega_lite import Channel, Drawing, Row, channel, layer, panel
from loadshare.results import Result

Mean = Literal["stage", "group"]

REST = "Not in a stage"
"""Title of the panel of meshes that belong to no stage."""
TICKS = 8
"""Positions up to which each has a tick."""
WIDTH, ROW = 300, 26
"""Width of a panel and height of a bar's row [px]."""


@dataclass(frozen=True)
class Reading:
    """The figure that is drawn for every branch.

    Attributes
    ----------
    field : str
        Field of the rows that holds it.
    title : str
        Title of the axis.
    places : int
        Decimals of its figures.
    least : float
        Least width of the axis, so that small differences do not look large.
    reference : float or None
        Value that the branches would have if they shared evenly, at which bars start; without one
        they start at 0.
    """

    field: str
    title: str
    places: int
    least: float
    reference: float | None


def torque(result: Result) -> Figure:
    """Draw the torque on every mesh's driver over the positions, one panel for each stage.

    Parameters
    ----------
    result : Result

    Returns
    -------
    Figure
        Lines, or bars with their figures where nothing changes over the positions.
    """
    unit, rows = _rows(result)
    torques = [row["torque"] for row in rows]
    reading = Reading(
        field="torque",
        title=unit.title("torque on the driver"),
        places=decimals(torques, significant=5),
        least=1e-3 * max(map(abs, torques), default=0.0) or 1.0,
        reference=None,
    )
    return _figure("torque", "Torque on every mesh", result, reading, unit, rows)


def share(result: Result, over: Mean = "stage") -> Figure:
    """Draw the load-sharing coefficient Ω of every branch over the positions, stage by stage.

    Parameters
    ----------
    result : Result
    over : {"stage", "group"}
        Mean to which the torque of a branch is compared: of its stage, or of its group, such as
        the two idlers of one pinion.

    Returns
    -------
    Figure
        Lines about Ω = 1, or bars with their figures where nothing changes over the positions.

    Raises
    ------
    LoadshareError
        If the case has no stages, or no branch carries load.
    ValueError
        If there is no such mean.
    """
    one_of("over", over, get_args(Mean))
    field = {"stage": "share", "group": "pair"}[over]
    unit, rows = _rows(result)
    if not any(row[field] is not None for row in rows):
        raise LoadshareError(
            f"{result.stamp.case}: has no load-sharing coefficient to draw: no loaded mesh is in "
            "a stage. Name the stages, as in [stages.I] meshes = [...]."
        )
    title = f"Ω, torque over the mean of its {over}"
    reading = Reading(field, title, places=4, least=0.01, reference=1.0)
    title = f"Load sharing, over the mean of the {over}"
    return _figure("share", title, result, reading, unit, rows)


def _rows(result: Result) -> tuple[Unit, list[Row]]:
    """Return the unit of the torques, and a row for each position and mesh."""
    unit = engineering([t for p in result.positions for t in p.torque.values()], "N·m")
    return unit, [
        {
            "mesh": mesh,
            "position": p.position,
            "torque": unit.of(torque),
            "share": p.share.get(mesh),
            "pair": p.pair_share.get(mesh),
        }
        for p in result.positions
        for mesh, torque in p.torque.items()
    ]


def stages_of(result: Result) -> dict[str, tuple[str, ...]]:
    """Return the meshes of every stage by its title, those of no stage last."""
    staged = {mesh for meshes in result.stages.values() for mesh in meshes}
    rest = tuple(mesh for mesh in result.positions[0].torque if mesh not in staged)
    if not result.stages:
        return {"All meshes": rest}
    panels = {f"Stage {name}": meshes for name, meshes in result.stages.items()}
    return panels | ({REST: rest} if rest else {})


def _figure(
    name: str, title: str, result: Result, reading: Reading, unit: Unit, rows: Sequence[Row]
) -> Figure:
    """Draw one panel for each stage, side by side; a mesh of no stage has no share.

    If a branch has no share at some positions, because nothing is carried, its line is broken.
    """
    palette = palette_of(result)
    hover = marks.hover(
        "mesh:N",
        "position:Q",
        ("torque:Q", unit.title("torque on the driver"), ".2f"),
        ("share:Q", "Ω over stage mean", ".5f"),
        ("pair:Q", "Ω over group mean", ".5f"),
    )
    panels = []
    for stage, meshes in stages_of(result).items():
        known = {r["mesh"] for r in rows if r[reading.field] is not None} & {*meshes}
        own = [r for r in rows if r["mesh"] in known]
        if not own:
            continue
        looks = {mesh: palette.mesh(mesh) for mesh in meshes}
        if _alike(own, reading.field):
            first = [r for r in own if r["position"] == own[0]["position"]]
            drawn = _bars(first, looks, reading, hover)
        else:
            drawn = _lines(own, looks, reading, hover)
        panels.append(drawn | {"title": heading(stage)})
    subtitle = [
        result.stamp.title or result.stamp.case,
        _same_everywhere(result, rows, reading.field),
    ]
    return marks.figure(name, marks.stages(panels), title, subtitle)


def _same_everywhere(result: Result, rows: Sequence[Row], field: str) -> str:
    """Say that a figure is the same at all positions, or at which position it is, or nothing."""
    positions = [p.position for p in result.positions]
    if len(positions) > 1:
        return f"the same at all {len(positions)} positions" if _alike(rows, field) else ""
    return f"position {positions[0]}" if positions[0] > 1 else ""


def _alike(rows: Sequence[Row], field: str) -> bool:
    by_mesh: dict[str, list[float | None]] = {}
    for row in rows:
        by_mesh.setdefault(row["mesh"], []).append(row[field])
    known = [[v for v in values if v is not None] for values in by_mesh.values()]
    if any(0 < len(some) < len(v) for some, v in zip(known, by_mesh.values(), strict=True)):
        return False
    size = max((abs(v) for values in known for v in values), default=0.0)
    return all(max(v) - min(v) <= ALIKE * size for v in known if v)


def _lines(
    rows: list[Row], looks: Mapping[str, Look], reading: Reading, hover: list[Any]
) -> Drawing:
    values = [row[reading.field] for row in rows if row[reading.field] is not None]
    if reading.reference is not None:
        values.append(reading.reference)
    field, domain = f"{reading.field}:Q", marks.padded(min(values), max(values), reading.least)
    y = axis(field, reading.title, domain, tickCount=6)
    spaced = {"zero": False, "padding": 12}
    there = sorted({row["position"] for row in rows})
    # In panels side by side, a few ticks would be at halves, and be written as whole numbers.
    ticks = {"values": there} if len(there) <= TICKS else {"tickMinStep": 1}
    x = axis("position:Q", "position", scale=spaced, format="d", grid=False, **ticks)
    missing = set(range(there[0], there[-1])) - {*there}
    # Where there is no answer a line is broken.
    none = [{"mesh": m, "position": at, reading.field: None} for m in looks for at in missing]
    rows = [*rows, *none]
    layers: list[Any] = []
    if reading.reference is not None:
        layers.append(_reference_rule(reading, y=y))
    layers += marks.curves(rows, "mesh", looks, "mesh", x=x, y=y, tooltip=hover, width=1.6, size=46)
    return panel(layers, WIDTH, 190)


def _bars(
    rows: list[Row], looks: Mapping[str, Look], reading: Reading, hover: list[Any]
) -> Drawing:
    values = [row[reading.field] for row in rows]
    start = reading.reference or 0.0
    low, high = min(*values, start), max(*values, start)
    domain = marks.padded(low, high, reading.least, share=0.22)
    if reading.reference is None:
        domain = [min(0.0, domain[0]) if low < 0.0 else 0.0, high * 1.25 if high > 0.0 else 1.0]
    names = [row["mesh"] for row in rows]
    shown = [
        {**row, "start": start, "text": fixed(row[reading.field], reading.places)} for row in rows
    ]
    x = axis(f"{reading.field}:Q", reading.title, domain, tickCount=5)
    y = channel("mesh:N", title=None, sort=names, axis={"domain": False, "ticks": False})
    scale = {"domain": names, "range": [looks[name].colour for name in names]}
    where = {"x": x, "y": y, "tooltip": hover}
    ends = {"x2": channel("start"), "color": channel("mesh:N", scale=scale, legend=None)}
    layers = [layer("bar", shown, where | ends, height=13)]
    # A value that is printed as the reference must not get onto its other side by round-off.
    below = [round(row[reading.field], reading.places) < start for row in shown]
    for is_below, align, dx in ((True, "right", -5), (False, "left", 5)):
        part = [row for row, its in zip(shown, below, strict=True) if its is is_below]
        if part:
            words = where | {"text": channel("text:N")}
            layers.append(layer("text", part, words, align=align, dx=dx, fontSize=10))
    if reading.reference is not None:
        layers.append(_reference_rule(reading, x=x))
    return panel(layers, WIDTH, ROW * len(rows))


def _reference_rule(reading: Reading, **where: Channel) -> Drawing:
    """Return a rule at the reference, on the values' axis: one of its own would begin at 0."""
    rows = [{reading.field: reading.reference}]
    return layer("rule", rows, where, color=SOFT, strokeWidth=1)
