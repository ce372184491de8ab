"""Solve a case: `loadshare.solve`."""

from __future__ import annotations

from collections import Counter, OrderedDict
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from numbers import Integral
from pathlib import Path
from threading import Lock

from loadshare._version import __version__
from loadshare.arguments import one_of
from loadshare.case import Case
from loadshare.case.reader import opened
from loadshare.case.recent import Recent
from loadshare.certify.tolerance import checked_tolerance
from loadshare.contact.backends.backend import SOLVERS
from loadshare.errors import Refused
from loadshare.job.answer import Answer
from loadshare.job.engines import ENGINES
from loadshare.job.hot import HOT, SEARCHED, left_out
from loadshare.job.ladder import AUTO, climb_all
from loadshare.job.machine import Machine
from loadshare.later import known
from loadshare.progress import Progress
from loadshare.results.derive import positions_of, result_from
from loadshare.results.result import Result, Stamp
from loadshare.scene.units import units_of
from loadshare.settings import CERTIFY, JOB
from loadshare.solver import Options
from loadshare.train import Train
from loadshare.train.alike import train_alike
from loadshare.train.build import train_of, with_laws
from loadshare.train.geometry import Geometry, geometry_of
from loadshare.train.shape import shape_of


def solve(
    case: Case | str | Path,
    *,
    solver: str = AUTO,
    method: str = "newton",
    reduce: bool = True,
    tolerance: float = CERTIFY.tolerance,
    positions: Iterable[int] | None = None,
    engine: str = "auto",
    progress: Progress | None = None,
) -> Result:
    """Find and certify the equilibrium of a case at every position.

    Parameters
    ----------
    case : Case or path
        A case, or the path of a case file.
    solver : {"auto", "clarabel", "osqp", "cvxpy"}
        "auto" tries the fast method and then Clarabel; otherwise the back-end of the first rung.
    method : {"newton", "picard", "power"}
        Form of the outer loop for nonlinear mesh laws.
    reduce : bool
        Whether to leave out, and verify, what cannot matter; the answer does not depend on it.
    tolerance : float
        Largest scaled residual of a certified answer, up to 1e-3.
    positions : iterable of int, optional
        1-based positions to solve; all by default.
    engine : {"auto", "vectorised", "compiled"}
        Engine of the fast method: NumPy, or Numba, which takes a minute to compile the first time.
        "auto" is Numba once it was used in this process, or once 300 positions were solved and it
        is kept on disk. Answers are the same except for round-off.
    progress : Progress, optional
        Called after every position.

    Returns
    -------
    Result
        Torques, coefficients, floats and certificates of every position.

    Raises
    ------
    CaseError
        If the case cannot be used; all problems are listed.
    Refused
        If a position has no certified answer, or one whose displacements are too large for the
        geometry in which it was found. The other positions are in its ``partial``.
    ValueError
        If a solver, method, engine or position does not exist, or the tolerance is not valid.

    Examples
    --------
    >>> import loadshare as ls
    >>> result = ls.solve("cases/fgfbstts/base.toml")
    >>> result.passed
    True
    """
    tolerance = checked_tolerance(tolerance)
    case = opened(case)
    solved, machine = prepared(case)
    options, settle = _options(solver, method, reduce, engine)
    wanted = wanted_positions(machine.train, positions)
    answers: list[Answer] = []
    refusals: list[Refused] = []
    for done, found in enumerate(climb_all(machine, wanted, options, tolerance, settle), start=1):
        refused = found if isinstance(found, Refused) else found.refused()
        if refused is not None:
            refusals.append(refused)
        elif isinstance(found, Answer):
            answers.append(found)
        if progress is not None:
            progress(done, len(wanted))
    requested = replace(options, solver=solver)
    result = None
    if answers:
        result = result_of(case, solved, machine.train, answers, requested, tolerance, wanted)
    if refusals or result is None:
        raise _together(refusals, result)
    return result


def _together(refusals: Sequence[Refused], result: Result | None) -> Refused:
    """Return one refusal for all positions that have no answer, with the worst figures."""
    figures: dict[str, float] = {}
    for refusal in refusals:
        for name, value in refusal.figures.items():
            figures[name] = max(value, figures.get(name, 0.0))
    return Refused("\n".join(map(str, refusals)), figures, partial=result)


def explain(
    case: Case | str | Path,
    position: int = 1,
    *,
    solver: str = AUTO,
    method: str = "newton",
    reduce: bool = True,
    tolerance: float = CERTIFY.tolerance,
) -> Answer:
    """Solve one position and return everything that is known about how it was solved.

    Parameters
    ----------
    case : Case or path
    position : int
        1-based.
    solver, method : str
        As for :func:`solve`, like the following.
    reduce : bool
    tolerance : float

    Returns
    -------
    Answer
        Scene, equilibrium, certificate, and the record of plans, passes and what was left out. An
        answer that :func:`solve` refuses for its displacements is returned here nevertheless;
        see its ``validity``.

    Raises
    ------
    CaseError, Refused, ValueError
        As :func:`solve`.
    """
    tolerance = checked_tolerance(tolerance)
    case, machine = prepared(case)
    options, settle = _options(solver, method, reduce)
    wanted = wanted_positions(machine.train, [position])
    (found,) = climb_all(machine, wanted, options, tolerance, settle)
    if isinstance(found, Refused):
        raise found
    if found.rung in (HOT, SEARCHED):
        record = replace(found.record, removed=left_out(found))
        return replace(found, how=known(record))
    return found


