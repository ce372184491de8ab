"""Load-sharing coefficients."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from loadshare.errors import LoadshareError
from loadshare.report.figure import Figure
from loadshare.report.figures.branches import (
    REST,
    Reading,
    branch_panels,
    branch_rows,
    same_everywhere,
    stages_of,
)
from loadshare.report.figures.marks import heading
from loadshare.report.units import engineering

if TYPE_CHECKING:
    from loadshare.results import Result

Mean = Literal["stage", "group"]


def share(result: Result, over: Mean = "stage") -> Figure:
    """Load-sharing coefficient Ω of every branch over the positions, one panel for each stage.

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
        For another mean.
    """
    if over not in ("stage", "group"):
        raise ValueError(f"over = {over!r}: allowed are 'stage' and 'group'")
    field = {"stage": "share", "group": "pair"}[over]
    unit = engineering([t for p in result.positions for t in p.torque.values()], "N*m")
    rows = branch_rows(result, unit)
    if not any(row[field] is not None for row in rows):
        raise LoadshareError(
            f"{result.stamp.case}: has no load-sharing coefficient to draw: no loaded mesh is in "
            "a stage. Name the stages, as in [stages.I] meshes = [...]."
        )
    reading = Reading(
        field=field,
        title=f"Ω, torque over the mean of its {over}",
        places=4,
        least=0.01,
        reference=1.0,
        from_zero=False,
    )
    stages = {title: meshes for title, meshes in stages_of(result).items() if title != REST}
    panels = branch_panels(result, rows, stages, reading, unit)
    told = [result.stamp.title or result.stamp.case, same_everywhere(result, rows, field)]
    title = heading(f"Load sharing, over the mean of the {over}", told)
    return Figure("share", panels.properties(title=title))
