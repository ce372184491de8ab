"""Solve one case again and again with other inputs: `loadshare.solve_many`.

Samples are taken in blocks of a fixed size, so that an answer does not depend on the number of
workers. Every block is solved by the fast method at once, all positions together, and certified at
once; single samples that the fast method leaves climb the ladder.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from loadshare.arguments import whole
from loadshare.array_types import Numbers
from loadshare.case import Case
from loadshare.case.reader import opened
from loadshare.case.recent import Recent
from loadshare.certify.tolerance import checked_tolerance
from loadshare.errors import CaseError
from loadshare.job.allocation import keep_freed_memory
from loadshare.job.block import Block, solve_block
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.job.positions import wanted_of
from loadshare.job.table import USUAL, AnswerTable, checked
from loadshare.one_thread import one_thread
from loadshare.progress import Progress
from loadshare.settings import CERTIFY, JOB
from loadshare.train.columns import SampleTable, columns_of
from loadshare.train.samples import Samples, groups_of, samples_of, unusable
from loadshare.train.shape import shape_of

if TYPE_CHECKING:
    import xarray as xr


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

    Parameters and errors are those of :func:`solve_many`. A sample has no answer at a position that
    only others have. With `least_norm`, displacements that an equilibrium leaves undetermined are
    the least-norm ones, which takes some milliseconds for every sample with any; otherwise they are
    one possible choice.

    Yields
    ------
    Block
    """
    case = opened(case)
    groups = samples_of(case, samples)
    wanted = wanted_of((group.train for _, group in groups), positions)
    yield from _solved(case, groups, wanted, tolerance, engine, workers, least_norm)