def _options(
    solver: str, method: str, reduce: bool, engine: str = "auto"
) -> tuple[Options, str | None]:
    """Return the options of the rungs and the engine of the fast method; None to leave that out.

    The fast method is left out if another form of the loop or the whole scene is requested, which
    only a back-end can do.
    """
    one_of("solver", solver, (AUTO, *SOLVERS))
    one_of("engine", engine, ENGINES)
    if solver != AUTO:
        return Options(solver=solver, method=method, reduce=reduce), None
    hot = method == "newton" and reduce
    return Options(method=method, reduce=reduce), engine if hot else None


_recent: Recent[tuple[Case, Machine, Geometry]] = Recent()
_sharing = Lock()
_shapes: OrderedDict[Hashable, dict[tuple[float, float], Machine]] = OrderedDict()
"""Machines by the shape of their trains, most recently used last, and by their units."""


def prepared(case: Case | str | Path) -> tuple[Case, Machine]:
    """Return a case with its mesh laws computed, and its machine; both are built once.

    The machine shares the reduced parts of a recent one whose train has the same shape. A case that
    differs from a recent one in numbers only has the same geometry.
    """
    case = opened(case)
    written = tuple(map(_when_written, case.law_files))
    found = _recent.of(case, written)
    if found is None:
        solved = with_laws(case)
        train, geometry = _built(solved)
        machine = Machine(train)
        share(machine)
        found = _recent.keep(case, (solved, machine, geometry), written)
    return found[:2]


def _when_written(file: Path) -> tuple[int, int]:
    """Return what identifies a file's version; a file that is gone is reported later."""
    try:
        status = file.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size


def _built(case: Case) -> tuple[Train, Geometry]:
    """Return the train of a case and its geometry."""
    for before, machine, geometry in _recent:
        train = train_alike(case, (before, geometry, machine.train))
        if train is not None:
            return train, geometry
    geometry = geometry_of(case)
    return train_of(case, geometry), geometry


def share(machine: Machine) -> None:
    """Let a machine share the reduced parts of one whose train has its shape, or be the first.

    Only machines of the same units share, so that no bit of an answer depends on what was solved
    before.
    """
    if machine.train.is_placed_anew:
        return
    shape = shape_of(machine.train)
    with _sharing:
        known = _shapes.setdefault(shape, {})
        _shapes.move_to_end(shape)
        first = next(iter(known.values()), machine).structure
        like = known.setdefault(units_of(first, machine.first_situation), machine)
        if like is not machine:
            machine.share(like)
        while len(_shapes) > JOB.recent:
            _shapes.popitem(last=False)


def wanted_positions(train: Train, positions: Iterable[int] | None) -> list[int]:
    """Return the positions to solve, checked; all of them by default.

    Raises
    ------
    ValueError
        If none is given, one is given twice, or one is not a position of the train.
    """
    there = range(1, train.count + 1)
    if positions is None:
        return list(there)
    allowed = f"this case has positions 1 to {train.count}"
    if not isinstance(positions, Iterable) or isinstance(positions, str | bytes):
        message = f"positions {positions!r}: not a list of positions; {allowed}"
        raise ValueError(message)  # noqa: TRY004 -- one kind of error for all that no position is
    wanted = list(positions)
    # Positions from an array are integers of NumPy; a result and its file hold plain ones.
    wrong = [k for k in wanted if not isinstance(k, Integral) or k is True or k not in there]
    if wrong or not wanted:
        shown = (str(k) if isinstance(k, Integral) else repr(k) for k in wrong)
        given = ", ".join(shown) or "none given"
        raise ValueError(f"positions {given}: {allowed}")
    twice = sorted(k for k, times in Counter(wanted).items() if times > 1)
    if twice:
        raise ValueError(f"positions {', '.join(map(str, twice))}: given more than once")
    return [int(k) for k in wanted]


def wanted_of(trains: Iterable[Train], positions: Iterable[int] | None) -> tuple[int, ...]:
    """Return the positions to solve of several trains: those of the train that has most.

    Raises
    ------
    ValueError
        As `wanted_positions`, if no train has a position.
    """
    longest = max(trains, key=lambda train: train.count)
    return tuple(wanted_positions(longest, positions))


def result_of(
    case: Case,
    solved: Case,
    train: Train,
    answers: list[Answer],
    options: Options,
    tolerance: float,
    wanted: Sequence[int],
) -> Result:
    """Combine answers into a result.

    Parameters
    ----------
    case : Case
        The case as given.
    solved : Case
        The same with its mesh laws computed.
    train : Train
    answers : list of Answer
    options : Options
    tolerance : float
    wanted : sequence of int
        1-based positions that were requested.
    """
    found = positions_of([(a.train, a.index, a.flank_force, a) for a in answers])
    return result_from(
        case, solved, train, found, partial(_stamp, solved, options, tolerance, wanted)
    )


def _stamp(case: Case, options: Options, tolerance: float, wanted: Sequence[int]) -> Stamp:
    """Return the stamp of a result: where it comes from."""
    return Stamp(
        version=__version__,
        case=case.name,
        title=case.title,
        case_hash=case.hash,
        solver=options.solver,
        method=options.method,
        reduce=options.reduce,
        tolerance=tolerance,
        stop=options.stop,
        positions=tuple(wanted),
    )
