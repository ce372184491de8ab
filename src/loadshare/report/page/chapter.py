"""One case of a page: solved, drawn and put into tables."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare.case import Case, load_case
from loadshare.case.reader import load_draft
from loadshare.errors import CaseError, LoadshareError, Refused
from loadshare.job import solve
from loadshare.numbers import NONE, omega, small
from loadshare.progress import Progress
from loadshare.report import records, tables
from loadshare.report.figure import Figure
from loadshare.report.figures.train import train as draw
from loadshare.report.page.inputs import input_tables
from loadshare.report.plots import Plots
from loadshare.report.teeth import teeth_tables
from loadshare.report.verdict import trust, verdict_tables
from loadshare.results import Result
from loadshare.study.sweep import CERTIFIED, PARTLY, REFUSED
from loadshare.table import Cell, Table, table

if TYPE_CHECKING:
    from loadshare.report.page.studies import StudyPart

UNUSABLE = "cannot be used"


@dataclass(frozen=True)
class Chapter:
    """Everything that a page shows of one case.

    Attributes
    ----------
    file : str
        As the user named it; empty for a case that was made in Python.
    title : str
    outcome : str
        "certified", "partly refused", "refused" or "cannot be used".
    verdict : str
        The outcome in a sentence.
    problems : list of str
        What is wrong with the case, or why positions were refused.
    case : Case or None
    result : Result or None
        Result of the certified positions.
    drawing : Figure or None
    figures : sequence of Figure
    summary : sequence of Table
        Tables of the first screen.
    trust : mapping of str to str
        How far the answer can be trusted, and what it rests on.
    tables, inputs, derived : sequence of Table
    studies : sequence of StudyPart
        Studies of the case that were run or passed in.
    changes : sequence of str
        Changes to the file, as ``--set`` takes them.
    """

    file: str
    title: str
    outcome: str
    verdict: str
    problems: list[str]
    case: Case | None = None
    result: Result | None = None
    drawing: Figure | None = None
    figures: Sequence[Figure] = ()
    summary: Sequence[Table] = ()
    trust: Mapping[str, str] = field(default_factory=dict)
    tables: Sequence[Table] = ()
    inputs: Sequence[Table] = ()
    derived: Sequence[Table] = ()
    studies: Sequence[StudyPart] = ()
    changes: Sequence[str] = ()

    @property
    def left_out(self) -> Mapping[str, str]:
        """Studies that the case holds but the page does not show, and the kind of each."""
        shown = {one.name for one in self.studies}
        held = self.case.study.items() if self.case else ()
        return {name: study.kind for name, study in held if name not in shown}

    @property
    def unanswered(self) -> list[str]:
        """Lines on what is wrong with the case, and on what its studies could not answer."""
        open_ = [f"study {s.name}: {line}" for s in self.studies for line in s.problems]
        return [*self.problems, *open_]

    @property
    def load(self) -> str:
        """Load and positions in a sentence."""
        return f"{records.load_text(self.case)}." if self.case else ""

    @property
    def commands(self) -> list[str]:
        """Commands that reproduce what is shown."""
        if not self.file:
            return []
        studies = [self.command("study", s.name) for s in self.studies]
        return [self.command("run"), self.command("report", "-o", "report.html"), *studies]

    def command(self, name: str, *words: str) -> str:
        """Return a command on the file with its changes."""
        changes = (word for change in self.changes for word in ("--set", change))
        file = [self.file] if self.file else []
        return shlex.join(["loadshare", name, *file, *words, *changes])


def chapter_of_file(file: str | Path, changes: Mapping[str, Any] | None = None) -> Chapter:
    """Solve a case file and assemble its chapter; problems of the file become part of it.

    Parameters
    ----------
    file : path-like
    changes : mapping of str to object, optional
        Changes to the case, as for `Case.replace`.
    """
    try:
        return chapter(load_case(file, changes=changes), str(file))
    except CaseError as error:
        return _unusable(str(file), error)


def chapter(
    case: Case,
    file: str = "",
    progress: Progress | None = None,
    result: Result | None = None,
) -> Chapter:
    """Solve a case and assemble its chapter.

    Parameters
    ----------
    case : Case
    file : str
        File that it comes from.
    progress : Progress, optional
        Called after every position.
    result : Result, optional
        Result of the case, if it is solved already.

    Raises
    ------
    CaseError
        If the case cannot be solved at all.
    """
    problems: list[str] = []
    try:
        result = result or solve(case, progress=progress)
        outcome = CERTIFIED
    except Refused as refusal:
        result = refusal.partial
        problems = str(refusal).splitlines()
        outcome = REFUSED if result is None else PARTLY
    return Chapter(
        file=file,
        title=case.title or case.name,
        outcome=outcome,
        verdict=_verdict(result, len(problems)),
        problems=problems,
        case=case,
        result=result,
        drawing=draw(case, result).begin(),
        figures=tuple(f.begin() for f in _figures(result)) if result else (),
        summary=tuple(verdict_tables(result)) if result else (),
        trust=trust(result) if result else {},
        tables=tuple(_tables(result)) if result else (),
        inputs=tuple(input_tables(case)),
        derived=tuple(teeth_tables(case)),
    )


def _unusable(file: str, error: CaseError) -> Chapter:
    drawing: Figure | None = None
    title = Path(file).stem
    try:
        draft = load_draft(file)
        title = draft.title or title
        drawing = draw(draft).begin()
    except LoadshareError:
        # A file that cannot be read at all, or places no gear: its problems say so.
        pass
    return Chapter(
        file=file,
        title=title,
        outcome=UNUSABLE,
        verdict="This case cannot be used; nothing was solved.",
        problems=[str(problem) for problem in error.problems],
        drawing=drawing,
    )


def _verdict(result: Result | None, refused: int) -> str:
    if result is None:
        return "No position has a certified answer."
    done = len(result.positions)
    worst = result.certificate.worst
    return (
        f"{done} of {done + refused} positions certified; worst scaled residual {small(worst)}, "
        f"allowed {result.stamp.tolerance:.0e}."
    )


def _figures(result: Result) -> Iterator[Figure]:
    plots, positions = Plots(result), result.positions
    if any(s is not None for p in positions for s in p.share.values()):
        yield plots.share()
        if any(omega(p.share[m]) != omega(p.pair_share[m]) for p in positions for m in p.share):
            yield plots.share(over="group")
    if positions[0].floats:
        yield plots.floats()
    yield plots.torque()
    if any(t > 0.0 for p in positions for t in p.torque.values()):
        yield plots.law()


def _tables(result: Result) -> Iterator[Table]:
    if result.stages:
        yield tables.omega_table(result)
    yield tables.torque_table(result)
    yield tables.position_table(result)
    yield tables.yield_table(result)
    if result.positions[0].floats:
        yield tables.float_table(result)
    yield tables.load_table(result)
    yield tables.validity_table(result)
    yield tables.certificate_table(result)


def overview(chapters: list[Chapter]) -> Table:
    """Return the table of all cases of a page."""
    rows = []
    for number, one in enumerate(chapters, start=1):
        means = (one.result.omega, one.result.pair_omega) if one.result else ()
        stage, group = [mean["system"] for mean in means] or [None, None]
        worst = one.result.certificate.worst if one.result else None
        rows.append(
            {
                "number": Cell(f"{number}", number),
                "case": Cell(one.title, link=f"#case-{number}"),
                "outcome": Cell(one.outcome),
                "Ω over stage mean": Cell(omega(stage), stage),
                "Ω over group mean": Cell(omega(group), group),
                "worst residual": Cell(NONE if worst is None else small(worst), worst),
            }
        )
    fields = list(rows[0])
    return table("All cases", rows, fields, fields[:3])
