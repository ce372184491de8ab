"""The main job: how many samples at a time, by which method, for how long."""

from __future__ import annotations

from typing import NamedTuple


class Job(NamedTuple):
    """How cases and samples are solved: rungs, engines, blocks."""

    least: float = 1e-3
    """Force, in loads, at which the tangent of the law of a contact that carries less is taken."""
    plainly: float = 1e-6
    """Overlap of rigid limits, over the largest length, above which nothing else need be tried."""
    steps: int = 20_000
    """Newton steps in which the rungs after the fast method answer or give up: some ten seconds,
    and twice what ever led to an answer that neither exchange nor search had found."""
    few: int = 300
    """Equilibria up to which loading compiled code costs more than it saves: between 150, for
    trains with all elements, and 4000, for the seed's rings and splines."""
    compiling: int = 200_000
    """Equilibria up to which compiling, where nothing is on disk, costs more than it saves: NumPy
    takes as long for this many, of trains between the seed's and those with all elements."""
    extremes: int = 1000
    """Most parts of a table of samples whose extremes are judged, where those of the whole table
    make no valid case: some seconds."""
    block: int = 4096
    """Samples that are solved together, if every one has a few positions."""
    together: int = 20 * 1024
    """Equilibria that are solved together: four times as many take as much time, and 350 MiB more
    memory with two workers."""
    allocated: int = 32 * 2**20
    """Bytes of an array up to which its memory is reused: the most that glibc allows."""
    kept: int = 256 * 2**20
    """Bytes that are kept from block to block: with less, pages are fetched again."""
    workers: int = 2
    """Threads; the compiled passes hold no lock."""
    each: int = 20
    """Positions of a train up to which the situations of all are worked out with that of the first,
    as the others are mostly needed next."""
    recent: int = 16
    """Machines that are kept, for callers that solve samples of one case again and again."""
    led: int = 16
    """Samples started where the search for another one ended, of which at least one must be solved
    for this to be tried again: a search takes some ten times as long as such a sample."""
    starts: int = 64
    """Starts of a search for other answers: sets of contacts and places drawn at random."""
    path: int = 12
    """Steps of the path, each with half the extra clearance of the one before, the last with
    none."""
    generous: float = 100.0
    """Extra clearance at which the path begins, in deflections of the case: no arc carries
    there."""
    small: float = 0.9
    """Part of the bound of a refusal below which displacements measured for many answers at once
    are not measured one by one; the two ways differ by round-off."""
    same: float = 1e-6
    """Largest difference of flank forces, in loads, of answers that count as the same."""
    lighter: tuple[float, ...] = (0.7, 0.5, 0.1)
    """Shares of the load that are tried where arcs may have lost their hold under the full load."""


JOB = Job()
