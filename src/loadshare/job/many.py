"""Solve one case again and again with other inputs: `loadshare.solve_many`.

Samples are taken in blocks of a fixed size, so that an answer does not depend on the number of
workers. Every block goes down the hot path at once, all positions together, and is certified at
once; single samples that it leaves climb the ladder.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from loadshare.case import Case, load_case
from loadshare.certify.nonconvex import arc_curvature, is_convex
from loadshare.certify.tolerance import checked_tolerance
from loadshare.errors import CaseError, Refused
from loadshare.job.hot import HOT, SEARCHED
from loadshare.job.ladder import climb
from loadshare.job.least import least_places
from loadshare.job.machine import Machine, engine_named
from loadshare.job.positions import Progress, wanted_positions
from loadshare.job.recent import Recent
from loadshare.job.table import KEPT, Table, kept
from loadshare.settings import CERTIFY, JOB
from loadshare.solver import Options
from loadshare.solver.hot.exchange import Engine
from loadshare.train import build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.samples import Samples, samples_of
from loadshare.train.situations import Situations, stack

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

RUNGS = np.array([HOT, SEARCHED], dtype=object)
"""Without and with the proximal search."""


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Answers of up to `BLOCK` samples at all positions asked for.

    Attributes
    ----------
    rows : ndarray of int, shape (S,)
        Numbers of the samples.
    positions : tuple of int
    equilibria : tuple of Equilibria
        One per position.
    certified : ndarray of bool, shape (S, positions)
    residual : ndarray, shape (S, positions)
        Largest scaled residual; NaN where there is no answer.
    bound : ndarray, shape (S, positions)
        Largest distance of a torque from the exact one, over the largest torque; likewise.
    determined : ndarray of bool, shape (S, positions)
        Whether the equilibrium determines every displacement.
    displaced : ndarray, shape (S, positions)
        How far displacements go to a warning (see `Measuring.worst`); NaN where there is no answer.
    convex : ndarray of bool, shape (S, positions)
        Whether nothing that is not convex carries, so that the answer is the only one.
    arc_curvature : ndarray, shape (S, positions)
        Stiffness that arcs take across them [N/m]; NaN where there is no answer.
    rung : ndarray of object, shape (S, positions)
        Rung of the ladder that answered; empty where none did.
    message : mapping of (row, position) to str
        Why there is no answer.
    """

    rows: NDArray[np.intp]
    positions: tuple[int, ...]
    equilibria: tuple[Equilibria, ...]
    certified: NDArray[np.bool_]
    residual: Array
    bound: Array
    determined: NDArray[np.bool_]
    displaced: Array
    convex: NDArray[np.bool_]
    arc_curvature: Array
    rung: NDArray[np.object_]
    message: Mapping[tuple[int, int], str]


