"""Studies of a case on its page: facts, pictures and tables of each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial, singledispatch
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.case import Case
from loadshare.errors import LoadshareError
from loadshare.report.figure import Figure
from loadshare.study.critical import Critical
from loadshare.study.march import March
from loadshare.study.named import found_by, run_study
from loadshare.study.sensitivity import Sensitivity
from loadshare.study.sweep import sweep
from loadshare.study.tolerance.result import Tolerance
from loadshare.study.tolerance.study import tolerance
from loadshare.table import Table
from loadshare.view import Viewed

if TYPE_CHECKING:
    from loadshare.progress import Progress

LONG = "tolerance"
"""Kind of study that is run for a page only when it is asked for by name."""
POINTS = 61
"""Number of points of the sweep that is drawn behind critical values."""


@dataclass(frozen=True)
class StudyPart:
    """What a page shows of one study.

    Attributes
    ----------
    name : str
        Name of the table ``[study.NAME]``, or the one it was passed under.
    title : str
    facts : mapping of str to str
    figures : sequence of Figure
    tables : sequence of Table
    problems : sequence of str
        Questions that it could not answer.
    """

    name: str
    title: str
    facts: Mapping[str, str] = field(default_factory=dict)
    figures: Sequence[Figure] = ()
    tables: Sequence[Table] = ()
    problems: Sequence[str] = ()


def study_part(name: str, found: Viewed, case: Case) -> StudyPart:
    """Return what a page shows of a study that was run.

    Parameters
    ----------
    name : str
    found : Sweep, Critical, Sensitivity, March, Comparison, Fit or Tolerance
    case : Case
        The case of the study.
    """
    view = found._view()
    return StudyPart(
        name=name,
        title=f"{name}: {type(found).__name__.lower()}",
        facts={what: text for what, text in view.facts if text},
        figures=tuple(figure.begin() for figure in _figures(found, case)),
        tables=[table for table in view.tables if table.rows],
        problems=tuple(found._left_open()),
    )


def run_part(
    case: Case, name: str, *, kept: Path | None = None, progress: Progress | None = None
) -> StudyPart:
    """Run a study that a case holds; an error becomes part of the page, with what was found before.

    Parameters
    ----------
    case : Case
    name : str
        Name of the table ``[study.NAME]``.
    kept : Path, optional
        Folder with the samples of a tolerance study, which are not solved again.
    progress : Progress, optional
        Called as parts of the study are done.
    """
    try:
        if kept is not None:
            found: Viewed = tolerance(case, study=name, out=kept, progress=progress)
        else:
            found = found_by(partial(run_study, case, name, progress=progress))
        return study_part(name, found, case)
    except LoadshareError as error:
        kind = case.study[name].kind if name in case.study else "study"
        return StudyPart(name, f"{name}: {kind}", problems=str(error).splitlines())


def quick_studies(case: Case) -> list[str]:
    """Return the names of a case's studies that a page shows without being asked for them."""
    return [name for name, study in case.study.items() if study.kind != LONG]


@singledispatch
def _figures(found: Any, _: Case) -> Iterator[Figure]:
    """Yield the pictures of a study."""
    yield found.plot()


@_figures.register
def _(found: Critical, case: Case) -> Iterator[Figure]:
    """Yield where elements change, and Ω over the same inputs with these values marked."""
    yield found.plot()
    if not found.events:
        return
    unit = found.parameter.unit
    ends = (f"{value!r} {unit}".rstrip() for value in (found.start, found.stop))
    grid = {tuple(found.parameter.keys): ":".join((*ends, str(POINTS)))}
    swept = sweep(case, grid, positions=[found.events[0].position])
    yield swept.plot(events=found.marks())


@_figures.register
def _(found: Sensitivity, _: Case) -> Iterator[Figure]:
    yield found.plot()
    if found.omega != found.pair_omega:
        yield found.plot(over="group")


@_figures.register
def _(found: March, _: Case) -> Iterator[Figure]:
    if any(value is not None for p in found.result.positions for value in p.share.values()):
        yield found.plot()
    if found.result.positions[0].floats:
        yield found.result.plot.floats()


@_figures.register
def _(found: Tolerance, _: Case) -> Iterator[Figure]:
    for over in found.overs:
        if any(one.over == over for one in found.omega):
            yield found.plot(over="group" if over == "group" else "stage")
