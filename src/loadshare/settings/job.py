"""The main job: how many samples at a time, which way, how long."""

from __future__ import annotations

from typing import NamedTuple


class Job(NamedTuple):
    """How cases and samples are taken through: rungs, engines, blocks."""

    least: float = 1e-3
    """Force, in loads, at which the law of a contact that carries less is taken as its tangent."""
    plainly: float = 1e-6
    """Overlap of rigid limits, over the lengths at hand, after which nothing else need be tried."""
    steps: int = 20_000
    """Newton steps in which the rungs after the hot path answer or give up: some ten seconds, and
    twice what ever led to an answer that neither exchange nor search had found."""
    few: int = 300
    """Equilibria up to which reading what was compiled costs more than it saves: between trains of
    all elements, where that is so up to 150, and the seed's rings and splines, up to 4000."""
    compiling: int = 200_000
    """Equilibria up to which compiling, where nothing is on disk, costs more than it saves: NumPy
    takes as long for so many, of trains between the seed's and those of all elements."""
    extremes: int = 1000
    """Parts of a table of samples whose extremes are judged together, where those of all make no
    case: some seconds."""
    block: int = 4096
    """Samples that are solved together, if every one has a few positions."""
    together: int = 20 * 1024
    """Equilibria that are solved together: four times as many take as much time, and 350 MiB more
    memory with two workers."""
    allocated: int = 32 * 2**20
    """Bytes of an array up to which its memory is used again: the most that glibc allows."""
    kept: int = 256 * 2**20
    """Bytes that are kept from block to block: with less, pages are fetched again."""
    workers: int = 2
    """Threads; the compiled passes hold no lock."""
    each: int = 20
    """Positions of a train up to which what the first one brings is worked out with all others,
    which are mostly asked for next."""
    recent: int = 16
    """Machines that are kept, for those who solve samples of one case again and again."""
    led: int = 16
    """Samples that begin where the search for another one ended, of which at least one must be
    solved for it to be tried again: a search takes some ten times as long as such a sample."""
    starts: int = 64
    """Starts: sets of contacts and places drawn at random."""
    path: int = 12
    """Steps of the path, each with half the extra clearance of the one before, and at last none."""
    generous: float = 100.0
    """Extra clearance at which the path begins, in deflections of the case: no arc carries
    there."""
    small: float = 0.9
    """Part of what is refused below which displacements, measured of many answers at once, are not
    measured one by one; the two ways differ by round-off."""
    same: float = 1e-6
    """Largest difference of flank forces, in loads, of answers that are the same."""
    lighter: tuple[float, ...] = (0.7, 0.5, 0.1)
    """Shares of the load that are looked at where arcs may have lost their hold under all of it."""


JOB = Job()