def solve_blocks(
    case: Case | str | Path,
    samples: Mapping[str, ArrayLike],
    *,
    positions: Iterable[int] | None = None,
    tolerance: float = CERTIFY.tolerance,
    engine: str = "auto",
    workers: int = JOB.workers,
    least_norm: bool = False,
) -> Iterator[Block]:
    """Solve samples block by block, in order; memory does not grow with their number.

    Parameters and errors are those of :func:`solve_many`. With `least_norm`, displacements that an
    equilibrium leaves undetermined are the least-norm ones, which takes some milliseconds for every
    sample with any; otherwise they are one possible choice.

    Yields
    ------
    Block
    """
    tolerance = checked_tolerance(tolerance)
    if not isinstance(case, Case):
        case = load_case(case)
    groups = samples_of(case, samples)
    total = sum(len(rows) for rows, _ in groups)
    wanted = tuple(wanted_positions(groups[0][1].train, positions))
    size = max(JOB.block, JOB.together // len(wanted))
    tasks: list[tuple[Machine, NDArray[np.intp], Samples, slice]] = []
    for rows, group in groups:
        machine = _machine(case, group)
        tasks += [(machine, rows, group, slice(at, at + size)) for at in range(0, len(rows), size)]
    solver = engine_named(engine, total * len(wanted))

    def work(task: tuple[Machine, NDArray[np.intp], Samples, slice]) -> Block:
        machine, rows, group, part = task
        return _block(machine, rows[part], group.take(part), wanted, tolerance, solver, least_norm)

    if workers <= 1 or len(tasks) == 1:
        yield from map(work, tasks)
        return
    with ThreadPoolExecutor(workers) as pool:
        queue = iter(tasks)
        running = [pool.submit(work, task) for task in islice(queue, workers + 1)]
        while running:
            block = running.pop(0).result()
            running += [pool.submit(work, task) for task in islice(queue, 1)]
            yield block


_recent: Recent[Machine] = Recent()


def _machine(case: Case, samples: Samples) -> Machine:
    """Return the machine of samples that share one; what varies in them is no part of it."""
    fixed = [(c.path, c.text(0)) for c in samples.columns if c.path not in samples.values]
    which = (frozenset(samples.values), *fixed)
    machine, known = Machine(samples.train), _recent.of(case, which)
    if known is None:
        return _recent.keep(case, machine, which)
    machine.share(known)
    return machine


def solve_many(
    case: Case | str | Path,
    samples: Mapping[str, ArrayLike],
    *,
    positions: Iterable[int] | None = None,
    keep: Iterable[str] = tuple(KEPT),
    tolerance: float = CERTIFY.tolerance,
    engine: str = "auto",
    workers: int = JOB.workers,
    least_norm: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find and certify the equilibria of many samples of a case.

    Parameters
    ----------
    case : Case or path
        A case, or the path of a case file; it gives whatever the samples do not.
    samples : mapping of str to array_like
        Values by dotted key, all of one length. The unit stands in brackets after the key, as in
        ``{"rings.4.float [um]": [0, 4, 8]}``; texts with units may stand instead.
    positions : iterable of int, optional
        1-based positions to solve; all by default.
    keep : iterable of str
        Variables to keep: "torque", "share", "pair_share", "displacement", "contact_force".
    tolerance : float
        Largest scaled residual of a certified answer, up to 1e-3.
    engine : {"auto", "compiled", "vectorised"}
        Numba or NumPy; both give the same answers. "auto" compiles from a few thousand equilibria
        on, which takes one to three minutes of processor time once in an installation. The log
        ("loadshare") tells of it, and why NumPy answers where nothing can be compiled or kept.
    workers : int
        Threads.
    least_norm : bool
        Move displacements that an equilibrium leaves undetermined to the least-norm ones, as
        `solve` does: some milliseconds for every sample with any.
    progress : Progress, optional
        Called after every block with samples done and in all.

    Returns
    -------
    xarray.Dataset
        Over (sample, position): ``torque`` [N·m] (drive less coast), ``share`` and ``pair_share``
        [-] over mesh; ``displacement`` [m] over gear and component, for gears that can be
        displaced; ``contact_force`` [N] of ring contacts; ``residual``, ``torque_bound`` (largest
        distance of a torque from the exact one, over the largest torque), ``certified``,
        ``determined``, ``displaced`` (displacements over what their geometry allows without a
        warning; ``warned`` counts those above 1), ``convex`` (nothing that is not convex carries),
        ``arc_curvature`` [N/m] that arcs take elsewhere from the stiffness across them, ``rung``.
        What is refused is NaN; the attribute ``refused`` says why.

    Raises
    ------
    CaseError
        If a key or a value cannot be used; all problems are listed.
    ValueError
        If a position, a variable or an engine does not exist, or the tolerance is no tolerance.

    Examples
    --------
    >>> import loadshare as ls
    >>> floats = {"rings.4.float [um]": [0.0, 4.0, 12.0], "rings.5.float [um]": [0.0, 4.0, 12.0]}
    >>> found = ls.solve_many("cases/fgfbstts/limit_ring.toml", floats, positions=[1])
    >>> bool(found.certified.all())
    True
    """
    tolerance = checked_tolerance(tolerance)
    if not isinstance(case, Case):
        case = load_case(case)
    blocks = solve_blocks(
        case,
        samples,
        positions=positions,
        tolerance=tolerance,
        engine=engine,
        workers=workers,
        least_norm=least_norm,
    )
    count = len(np.atleast_1d(np.asarray(next(iter(samples.values()), []))))
    return Table.of(blocks, count, kept(keep), progress).dataset(case, tolerance)


def _block(
    machine: Machine,
    rows: NDArray[np.intp],
    samples: Samples,
    positions: tuple[int, ...],
    tolerance: float,
    engine: Engine,
    least_norm: bool,
) -> Block:
    """Solve one block; what the hot path leaves climbs the ladder."""
    count, shape = len(rows), (len(rows), len(positions))
    certified, determined = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    residual, bound = np.full(shape, np.nan), np.full(shape, np.nan)
    # Objects, so that a million answers share a few texts.
    rung = np.full(shape, "", dtype=object)
    deflection, load, displaced = np.full((3, *shape), np.nan)
    message: dict[tuple[int, int], str] = {}
    every: list[Equilibria] = []
    stands: list[Situations] = []
    abreast = max(1, JOB.together // count)
    for at in range(0, len(positions), abreast):
        some = positions[at : at + abreast]
        stands += [samples.situations(index) for index in some]
        situations = stack(stands[at:])
        found = machine.answer(situations, tolerance, engine, starts=some)
        every += [
            found.equilibria.part(slice(p * count, p * count + count)) for p in range(len(some))
        ]
        columns = slice(at, at + len(some))
        certified[:, columns] = found.passed.reshape(-1, count).T
        rung[:, columns] = RUNGS[found.searched.astype(np.intp)].reshape(-1, count).T
        residual[:, columns] = found.verdicts.worst.reshape(-1, count).T
        deflection[:, columns] = found.verdicts.deflection.reshape(-1, count).T
        load[:, columns] = found.verdicts.load.reshape(-1, count).T
        displaced[:, columns] = found.verdicts.displaced.reshape(-1, count).T
        bound[:, columns] = found.verdicts.bounds.relative.reshape(-1, count).T
        determined[:, columns] = found.determined.reshape(-1, count).T
        if least_norm:
            loose = found.passed & ~found.determined
            least_places(machine, situations, found, np.flatnonzero(loose).tolist(), tolerance)
            displaced[:, columns][loose.reshape(-1, count).T] = np.nan
    for row, p in np.argwhere(~certified).tolist():
        index = positions[p]
        try:
            train = build_train(samples.one(row))
            answer = climb(train, index, Options(), tolerance, JOB.steps)
        except (CaseError, Refused) as refusal:
            message[int(rows[row]), index] = str(refusal)
            residual[row, p], bound[row, p], rung[row, p] = np.nan, np.nan, ""
            every[p].forget(row)
            continue
        every[p].put(row, answer.equilibrium)
        displaced[row, p] = np.nan
        certified[row, p], rung[row, p] = True, answer.rung
        residual[row, p] = answer.certificate.worst
        bound[row, p] = answer.certificate.proved
        deflection[row, p] = answer.certificate.deflection
        load[row, p] = answer.certificate.load
        determined[row, p] = not answer.equilibrium.undetermined
    refused = _put_displaced(machine, stands, every, deflection, displaced)
    for (row, p), why in refused.items():
        message[int(rows[row]), positions[p]] = f"position {positions[p]}: {why}"
        certified[row, p], rung[row, p] = False, ""
        residual[row, p] = bound[row, p] = displaced[row, p] = np.nan
        every[p].forget(row)
    curvature, convex = np.full(shape, np.nan), np.zeros(shape, dtype=bool)
    for p, (here, answers) in enumerate(zip(stands, every, strict=True)):
        curvature[:, p] = arc_curvature(machine.train, answers)
        convex[:, p] = is_convex(machine.train, here, answers, load[:, p]) & certified[:, p]
    return Block(
        rows,
        positions,
        tuple(every),
        certified,
        residual,
        bound,
        determined,
        displaced,
        convex,
        curvature,
        rung,
        message,
    )


def _put_displaced(
    machine: Machine,
    situations: Sequence[Situations],
    answers: Sequence[Equilibria],
    deflection: Array,
    displaced: Array,
) -> dict[tuple[int, int], str]:
    """Write how far displacements go to a warning where that is not known; why some are refused."""
    refused: dict[tuple[int, int], str] = {}
    for p, (here, found) in enumerate(zip(situations, answers, strict=True)):
        left = np.flatnonzero(np.isnan(displaced[:, p]))
        if len(left):
            some = here.take(left), found.take(left), deflection[left, p]
            displaced[left, p] = machine.measuring.worst(*some)
        large = np.flatnonzero(displaced[:, p] >= 1.0)
        if len(large):
            some = here.take(large), found.take(large), deflection[large, p]
            why = machine.measuring.refusals(*some)
            refused |= {(int(large[k]), p): told for k, told in why.items()}
    return refused
