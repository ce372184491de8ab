"""Torque on the driver of every mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

from loadshare.report.figure import Figure
from loadshare.report.figures.branches import (
    Reading,
    branch_panels,
    branch_rows,
    same_everywhere,
    stages_of,
)
from loadshare.report.figures.marks import heading
from loadshare.report.numbers import decimals
from loadshare.report.units import engineering

if TYPE_CHECKING:
    from loadshare.results import Result


def torque(result: Result) -> Figure:
    """Torque on the driver of every mesh over the positions, one panel for each stage.

    Parameters
    ----------
    result : Result

    Returns
    -------
    Figure
        Lines, or bars with their figures where nothing changes over the positions.
    """
    torques = [t for p in result.positions for t in p.torque.values()]
    unit = engineering(torques, "N*m")
    rows = branch_rows(result, unit)
    size = max((abs(row["torque"]) for row in rows), default=0.0)
    reading = Reading(
        field="torque",
        title=unit.title("torque on the driver"),
        places=decimals((row["torque"] for row in rows), significant=5),
        least=1e-3 * size or 1.0,
        reference=None,
        from_zero=True,
    )
    panels = branch_panels(result, rows, stages_of(result), reading, unit)
    told = [result.stamp.title or result.stamp.case, same_everywhere(result, rows, "torque")]
    return Figure("torque", panels.properties(title=heading("Torque on every mesh", told)))