def _solved(
    case: Case,
    groups: Sequence[tuple[Numbers, Samples]],
    wanted: tuple[int, ...],
    tolerance: float,
    engine: str,
    workers: int,
    least_norm: bool,
) -> Iterator[Block]:
    """Solve groups of samples, block by block."""
    tolerance, workers = checked_tolerance(tolerance), whole("workers", workers)
    keep_freed_memory()
    total = sum(len(rows) for rows, _ in groups)
    solver = engine_named(engine, total * len(wanted))
    tasks: list[tuple[Machine, Numbers, Samples, slice]] = []
    for rows, group in groups:
        machine = _machine(case, group)
        size = max(min(JOB.block, machine.together), machine.together // len(wanted))
        # Equal blocks: a short one takes more time per sample.
        each = -(-len(rows) // max(1, -(-len(rows) // size)))
        tasks += [(machine, rows, group, slice(at, at + each)) for at in range(0, len(rows), each)]
        if each < len(rows):
            machine.learn(group, _there(group, wanted), solver)

    def work(task: tuple[Machine, Numbers, Samples, slice]) -> Block:
        machine, rows, group, part = task
        samples = group.take(part)
        there = _there(group, wanted)
        found = solve_block(machine, rows[part], samples, there, tolerance, solver, least_norm)
        return found if there == wanted else found.over(wanted)

    with one_thread():
        if workers == 1 or len(tasks) == 1:
            yield from map(work, tasks)
            return
        with ThreadPoolExecutor(workers) as pool:
            queue = iter(tasks)
            running = [pool.submit(work, task) for task in islice(queue, workers + 1)]
            while running:
                block = running.pop(0).result()
                running += [pool.submit(work, task) for task in islice(queue, 1)]
                yield block


def _there(samples: Samples, wanted: tuple[int, ...]) -> tuple[int, ...]:
    """Return the positions that samples have; if none, the first, as a pattern of an answer."""
    return tuple(k for k in wanted if k <= samples.train.count) or (1,)


def _located(wrong: Sequence[tuple[int, CaseError]]) -> CaseError:
    """Return the first of some errors, with its sample unless all samples seem to have it."""
    (number, error), *others = wrong
    said = [[(p.key, p.message) for p in each.problems] for _, each in wrong]
    if others and said[0] == said[1] and (number, others[0][0]) == (0, 1):
        return error
    where = f"In sample {number}, counted from 0."
    return CaseError([replace(p, hint=f"{p.hint} {where}".strip()) for p in error.problems])


_recent: Recent[Machine] = Recent()


def _machine(case: Case, samples: Samples) -> Machine:
    """Return the machine of samples, with the reduced parts of a recent one of the same shape."""
    fixed = [(c.path, c.text(0)) for c in samples.columns if c.path not in samples.values]
    which = (frozenset(samples.values), shape_of(samples.train), *fixed)
    machine, known = Machine(samples.train), _recent.of(case, which)
    if known is None:
        return _recent.keep(case, machine, which)
    machine.share(known)
    return machine


def solve_many(
    case: Case | str | Path,
    samples: SampleTable,
    *,
    positions: Iterable[int] | None = None,
    keep: Iterable[str] = USUAL,
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
        It supplies whatever the samples do not.
    samples : mapping of str to array_like, or data frame
        Values by dotted key, all of one length. The unit is in brackets after the key, as in
        ``{"rings.4.float [um]": [0, 4, 8]}``; texts with units are allowed as well.
    positions : iterable of int, optional
        1-based positions to solve; all by default. Those that a sample does not have are NaN.
    keep : iterable of str
        Variables to keep, of "torque", "share", "pair_share" (computed when they are first read),
        "displacement" and "contact_force".
    tolerance : float
        Largest scaled residual of a certified answer, up to 1e-3.
    engine : {"auto", "compiled", "vectorised"}
        Numba or NumPy, with the same answers. "auto" is Numba once it was used in this process,
        above 300 equilibria if its code is on disk, otherwise above 200 000: compiling takes a
        minute or two, once in an installation; if that fails, the log says so.
    workers : int
        Threads, at least one.
    least_norm : bool
        Whether undetermined displacements are the least-norm ones, as in `solve` (some ms each).
    progress : Progress, optional
        Called after every block with samples done and in all.

    Returns
    -------
    xarray.Dataset
        Over (sample, position): ``torque`` [N·m] (drive less coast), ``share`` and ``pair_share``
        [-] over mesh; ``displacement`` [m] over gear and component, for gears that can be
        displaced; ``contact_force`` [N] of ring contacts; ``residual`` (largest scaled one;
        with Numba without the energy gap, which follows from the others), ``torque_bound`` (largest
        distance of a torque from the exact one, over the largest on a flank or from outside),
        ``certified``, ``determined``, ``displaced`` (displacements over the limit of a warning;
        ``warned`` counts those above 1), ``convex`` (no nonconvex element carries a force),
        ``arc_curvature`` (stiffness that arcs take away across them [N/m]), ``rung`` (see
        ``flag_meanings``; 0: no answer). Refused answers are NaN; ``refused`` (attribute) says why.

    Raises
    ------
    CaseError
        If a key or a value cannot be used; all problems are listed.
    ValueError
        If a position, a variable, an engine, the number of `workers` or the tolerance is not valid.

    Examples
    --------
    >>> import loadshare as ls
    >>> floats = {"rings.4.float [um]": [0.0, 4.0, 12.0]}
    >>> found = ls.solve_many("cases/fgfbstts/limit_ring.toml", floats, positions=[1])
    >>> bool(found.certified.all())
    True
    """
    case, kept, tolerance = opened(case), checked(keep), checked_tolerance(tolerance)
    columns = columns_of(samples)  # Once: it may hold a generator.
    try:
        groups = groups_of(case, columns)
        trains = [group.train for _, group in groups]
        wanted = wanted_of(trains, positions)
        found = AnswerTable(trains, wanted, len(columns[0].values), kept)
        found.fill(_solved(case, groups, wanted, tolerance, engine, workers, least_norm), progress)
    except CaseError as error:
        # The value that it names may be another sample's.
        wrong = list(islice(unusable(case, {c.key: c.values for c in columns}), 2))
        raise _located(wrong) if wrong else error from None
    return found.dataset(case, tolerance)
