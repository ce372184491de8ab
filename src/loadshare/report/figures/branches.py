"""Branch by branch, stage by stage: what torque and share have in common.

One panel for each stage. A figure that changes over the positions is drawn as lines; one that does
not is drawn as bars, one for each branch, which say more than level lines.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from loadshare.report.figures.marks import (
    Drawing,
    Row,
    chart,
    curves,
    heading,
    padded,
)
from loadshare.report.palette import SOFT, Look, palette_of
from loadshare.report.units import Unit

if TYPE_CHECKING:
    from loadshare.results import Result

REST = "Not in a stage"
"""Title of the panel of meshes that belong to no stage."""
ALIKE = 1e-9
"""Relative difference between positions that is round-off."""
WIDTH, ROW = 300, 26
"""Width of a panel and height of a bar's row [px]."""


@dataclass(frozen=True)
class Reading:
    """What is drawn of every branch.

    Attributes
    ----------
    field : str
        Of the rows.
    title : str
        Of the axis.
    places : int
        Decimals of its figures.
    least : float
        Least width of the axis: what is smaller shall not look large.
    reference : float or None
        Value that the branches would have if they shared evenly.
    from_zero : bool
        Whether bars start at 0 rather than at the reference.
    """

    field: str
    title: str
    places: int
    least: float
    reference: float | None
    from_zero: bool


def branch_rows(result: Result, torque_unit: Unit) -> list[Row]:
    """One row for each position and mesh: torque in `torque_unit` and both coefficients."""
    return [
        {
            "mesh": mesh,
            "position": p.position,
            "torque": torque_unit.of(torque),
            "share": p.share.get(mesh),
            "pair": p.pair_share.get(mesh),
        }
        for p in result.positions
        for mesh, torque in p.torque.items()
    ]


def stages_of(result: Result) -> dict[str, tuple[str, ...]]:
    """Meshes of every stage by its title, those of no stage last."""
    staged = {mesh for meshes in result.stages.values() for mesh in meshes}
    rest = tuple(mesh for mesh in result.positions[0].torque if mesh not in staged)
    if not result.stages:
        return {"All meshes": rest}
    panels = {f"Stage {name}": meshes for name, meshes in result.stages.items()}
    return panels | ({REST: rest} if rest else {})


def branch_panels(
    result: Result,
    rows: Sequence[Row],
    stages: Mapping[str, Sequence[str]],
    reading: Reading,
    torque_unit: Unit,
) -> Drawing:
    """Return one panel for each stage, side by side.

    Parameters
    ----------
    result : Result
    rows : sequence of dict
        As `branch_rows` gives them.
    stages : mapping of title to meshes
    reading : Reading
    torque_unit : Unit
        Of the rows' torques.
    """
    import altair as alt

    palette = palette_of(result)
    hover = _hover(torque_unit)
    panels = []
    for title, meshes in stages.items():
        own = [r for r in rows if r["mesh"] in meshes and r[reading.field] is not None]
        if not own:
            continue
        looks = {mesh: palette.mesh(mesh) for mesh in meshes}
        if _alike(own, reading.field):
            first = [r for r in own if r["position"] == own[0]["position"]]
            panel = _bars(first, looks, reading, hover)
        else:
            panel = _lines(own, looks, reading, hover)
        panels.append(panel.properties(title=heading(title)))
    return alt.concat(*panels, columns=2).resolve_scale(color="independent", shape="independent")


def same_everywhere(result: Result, rows: Sequence[Row], field: str) -> str:
    """Words for a figure that is the same at several positions; empty otherwise."""
    count = len(result.positions)
    if count == 1:
        return (
            f"position {result.positions[0].position}" if result.positions[0].position > 1 else ""
        )
    return f"the same at all {count} positions" if _alike(rows, field) else ""


def _alike(rows: Sequence[Row], field: str) -> bool:
    by_mesh: dict[str, list[float]] = {}
    for row in rows:
        if row[field] is not None:
            by_mesh.setdefault(row["mesh"], []).append(row[field])
    size = max((abs(v) for values in by_mesh.values() for v in values), default=0.0)
    return all(max(v) - min(v) <= ALIKE * size for v in by_mesh.values())


