"""Settle the samples of a workload on a graphics processor and on a core of its host."""

# Numba has no types.
# mypy: disable-error-code="attr-defined,no-untyped-call"

from __future__ import annotations

import time
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
from numba import cuda
from numpy.typing import NDArray

from benchmarks.graphics.kernel import ASKED, floats_of, settling
from benchmarks.workloads import Workload
from loadshare.array_types import States
from loadshare.job.machine import Machine
from loadshare.scene.loading import Loading, loading_of
from loadshare.scene.structure import Structure
from loadshare.settings import EXCHANGE
from loadshare.solver.hot import compiled
from loadshare.solver.hot.contact_states import DONE
from loadshare.solver.hot.exchange import ExchangeResult, exchange
from loadshare.solver.hot.iterate import Iterate, at_rest
from loadshare.solver.hot.kernel.set_arrays import SampleArrays, packed_sets
from loadshare.solver.hot.kernel.work import Given
from loadshare.solver.hot.rule import rule_of, samples_to_learn
from loadshare.train import build_train
from loadshare.train.samples import samples_of
from loadshare.train.situations import stack

RUNS = 3
"""Number of runs; the median counts."""
BLOCKS = (64, 128, 256)
"""Numbers of threads per block that are tried."""


@dataclass(frozen=True, slots=True)
class Measure:
    """The measurement of a workload on a core and on the device.

    Attributes
    ----------
    workload : str
    title : str
    equilibria : int
    core, device, moved : float
        Time of an equilibrium on a core, on the device, and for moving its input and its answer
        [µs].
    threads : int
        Threads of a block on the device.
    sets : int
        Number of active sets that samples visited.
    visits : float
        Mean number of active sets that a sample visits.
    settled, settled_by_core : int
        Number of equilibria that the device finds, and that the core finds.
    alike : int
        Number of equilibria that both find on the same active set.
    worst : float
        Largest difference of forces on the same set, over the largest force of the sample.
    """

    workload: str
    title: str
    equilibria: int
    core: float
    device: float
    moved: float
    threads: int
    sets: int
    visits: float
    settled: int
    settled_by_core: int
    alike: int
    worst: float


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """Samples of a machine, and their start."""

    structure: Structure
    loading: Loading
    iterate: Iterate
    states: States

    def fresh(self) -> Iterate:
        """Return a copy of the iterate at the start."""
        return self.iterate.take(np.arange(self.loading.count))


