"""The cases of a batch: each has a file of its own, and whatever happens to it is an outcome."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from loadshare._version import __version__
from loadshare.cli.exits import out_of_memory, refusal_lines, refused_document, unwritten
from loadshare.errors import CaseError, Refused, ResultError
from loadshare.json_text import json_text
from loadshare.output import NotWritten, write_whole
from loadshare.processes import side_by_side

if TYPE_CHECKING:
    from loadshare.case import Case
    from loadshare.results import Result

GOOD = ("certified", "kept")
"""Outcomes after which a certified result is on disk."""

UNWRITTEN = "unwritten"
"""Outcome of a case whose file cannot be written, as on a full disk."""


@dataclass(frozen=True, slots=True)
class Task:
    """A case to be solved, and how.

    Attributes
    ----------
    case : Path
    name : str
        Name of the case within the batch.
    target : Path
        Result file.
    how : dict
        Solver, method and tolerance.
    together : int
        Number of cases in the batch; see `engine_for`.
    force : bool
        Solve even if the result is there already.
    changes : dict
        Changes to the case, as `Case.replace` takes them.
    """

    case: Path
    name: str
    target: Path
    how: dict[str, Any]
    together: int
    force: bool
    changes: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a case.

    Attributes
    ----------
    name, case : str
    outcome : str
        "certified", "kept", "refused", "invalid", "unwritten" or "crashed".
    seconds : float
    positions : int
        Number of certified positions.
    omega : float or None
        Largest Ω of the system.
    worst : float or None
        Largest scaled residual.
    messages : tuple of str
        What went wrong, and warnings.
    """

    name: str
    case: str
    outcome: str
    seconds: float
    positions: int = 0
    omega: float | None = None
    worst: float | None = None
    messages: tuple[str, ...] = ()


def work(task: Task) -> Outcome:
    """Solve a case, or keep its result, and write what was found.

    No exception is raised but an interruption.
    """
    start = time.perf_counter()
    outcome, result = "crashed", None
    messages: tuple[str, ...] = ()
    try:
        outcome, result, messages = _attempt(task)
    except NotWritten as error:
        outcome, messages = UNWRITTEN, (f"{error.filename}: {unwritten(error)}",)
    except MemoryError as error:
        messages = (out_of_memory(str(error)),)
    except Exception as error:  # noqa: BLE001 -- a bug met in one case must not cost the others
        messages = (f"{type(error).__name__}: {error}",)
    if outcome in ("invalid", "crashed") and task.target.exists():
        messages += (f"{task.target}: left by an earlier run, does not belong to the present case",)
    return Outcome(
        name=task.name,
        case=str(task.case),
        outcome=outcome,
        seconds=time.perf_counter() - start,
        positions=len(result.positions) if result else 0,
        omega=result.omega["system"] if result else None,
        worst=result.certificate.worst if result else None,
        messages=messages,
    )


def _attempt(task: Task) -> tuple[str, Result | None, tuple[str, ...]]:
    from loadshare.case import load_case
    from loadshare.job import solve
    from loadshare.tooth import resolve

    try:
        case = resolve(load_case(task.case, changes=task.changes))
        kept, notes = (None, ()) if task.force else _kept(task, case)
        if kept is not None:
            return "kept", kept, _warnings(kept)
        result = solve(case, **task.how, engine=engine_for(case, task.together))
    except CaseError as error:
        return "invalid", None, tuple(map(str, error.problems))
    except Refused as refusal:
        write_whole(task.target, json_text(refused_document(refusal, task.case.stem)))
        return "refused", refusal.partial, tuple(refusal_lines(refusal))
    result.to_json(task.target)
    return "certified", result, (*notes, *_warnings(result))


def _warnings(result: Result) -> tuple[str, ...]:
    from loadshare.report.words import advice

    warning = advice(result)
    return (f"warning: {warning}",) if warning else ()


def _kept(task: Task, case: Case) -> tuple[Result | None, tuple[str, ...]]:
    """Return the result on disk if it answers the same question in full, and passes again.

    Returns
    -------
    Result or None
    tuple of str
        What is wrong with a file that claims to be this result but is not.
    """
    from loadshare.results.files import load_result
    from loadshare.train import build_train

    try:
        task.target.stat()
    except OSError:
        return None, ()
    try:
        result = load_result(task.target)
    except ResultError as error:
        # An earlier refusal needs no message; the case is solved again anyway.
        if error.refusal:
            return None, ()
        first = replace(error.problems[0], hint="")
        return None, (f"the existing file was not kept: {first}",)
    stamp = result.stamp
    # Cases are compared, not hashes: a result also shows titles, sources and assumptions.
    how = {key: getattr(stamp, key) for key in task.how}
    found = (result.case, stamp.version, how)
    if found != (case, __version__, task.how) or not stamp.reduce:
        return None, ()
    whole = stamp.positions == tuple(range(1, build_train(case).count + 1))
    return (result if whole else None), ()


SUMMARY = "summary"
"""Name of the batch's own file, which no case may take."""


def result_names(cases: Sequence[Path]) -> list[str]:
    """Return one name per case: that of its file, or its relative path if two names are equal.

    Parameters
    ----------
    cases : sequence of Path
        Different files.

    Returns
    -------
    list of str
        Names that differ even on a file system that ignores case.
    """
    # A path with ".." in it would lead out of the folder of results.
    absolute = [Path(os.path.normpath(path.absolute())) for path in cases]
    root = os.path.commonpath([path.parent for path in absolute]) if absolute else ""
    stems = Counter(path.stem.casefold() for path in cases)
    taken = {SUMMARY}
    names = []
    for path in absolute:
        name = path.stem
        if stems[name.casefold()] > 1:
            name = path.relative_to(root).with_suffix("").as_posix()
        while name.casefold() in taken:
            name += "_"
        taken.add(name.casefold())
        names.append(name)
    return names


def engine_for(case: Case, together: int) -> str:
    """Return the engine that solves a case in a batch of `together` cases.

    By default, a process takes the compiled engine once it has solved enough: the last digits of a
    result would depend on what was solved before, and change if a batch is continued.
    """
    from loadshare.settings import JOB

    positions = case.operating.positions if case.march is None else case.march.steps
    if positions * together <= JOB.few:
        # The same as from `chosen`, whose modules take longer to load than a small batch to begin.
        return "vectorised"
    from loadshare.job.engines import chosen

    return chosen(positions * together)


def outcomes(tasks: Sequence[Task], jobs: int, stopped: Callable[[], bool]) -> Iterator[Outcome]:
    """Do all tasks and yield their outcomes as they come.

    Parameters
    ----------
    tasks : sequence of Task
    jobs : int
        Processes; with one, everything is done in this process.
    stopped : callable
        Whether nothing more is to be started; what is under way is then finished.

    Yields
    ------
    Outcome
        One per task that was started. A process that dies costs one more try of its case; a case
        on which two die has crashed.
    """
    if jobs == 1:
        for task in tasks:
            if stopped():
                return
            yield work(task)
        return
    for task, outcome in side_by_side(work, tasks, jobs, stopped):
        yield outcome or Outcome(
            task.name, str(task.case), "crashed", 0.0, messages=("its process died twice",)
        )