def _hover(unit: Unit) -> list[Any]:
    import altair as alt

    return [
        alt.Tooltip("mesh:N", title="mesh"),
        alt.Tooltip("position:Q", title="position"),
        alt.Tooltip("torque:Q", title=unit.title("torque on the driver"), format=".2f"),
        alt.Tooltip("share:Q", title="Ω over stage mean", format=".5f"),
        alt.Tooltip("pair:Q", title="Ω over group mean", format=".5f"),
    ]


def _lines(
    rows: list[Row], looks: Mapping[str, Look], reading: Reading, hover: list[Any]
) -> Drawing:
    import altair as alt

    values = [row[reading.field] for row in rows]
    if reading.reference is not None:
        values.append(reading.reference)
    y = alt.Y(
        f"{reading.field}:Q",
        title=reading.title,
        scale=alt.Scale(domain=padded(min(values), max(values), reading.least), nice=False),
        axis=alt.Axis(tickCount=6),
    )
    x = alt.X(
        "position:Q",
        title="position",
        axis=alt.Axis(tickMinStep=1, format="d", grid=False),
        scale=alt.Scale(nice=False, zero=False, padding=12),
    )
    layers: list[Any] = []
    if reading.reference is not None:
        layers.append(_reference_rule(reading, y=y))
    layers += curves(rows, "mesh", looks, "mesh", x=x, y=y, tooltip=hover, width=1.6, size=46)
    return alt.layer(*layers).properties(width=WIDTH, height=190)


def _bars(
    rows: list[Row], looks: Mapping[str, Look], reading: Reading, hover: list[Any]
) -> Drawing:
    import altair as alt

    values = [row[reading.field] for row in rows]
    start = 0.0 if reading.from_zero else reading.reference or 0.0
    low, high = min(*values, start), max(*values, start)
    domain = padded(low, high, reading.least, share=0.22)
    if reading.from_zero:
        domain = [min(0.0, domain[0]) if low < 0.0 else 0.0, high * 1.25 if high > 0.0 else 1.0]
    names = [row["mesh"] for row in rows]
    shown = [{**row, "start": start, "text": _text(row[reading.field], reading)} for row in rows]
    x = alt.X(
        f"{reading.field}:Q",
        title=reading.title,
        scale=alt.Scale(domain=domain, nice=False),
        axis=alt.Axis(tickCount=5),
    )
    y = alt.Y("mesh:N", title=None, sort=names, axis=alt.Axis(domain=False, ticks=False))
    colours = alt.Color(
        "mesh:N",
        scale=alt.Scale(domain=names, range=[looks[name].colour for name in names]),
        legend=None,
    )
    base = chart(shown).encode(y=y)
    rule = _reference_rule(reading, x=x) if reading.reference is not None else None
    bars = base.mark_bar(height=13).encode(x=x, x2="start:Q", color=colours, tooltip=hover)
    # What is printed as the reference shall not stand on its other side by round-off.
    below = [round(row[reading.field], reading.places) < start for row in shown]
    left = [row for row, is_below in zip(shown, below, strict=True) if is_below]
    right = [row for row, is_below in zip(shown, below, strict=True) if not is_below]
    labels = [
        chart(part)
        .mark_text(align=align, dx=dx, fontSize=10)
        .encode(x=x, y=y, text="text:N", tooltip=hover)
        for part, align, dx in ((left, "right", -5), (right, "left", 5))
        if part
    ]
    return alt.layer(bars, *labels, *([rule] if rule else [])).properties(
        width=WIDTH, height=ROW * len(rows)
    )


def _reference_rule(reading: Reading, **channel: Any) -> Drawing:
    """Rule at the reference, in the channel of the values: an axis of its own would begin at 0."""
    rule = chart([{reading.field: reading.reference}]).mark_rule(color=SOFT, strokeWidth=1)
    return rule.encode(**channel)


def _text(value: float, reading: Reading) -> str:
    return f"{round(value, reading.places) + 0.0:.{reading.places}f}"
