"""Pictures of a pair over its mesh cycle: mesh stiffness and transmission error."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from loadshare.numbers import MICRORADIAN, Unit, significant
from loadshare.report.figure import Figure
from loadshare.report.figures import marks
from loadshare.report.figures.marks import axis, curves, hover, padded
from loadshare.report.palette import look
from loadshare.report.vega_lite import Drawing, Row, joined, panel
from loadshare.tooth.analysis.result import Ltca
from loadshare.tooth.analysis.tables import STIFFNESS_LOADS

WIDTH, HEIGHT = 400, 240
ERROR_LOADS = (1.0, 0.5, 0.1)
"""Parts of the rated torque at which the transmission error is shown."""
UNLOADED = "no load"


def stiffness(found: Ltca, title: str) -> Figure:
    """Draw the secant mesh stiffness over the mesh cycle at T, 0.95 T and 0.9 T.

    Parameters
    ----------
    found : Ltca
        Analysis with these loads.
    title : str
        Of the pair.

    Returns
    -------
    Figure
        One line for each load; the cycle is closed at phase 1.
    """
    values = {_name(part): found.secant(part) for part in STIFFNESS_LOADS}
    rated = values[_name(1.0)]
    unit = stiffness_unit(rated)
    drawn = _panel(found.phase, values, unit, "mesh stiffness at the driver")
    subtitle = [
        title,
        f"at T = {significant(found.rated)} N·m from {significant(unit.of(rated.min()))} to "
        f"{significant(unit.of(rated.max()))} {unit.name}, max/min "
        f"{rated.max() / rated.min():.3f}",
    ]
    return marks.figure("stiffness", drawn, "Mesh stiffness", subtitle)


def stiffness_unit(values: np.ndarray) -> Unit:
    """Return the unit in which stiffnesses [N·m/rad] are easiest to read."""
    return Unit("MN·m/rad", 1e-6) if values.max() >= 2e6 else Unit("kN·m/rad", 1e-3)


def transmission_error(found: Ltca, title: str) -> Figure:
    """Draw the transmission error over the mesh cycle, without load and loaded.

    Parameters
    ----------
    found : Ltca
        Analysis at 0.1, 0.5 and 1 of the rated torque.
    title : str
        Of the pair.

    Returns
    -------
    Figure
        Lead of the driver on the left, its variation about its mean on the right.
    """
    parts = found.torque / found.rated
    values = {_name(part): found.angle[:, np.argmin(np.abs(parts - part))] for part in ERROR_LOADS}
    values[UNLOADED] = found.unloaded_error
    varying = {name: angles - angles.mean() for name, angles in values.items()}
    panels = [
        _panel(found.phase, values, MICRORADIAN, "lead of the driver"),
        _panel(found.phase, varying, MICRORADIAN, "the same less its mean"),
    ]
    both = joined("hconcat", panels)
    swing = np.ptp(values[_name(1.0)])
    subtitle = [
        title,
        f"peak to peak {MICRORADIAN.of(np.ptp(found.unloaded_error)):.2f} µrad without load, "
        f"{MICRORADIAN.of(swing):.1f} µrad at T = {significant(found.rated)} N·m",
    ]
    return marks.figure("transmission_error", both, "Transmission error", subtitle)


def _panel(phase: np.ndarray, values: Mapping[str, np.ndarray], unit: Unit, what: str) -> Drawing:
    """Draw lines over the cycle, by name."""
    rows = list(_rows(phase, values, unit))
    looks = {name: look(k) for k, name in enumerate(values)}
    every = [row["y"] for row in rows]
    # Variation within round-off must not fill the panel.
    least = max(1e-3 * max(map(abs, every)), 1e-6)
    title = unit.title(what)
    y = axis("y:Q", title, padded(min(every), max(every), least))
    x = axis("x:Q", "phase of the mesh cycle", [0, 1])
    tooltip = hover(("name:N", "torque"), ("x:Q", "phase", ".3~f"), ("y:Q", title, ".5~g"))
    drawn = curves(rows, "name", looks, "torque", x=x, y=y, tooltip=tooltip)
    return panel(drawn, WIDTH, HEIGHT)


def _rows(phase: np.ndarray, values: Mapping[str, np.ndarray], unit: Unit) -> Iterable[Row]:
    """Yield the rows of every line, the first position once more at the end of the cycle."""
    for name, line in values.items():
        for x, y in zip([*phase, phase[0] + 1.0], [*line, line[0]], strict=True):
            yield {"name": name, "x": float(x), "y": unit.of(float(y))}


def _name(part: float) -> str:
    return "T" if part == 1.0 else f"{part:g} T"
