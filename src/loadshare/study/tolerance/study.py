"""Tolerance studies: `loadshare.tolerance`."""

from __future__ import annotations

import weakref
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from loadshare.arguments import one_of, whole
from loadshare.case import Case, Study
from loadshare.case.keys import dotted
from loadshare.case.reader import opened
from loadshare.errors import CaseError, Problem
from loadshare.job.engines import ENGINES, chosen
from loadshare.job.positions import wanted_positions
from loadshare.lock import alone_in
from loadshare.progress import Progress
from loadshare.settings import CERTIFY, JOB, TOLERANCE
from loadshare.study.positions import loaded
from loadshare.study.tolerance.figures import KIND_OVER, KINDS, SYSTEM
from loadshare.study.tolerance.folder import WORST as WORST_FILE
from loadshare.study.tolerance.folder import Folder
from loadshare.study.tolerance.inputs import read_inputs
from loadshare.study.tolerance.job import CHUNK, INDICES, SAMPLES, Job, Part, equilibria
from loadshare.study.tolerance.result import FloatStatistics, Tolerance
from loadshare.study.tolerance.resume import check_part
from loadshare.study.tolerance.statistics import (
    OmegaStatistics,
    Share,
    Summary,
    apart_kinds,
    omega_statistics,
    shares,
    summary,
)
from loadshare.study.tolerance.temporary import TemporaryFolder
from loadshare.study.tolerance.worst import WorstCase, check_worst, worst_case
from loadshare.train import build_train

NAME = "tolerance"
"""Name of a study that is requested in Python only."""


def tolerance(
    case: Case | str | Path,
    inputs: Mapping[str, Any] | None = None,
    *,
    study: str | None = None,
    groups: Iterable[Any] | None = None,
    samples: int | None = None,
    seed: int | None = None,
    sampling: str | None = None,
    limit: float | None = None,
    indices: int | None = None,
    quantiles: Iterable[float] | None = None,
    positions: Iterable[int] | None = None,
    worst: bool = True,
    out: str | Path | None = None,
    scheduler: str | None = None,
    workers: int = 2,
    chunk: int = CHUNK,
    engine: str = "auto",
    progress: Progress | None = None,
) -> Tolerance:
    """Find how load sharing scatters if inputs of a case do.

    Every sample is a certified equilibrium at every position. Samples are drawn in blocks of 4096,
    each from its own seed, so results are bit-identical for any workers and whatever was solved
    before. A run that was killed continues where it stopped if called again with the same `out`.

    Parameters
    ----------
    case : Case or path
    inputs : mapping of str to dict or Spread, optional
        Distributions by key, as in ``[study.NAME.inputs]`` of a case file.
    study : str, optional
        Study of the case that supplies whatever is not given here. If neither this nor `inputs` is
        given, the only tolerance study of the case.
    groups, samples, seed, sampling, limit, indices, quantiles, positions : optional
        As the keys of ``[study.NAME]``. By default 16384 samples, seed 0, "random" sampling, 1024
        rows for the shares of variance, and quantiles 0.5, 0.9, 0.95, 0.99 and 0.999.
    worst : bool
        Whether to search for the worst case within the tolerances as well.
    out : path, optional
        Folder for the samples; without one they are kept as long as the result exists.
    scheduler : str, optional
        Address of a Dask scheduler; its workers then solve the samples.
    workers, chunk : int
        Processes on this machine; blocks of 4096 samples per part, the unit of work and of files.
    engine : {"auto", "compiled", "vectorised"}
        As for `solve_many`.
    progress : Progress, optional
        Called after every part with samples done and in all (with those for variance shares).

    Raises
    ------
    CaseError
        If the study, an input or its distribution cannot be used; all problems are listed.
    LoadshareError
        If `out` holds a study with other settings, another process works there, workers fail,
        or there is no place for samples.
    OSError
        If a file cannot be written; files already there are intact, and the same call continues.
    ValueError
        If a position or an engine does not exist, or `workers` or `chunk` is below 1.

    Examples
    --------
    >>> import loadshare as ls
    >>> floats = {"rings.*.float": {"distribution": "uniform", "low": "0 um", "high": "12 um"}}
    >>> found = ls.tolerance("cases/fgfbstts/limit_ring.toml", floats, samples=256, indices=0,
    ...                      limit=1.03, positions=[1])
    >>> found.of("system", "group").exceedance.value
    0.2734375
    """
    given: dict[str, Any] = {"inputs": inputs, "groups": groups, "quantiles": quantiles}
    given |= {"samples": samples, "seed": seed, "sampling": sampling}
    given |= {"limit": limit, "indices": indices, "positions": positions}
    workers = whole("workers", workers)
    job, block = requested_job(opened(case), study, given, chunk=chunk, engine=engine)
    with _folder(out, job) as folder:
        _solve(folder, scheduler, workers, progress)
        return _Reader(folder, block).found(worst)