def prepared(workload: Workload, count: int) -> Prepared:
    """Return `count` equilibria over all positions; each starts on the set the rule predicts."""
    positions = range(1, build_train(workload.case).count + 1)
    ((_, samples),) = samples_of(workload.case, workload.drawn(count // len(positions)))
    machine = Machine(samples.train)
    structure = machine.structure
    loading = loading_of(structure, stack([samples.situations(k) for k in positions]))
    taught = loading.take(samples_to_learn(loading.count))
    forces = at_rest(structure, taught)
    found = exchange(structure, taught, forces, compiled.settle)
    states, iterate = rule_of(structure, taught, found.states, forces).start(structure, loading)
    return Prepared(structure, loading, iterate, states)


def on_core(start: Prepared) -> tuple[float, Iterate, ExchangeResult]:
    """Settle on one core; return the time [s], the iterate and what was found."""
    times = []
    for _ in range(RUNS):
        iterate = start.fresh()
        begun = time.perf_counter()
        found = exchange(start.structure, start.loading, iterate, compiled.settle, start.states)
        times.append(time.perf_counter() - begun)
    return float(np.median(times)), iterate, found


_KEYS = np.random.default_rng(5).integers(1 << 62, size=1 << 12) | 1


class Device:
    """Samples on the device, with the active sets that are prepared so far."""

    def __init__(self, start: Prepared, kernel: Any, floats: int) -> None:
        self.start, self.kernel, self.floats = start, kernel, floats
        self.sets = np.unique(start.states, axis=0)
        opposed = [
            pair
            for pair in start.structure.opposed
            if not start.loading.bending[:, start.structure.springs + np.array(pair)].any()
        ]
        self.opposed = cuda.to_device(np.array(opposed, dtype=np.int64).reshape(-1, 2))
        self.samples = SampleArrays._make(
            cuda.to_device(np.ascontiguousarray(getattr(start.loading, name)))
            for name in SampleArrays._fields
        )
        self._pack()

    def _pack(self) -> None:
        if _floats(self.start, self.sets) > self.floats:
            raise ValueError("a set is too large for the kernel")
        packed = *packed_sets(self.start.structure, self.start.loading, self.sets), self.sets
        self.packed = tuple(cuda.to_device(np.ascontiguousarray(one)) for one in packed)
        key_of = _KEYS[: self.sets.shape[1]]
        keys = self.sets.astype(np.int64) @ key_of
        order = np.argsort(keys)
        lookup = keys[order], order, key_of
        self.lookup = *(cuda.to_device(np.ascontiguousarray(one)) for one in lookup), self.opposed

    def begin(self) -> None:
        """Put the samples back to their start."""
        iterate, states, count = self.start.fresh(), self.start.states, self.start.loading.count
        given = Given(
            np.arange(count),
            iterate.x,
            iterate.force,
            iterate.root,
            iterate.floor,
            np.zeros(count, dtype=bool),
            np.full(count, ASKED, dtype=np.int8),
            np.zeros(states.shape, dtype=np.int8),
        )
        self.given = Given._make(cuda.to_device(one) for one in given)
        self.states = cuda.to_device(states)
        self.turns = cuda.to_device(np.zeros(count, dtype=np.int64))

    def launch(self, some: NDArray[np.intp], threads: int) -> float:
        """Settle some samples; return the time of the device [s]."""
        rows = cuda.to_device(some)
        begun, ended = cuda.event(), cuda.event()
        begun.record()
        blocks = -(-len(some) // threads)
        self.kernel[blocks, threads](
            self.packed,
            self.lookup,
            self.samples,
            self.given,
            self.states,
            self.turns,
            rows,
            EXCHANGE.turns,
        )
        ended.record()
        ended.synchronize()
        return float(cuda.event_elapsed_time(begun, ended)) * 1e-3

    def settle(self, threads: int) -> int:
        """Settle all samples, preparing the sets they ask for; return the number of launches."""
        self.begin()
        some, times = self._order(np.arange(self.start.loading.count)), 0
        while len(some):
            self.launch(some, threads)
            times += 1
            asked = self.given.verdict.copy_to_host() == ASKED
            some = np.flatnonzero(asked)
            if len(some):
                # A set that was asked for is prepared for the next launch.
                more = np.unique(self.states.copy_to_host()[some], axis=0)
                self.sets = np.unique(np.concatenate([self.sets, more]), axis=0)
                self._pack()
        return times

    def timed(self, threads: int) -> float:
        """Return the median time of all samples [s] when every set is prepared."""
        some, times = self._order(np.arange(self.start.loading.count)), []
        for _ in range(RUNS):
            self.begin()
            times.append(self.launch(some, threads))
        return float(np.median(times))

    def _order(self, some: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return samples sorted by their first set, so that neighbours take the same steps."""
        keys = self.start.states[some].astype(np.int64) @ _KEYS[: self.sets.shape[1]]
        return some[np.argsort(keys, kind="stable")]

    def moved(self) -> float:
        """Return the median time to bring samples to the device and answers back [s].

        The host memory is pinned, and memory is allocated on both sides before.
        """
        there = [*self.samples, self.given.roots, self.states]
        back = [self.given.xs, self.given.forces, self.given.verdict, self.states]
        here = [one.copy_to_host() for one in there], [one.copy_to_host() for one in back]
        times = []
        with cuda.pinned(*(one for one in (*here[0], *here[1]) if one.size)):
            for _ in range(RUNS):
                begun = time.perf_counter()
                for device, host in zip(there, here[0], strict=True):
                    device.copy_to_device(host)
                for device, host in zip(back, here[1], strict=True):
                    device.copy_to_host(host)
                cuda.synchronize()
                times.append(time.perf_counter() - begun)
        return float(np.median(times))


def measured(workload: Workload, start: Prepared, kernel: Any, floats: int) -> Measure:
    """Measure a workload on both, and compare the answers."""
    count = start.loading.count
    core, iterate, found = on_core(start)
    device = Device(start, kernel, floats)
    device.settle(BLOCKS[0])
    visits = float(device.turns.copy_to_host().mean())
    times = {threads: device.timed(threads) for threads in BLOCKS}
    threads = min(times, key=lambda width: times[width])
    done = device.given.verdict.copy_to_host() == DONE
    both = done & found.solved
    alike = both & (device.states.copy_to_host() == found.states).all(axis=1)
    force = device.given.forces.copy_to_host()[alike]
    other = iterate.force[alike]
    largest = np.abs(other).max(axis=1, initial=0.0)
    off = np.abs(force - other).max(axis=1, initial=0.0) / np.where(largest > 0.0, largest, 1.0)
    return Measure(
        workload.name,
        workload.title,
        count,
        core / count * 1e6,
        times[threads] / count * 1e6,
        device.moved() / count * 1e6,
        threads,
        len(device.sets),
        visits,
        int(done.sum()),
        int(found.solved.sum()),
        int(alike.sum()),
        float(off.max(initial=0.0)),
    )


def kernel_for(starts: list[Prepared], registers: int | None = None) -> tuple[Any, int]:
    """Return one kernel that suits the sets of all, and the number of floats of a thread."""
    floats = 2 * max(_floats(start, np.unique(start.states, axis=0)) for start in starts)
    return settling(floats, max(start.states.shape[1] for start in starts), registers), floats


def device_facts(kernel: Any) -> dict[str, str]:
    """Return the device, and the registers and local memory of a thread of the kernel."""
    (registers,) = kernel.get_regs_per_thread().values()
    (local,) = kernel.get_local_mem_per_thread().values()
    return {
        "device": cuda.get_current_device().name,
        "Numba for CUDA": version("numba-cuda"),
        "registers of a thread": str(registers),
        "local memory of a thread [B]": str(local),
    }


def _floats(start: Prepared, sets: States) -> int:
    """Return the number of floats that a thread needs for the largest of some sets."""
    _, numbers, begins = packed_sets(start.structure, start.loading, sets)
    return max(floats_of(numbers[at:], start.structure.size) for at in begins[:, 1])
