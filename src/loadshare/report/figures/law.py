"""Picture of the mesh laws: deformation over torque, and where each mesh works."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from loadshare.numbers import Unit, engineering
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.branches import stages_of
from loadshare.report.figures.marks import axis, channels, heading, hover
from loadshare.report.flanks import Flank, carrying
from loadshare.report.palette import SOFT, palette_of
from loadshare.report.vega_lite import Drawing, Row, channel, layer, panel
from loadshare.results import Result
from loadshare.train import Train
from loadshare.train.mesh import Mesh

POINTS = 60
"""Points of a curve."""


def law(result: Result, train: Train) -> Figure:
    """Draw the deformation at the driver over torque, with the points at which the meshes work.

    Parameters
    ----------
    result : Result
    train : Train
        Train of the same case.

    Returns
    -------
    Figure
        One panel for each stage: Δφ(T), gap included (formulation, section 3), a grey curve for
        each law and meshing position, a point for each mesh and position.
    """
    working = list(_working(result, train))
    torque_unit = engineering([row["torque"] for row in working], "N·m")
    angle_unit = engineering([row["angle"] for row in working], "rad")
    palette = palette_of(result)
    panels = []
    for title, meshes in stages_of(result).items():
        points = [row for row in working if row["mesh"] in meshes]
        reach = 1.15 * max((row["torque"] for row in points), default=0.0)
        if reach <= 0.0:
            continue
        curves = [_scaled(r, torque_unit, angle_unit) for r in _curves(train, meshes, reach)]
        shown = [_scaled(r, torque_unit, angle_unit) for r in points]
        looks = {mesh: palette.mesh(mesh) for mesh in meshes}
        drawn = _panel(curves, shown, channels("mesh", looks, "mesh"), torque_unit, angle_unit)
        panels.append(drawn | {"title": heading(title)})
    subtitle = [
        result.stamp.title or result.stamp.case,
        "grey: the law of a mesh at each meshing position; points: where it operates",
    ]
    return marks.figure("law", marks.stages(panels), "Deformation of the meshes", subtitle)


def _working(result: Result, train: Train) -> Iterator[Row]:
    """Yield the torque [N·m] and deformation at the driver [rad] of every loaded flank.

    A mesh without a loaded flank is where the law of its drive flank begins.
    """
    for p in result.positions:
        at = train.flank_positions(p.position)
        flanks = list(carrying(p))
        idle = train.meshes.keys() - {flank.mesh for flank in flanks}
        ends = [
            Flank(name, True, 0.0, mesh.named_backwards)
            for name, mesh in train.meshes.items()
            if name in idle
        ]
        for flank in (*flanks, *ends):
            mesh = train.meshes[flank.mesh]
            position = at[mesh.flank_name(flank.drive)]
            torque = flank.force * mesh.first_radius
            yield {
                "mesh": flank.mesh,
                "flank": flank.side,
                "position": p.position,
                "cycle": position + 1,
                "torque": torque,
                "angle": _deformation(mesh, position, torque, flank.drive),
            }


def _curves(train: Train, meshes: Sequence[str], reach: float) -> Iterator[Row]:
    """Yield every law of the meshes once, over torques [N·m] up to `reach`."""
    seen: dict[tuple[Any, float, float], int] = {}
    for name in meshes:
        mesh = train.meshes[name]
        for position in range(max(len(mesh.laws), len(mesh.gaps))):
            key = (mesh.law(position), mesh.gap(position, True), mesh.first_radius)
            if key in seen:
                continue
            curve = seen[key] = len(seen)
            for k in range(POINTS + 1):
                # Denser towards zero, where a Hertz law curves most.
                torque = reach * (k / POINTS) ** 2
                angle = _deformation(mesh, position, torque)
                yield {"curve": curve, "torque": torque, "angle": angle}


def _deformation(mesh: Mesh, position: int, torque: float, drive: bool = True) -> float:
    """Return Δφ(T) = a + bT + cT^(2/3) [rad at the driver], a the gap, without the backlash."""
    radius = mesh.first_radius
    compression = mesh.law(position).compression(torque / radius)
    gap = mesh.gap(position, drive) - (0.0 if drive else mesh.backlash)
    return (gap + compression) / radius


def _scaled(row: Row, torque: Unit, angle: Unit) -> Row:
    return row | {"torque": torque.of(row["torque"]), "angle": angle.of(row["angle"])}


def _panel(
    curves: list[Row], points: list[Row], by_mesh: dict[str, Any], torque: Unit, angle: Unit
) -> Drawing:
    # The axes end where the laws do: a number at the very end would push the panel's title up.
    reach, top = (max(row[name] for row in curves) for name in ("torque", "angle"))
    title = torque.title("torque on the driver")
    x = axis("torque:Q", title, [0.0, reach], tickCount=6)
    y = axis("angle:Q", angle.title("deformation at the driver"), [0.0, top])
    tooltip = hover(
        "mesh:N",
        "position:Q",
        ("cycle:Q", "position in the mesh cycle"),
        ("flank:N", "flank"),
        ("torque:Q", torque.title("torque on the flank"), ".2f"),
        ("angle:Q", angle.title("deformation"), ".3f"),
    )
    along = {"x": x, "y": y, "detail": channel("curve:N")}
    working = {"x": x, "y": y, **by_mesh, "tooltip": tooltip}
    layers = [
        layer("line", curves, along, color=SOFT, strokeWidth=1, opacity=0.7),
        layer("point", points, working, filled=True, size=44, opacity=0.9),
    ]
    return panel(layers, 300, 200)