def requested_job(
    case: Case,
    study: str | None,
    given: Mapping[str, Any],
    *,
    chunk: int = CHUNK,
    engine: str = "auto",
) -> tuple[Job, Study]:
    """Return the job of a requested study, checked, and the study's settings.

    Parameters
    ----------
    case : Case
    study : str or None
        Study of the case that supplies whatever is not given here.
    given : mapping of str to object
        By the keys of ``[study.NAME]``; None for a key that is not given.
    chunk, engine
        As for `tolerance`.

    Raises
    ------
    CaseError
        If the study, an input or its distribution cannot be used; all problems are listed.
    ValueError
        If a position or an engine does not exist.
    """
    case, name = _requested(case, study, given)
    case = loaded(case, case.study[name].inputs or ())
    block = case.study[name]
    samples = block.samples or TOLERANCE.samples
    sampling = block.sampling or "random"
    rows = TOLERANCE.rows if block.indices is None else block.indices
    problems: list[Problem] = []
    try:
        read = read_inputs(case, name)
    except CaseError as error:
        problems += error.problems
    if sampling == "sobol":
        for key, count in (("samples", samples), ("indices", rows)):
            if count % TOLERANCE.sequences:
                place = f"study.{name}.{key}"
                message = f"{count} cannot be divided among {TOLERANCE.sequences} Sobol sequences"
                allowed = f"a multiple of {TOLERANCE.sequences}, best with a power of 2 for each"
                problems.append(case.problem(place, message, allowed))
    if problems:
        raise CaseError(problems)
    one_of("engine", engine, ENGINES)
    wanted = wanted_positions(build_train(case), block.positions)
    if engine == "auto":
        total = equilibria(samples, rows, len(read.units), len(wanted))
        engine = chosen(total)
    job = Job.of(
        case,
        read,
        samples=samples,
        seed=block.seed,
        sampling=sampling,
        indices=rows,
        positions=wanted,
        tolerance=CERTIFY.tolerance,
        engine=engine,
        chunk=whole("chunk", chunk),
    )
    return job, block


@contextmanager
def _folder(out: str | Path | None, job: Job) -> Iterator[Folder]:
    """Open a study's folder; a temporary one is removed when it is no longer used."""
    if out is not None:
        path = Path(out)
        # Whatever prevents this is reported by the folder.
        with suppress(OSError):
            path.mkdir(parents=True, exist_ok=True)
        with alone_in(path):
            yield Folder(path, job)
        return
    place = TemporaryFolder()
    try:
        folder = Folder(place.path, job, lasting=False)
        yield folder
    except BaseException:
        place.remove()
        raise
    weakref.finalize(folder, place.remove)


def _requested(case: Case, name: str | None, given: Mapping[str, Any]) -> tuple[Case, str]:
    """Return the case with the study as requested, checked, and the study's name."""
    own = [key for key, block in case.study.items() if block.kind == NAME]
    settings = {key: value for key, value in given.items() if value is not None}
    if name is None:
        if "inputs" in settings:
            whole = {"kind": NAME, **settings}
            return case.replace({f"study.{NAME}": whole}), NAME
        if len(own) != 1:
            message = "has no tolerance study" if not own else "has several tolerance studies"
            allowed = (
                ", ".join(own) or 'a table [study.NAME] with kind = "tolerance", or inputs (--over)'
            )
            raise CaseError([Problem(case.name, "study", "", message, allowed)])
        (name,) = own
    elif name not in own:
        message = "is not a tolerance study of the case"
        raise CaseError([Problem(case.name, f"study.{name}", "", message, ", ".join(own))])
    changes = {dotted(("study", name, key)): value for key, value in settings.items()}
    return (case.replace(changes) if changes else case), name


def _solve(folder: Folder, scheduler: str | None, workers: int, progress: Progress | None) -> None:
    """Check the parts that exist, then solve the missing ones."""
    missing = folder.missing()
    for part in folder.all:
        if part not in missing:
            check_part(folder, part)
    total = sum(part.rows for part in folder.all)
    done = total - sum(part.rows for part in missing)
    if progress is not None:
        progress(done, total)
    for part in _solved(folder, missing, scheduler, workers):
        done += part.rows
        if progress is not None:
            progress(done, total)


def _solved(
    folder: Folder, missing: Sequence[Part], scheduler: str | None, workers: int
) -> Iterator[Part]:
    if not missing:
        return iter(())
    if scheduler is not None:
        from loadshare.study.tolerance.cluster import solve_on_cluster

        return solve_on_cluster(folder, missing, scheduler)
    from loadshare.study.tolerance.local import solve_here, solve_parts

    # By all parts, not by the missing ones: where a sample is solved must not depend on when.
    settings = folder.job.settings
    if sum(part.rows for part in folder.all) * len(settings["positions"]) <= TOLERANCE.small:
        return solve_here(folder, missing)
    return solve_parts(folder, missing, workers)


class _Reader:
    """Reader of a study's statistics from its parts."""

    def __init__(self, folder: Folder, block: Study) -> None:
        self.folder, self.limit = folder, block.limit
        self.settings, self.train = folder.job.settings, folder.job.train
        self.levels = block.quantiles or TOLERANCE.levels
        self.replicated = self.settings["sampling"] == "sobol"

    def found(self, worst: bool) -> Tolerance:
        """Return the result of the study."""
        folder, job = self.folder, self.folder.job
        certified, residual = folder.column("certified"), folder.column("residual")
        messages = folder.column("message")[~certified]
        gone = 0
        if self.settings["indices"]:
            gone = int((~folder.column("certified", INDICES)).sum())
        torque = {mesh: self._summary(f"torque.{mesh} [N*m]") for mesh in self.train.meshes}
        apart = apart_kinds(folder.column)
        return Tolerance(
            case=job.name,
            inputs=job.inputs,
            settings=job.settings,
            limit=self.limit,
            samples=len(certified),
            refused=int((~certified).sum()),
            messages=dict(Counter(str(m).splitlines()[0] for m in messages).most_common()),
            omega=tuple(self._omega()),
            torque={mesh: found for mesh, found in torque.items() if found is not None},
            floats=tuple(self._floats()),
            design_refused=gone,
            overs=tuple(KINDS[kind] for kind in apart),
            worst=_worst(folder, apart) if worst else (),
            residual=float(np.nanmax(residual)) if certified.any() else float("nan"),
            folder=folder,
        )

    def _summary(self, column: str) -> Summary | None:
        return summary(self.folder.column(column), self.levels, self.replicated)

    def _omega(self) -> Iterator[OmegaStatistics]:
        column, stages = self.folder.column, [*(s.name for s in self.train.stages), SYSTEM]
        for one in omega_statistics(column, stages, self.levels, self.limit, self.replicated):
            yield replace(one, shares=self._shares(f"{KIND_OVER[one.over]}.{one.stage}"))

    def _shares(self, column: str) -> tuple[Share, ...]:
        rows = self.settings["indices"]
        if not rows:
            return ()
        figures = self.folder.column(column, INDICES).reshape(-1, rows)
        return shares(figures, self.folder.job.inputs.unit_names, self.settings["seed"])

    def _floats(self) -> Iterator[FloatStatistics]:
        for gear in self.train.floating:
            way, force, pressed = self._summary(f"float.{gear} [m]"), None, None
            if way is None:
                continue
            if gear in self.train.limits:
                column = f"boundary_force.{gear} [N]"
                force, values = self._summary(column), self.folder.column(column)
                known = values[~np.isnan(values)]
                pressed = float((known > TOLERANCE.pressed * max(known.max(), 1e-300)).mean())
            yield FloatStatistics(gear, way, force, pressed)


def _worst(folder: Folder, kinds: Sequence[str]) -> tuple[WorstCase, ...]:
    """Return the worst cases, from an earlier run or from a search."""
    known = folder.worst()
    if known is not None:
        # A file that something else wrote under this name holds other keys.
        with suppress(TypeError):
            believed = tuple(WorstCase(**one) for one in known)
            for one in believed:
                check_worst(folder.job, one, str(folder.path / WORST_FILE))
            return believed
    found = tuple(sought(folder, kinds))
    folder.keep_worst([asdict(one) for one in found])
    return found


def sought(folder: Folder, kinds: Sequence[str]) -> Iterator[WorstCase]:
    """Search for the worst case of every kind of Ω, starting from the worst samples."""
    design = folder.job.designs[SAMPLES]
    for kind in kinds:
        values = np.nan_to_num(folder.column(f"{kind}.{SYSTEM}"), nan=-np.inf)
        worst = np.argsort(-values, kind="stable")[: TOLERANCE.worst]
        rows = [row for row in worst.tolist() if np.isfinite(values[row])]
        known = [design.values(row // JOB.block)[row % JOB.block] for row in rows]
        found = worst_case(folder.job, kind, known)
        if found is not None:
            yield found
