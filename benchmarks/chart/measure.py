"""Measure every method on every workload: time per equilibrium and true error."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

import loadshare as ls
from benchmarks.peers import PEERS, Entry
from benchmarks.peers.clock import Clock
from benchmarks.peers.form import Form, form_of
from benchmarks.peers.loop import Claim, Failure
from benchmarks.reference import NoReference, Reference, reference
from benchmarks.workloads import Workload
from loadshare.case import Case
from loadshare.certify import certify
from loadshare.scene import assemble
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium

OURS_BATCH, OURS_FIRST = "ours, batch", "ours, batch (new case)"
OURS_NUMPY = "ours, batch (NumPy)"
OURS_NEW, OURS_SOLVE = "ours, solve (new case)", "ours, solve (again)"
OURS = (OURS_BATCH, OURS_FIRST, OURS_NUMPY, OURS_NEW, OURS_SOLVE)
PATIENCE = 12.0
"""Seconds that one method at one tolerance may take on a workload; then no further samples are
solved."""
RUNS = 3
"""Runs of a batch; the median counts."""

Tell = Callable[[str], None]
Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True)
class Measure:
    """One method at one tolerance on one workload.

    Attributes
    ----------
    workload, method : str
    tolerance : float or None
        As requested from the method; None for a method without one.
    samples : int
        Samples that it was given and that have a reference.
    answered, certified : int
        Of these: those that it answered, and those whose answers pass the certificate at 1e-9.
    microseconds, cpu : float
        Median time of an answer, elapsed and of the processor [µs]; for a batch, its time divided
        by the number of its equilibria.
    inside, inside_cpu : float
        The part of these times inside the peer's compiled calls [µs]; NaN if it has none.
    reported : float
        Time that the peer's solver reports [µs], which may not include updates of its data.
    median, worst : float
        Relative error of its answers.
    setup : float
        Preparation that is not part of the time [ms].
    failure : str
        Message of the first sample without an answer.
    """

    workload: str
    method: str
    tolerance: float | None
    samples: int
    answered: int
    certified: int
    microseconds: float
    cpu: float
    inside: float
    inside_cpu: float
    reported: float
    median: float
    worst: float
    setup: float
    failure: str

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data."""
        return asdict(self)


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """One sample with everything that a method may need, and its reference.

    Attributes
    ----------
    number : int
        Among the workload's samples. Samples without a reference are left out.
    case : Case
    train : Train
    form, reduced : Form
        The whole problem, and the problem with only those contacts that act in the answer of some
        sample: a better reduction than is possible before all answers are known.
    truth : Reference
    """

    number: int
    case: Case
    train: Train
    form: Form
    reduced: Form
    truth: Reference


@dataclass(slots=True)
class Times:
    """Times per answer [s]: one entry of each kind per timed piece of work."""

    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    inside: list[float] = field(default_factory=list)
    inside_cpu: list[float] = field(default_factory=list)
    reported: list[float] = field(default_factory=list)

    def take(
        self, work: Callable[[], Answer], shared: int = 1, clock: Clock | None = None
    ) -> Answer:
        """Time work that gives `shared` answers at once; work that raises is not counted."""
        if clock is not None:
            clock.reset()
        cpu, wall = time.process_time(), time.perf_counter()
        found = work()
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        self.wall.append(wall / shared)
        self.cpu.append(cpu / shared)
        if clock is not None:
            self.inside.append(1e-9 * clock.wall / shared)
            self.inside_cpu.append(1e-9 * clock.cpu / shared)
            if clock.reported > 0.0:
                self.reported.append(clock.reported / shared)
        return found

    def microseconds(self) -> dict[str, float]:
        """Return the medians [µs] under the names of `Measure`."""
        kinds = ("wall", "cpu", "inside", "inside_cpu", "reported")
        medians = {
            k: 1e6 * float(np.median(v)) if (v := getattr(self, k)) else math.nan for k in kinds
        }
        return {"microseconds": medians.pop("wall"), **medians}


def prepare(workload: Workload) -> list[Sample]:
    """Build the samples that peers are given, with their references."""
    samples: list[Sample] = []
    acting: set[str] = set()
    for number, case in enumerate(workload.cases(workload.peers)):
        train = build_train(case)
        like = samples[0].form if samples else None
        try:
            hint = ls.explain(case, 1).equilibrium
        except ls.Refused:
            hint = None
        try:
            truth = reference(train, 1, hint)
        except NoReference:
            continue
        if hint is not None:
            for forces in (hint.flank_force, hint.ring_force):
                acting |= {name for name, force in forces.items() if force > 0.0}
        form = form_of(assemble(train, 1), like)
        samples.append(Sample(number, case, train, form, form, truth))
    return [replace(s, reduced=s.form.only(acting)) for s in samples]


def error_of(sample: Sample, torque: dict[str, float], moved: dict[str, np.ndarray]) -> float:
    """Return the relative error of torques or of determined floats, whichever is larger."""
    truth = sample.truth
    size = max(abs(t) for t in truth.torque.values())
    worst = max(abs(torque[m] - t) for m, t in truth.torque.items()) / size
    known = {g: p for g, p in truth.displacement.items() if g not in truth.loose}
    far = max((float(np.linalg.norm(p)) for p in known.values()), default=0.0)
    if far > 0.0:
        apart = max(float(np.linalg.norm(moved[g] - p)) for g, p in known.items())
        worst = max(worst, apart / far)
    return float(worst)


def claimed(train: Train, found: Equilibrium) -> tuple[dict[str, float], dict[str, np.ndarray]]:
    """Return the torques of an answer [N·m], and displacements [m] in the transverse frames."""
    torque = {}
    for name, mesh in train.meshes.items():
        parts = [mesh.lever(d) * found.flank_force[mesh.flank_name(d)] for d in mesh.flanks]
        torque[name] = float(np.sum(parts))
    return torque, {g: train.gears[g].frame @ p for g, p in found.displacement.items()}


def measure(
    workload: Workload, methods: Iterable[str], tell: Tell, samples: Sequence[Sample] | None = None
) -> list[Measure]:
    """Measure methods on a workload; ours before the peers and again after them.

    The computer's speed changes within the minutes that the peers take, so the mean of both times
    counts.

    Parameters
    ----------
    workload : Workload
    methods : iterable of str
        Names of peers, and of `OURS`.
    tell : callable
        Called with the name of each measurement.
    samples : sequence of Sample, optional
        Prepared ones.
    """
    samples = prepare(workload) if samples is None else samples
    found: list[Measure] = []
    for name in methods:
        tell(f"{workload.title}: {name}")
        if name in OURS:
            found.append(_own(workload, samples, name))
        else:
            entry = PEERS[name]
            if entry.missing or workload.kind.split(",")[0] not in entry.kinds:
                continue
            found += [_peer(workload, samples, entry, t) for t in entry.tolerances]
    for k, first in enumerate(found):
        if first.method in (OURS_BATCH, OURS_NEW, OURS_SOLVE) and len(found) > 1:
            tell(f"{workload.title}: {first.method}, once more")
            second = _own(workload, samples, first.method)
            wall = 0.5 * (first.microseconds + second.microseconds)
            found[k] = replace(first, microseconds=wall, cpu=0.5 * (first.cpu + second.cpu))
    return found


def _own(workload: Workload, samples: Sequence[Sample], name: str) -> Measure:
    if name in (OURS_NEW, OURS_SOLVE):
        return _single(workload, samples, name)
    return _batch(workload, samples, name)


def _summary(
    workload: Workload,
    method: str,
    tolerance: float | None,
    count: int,
    errors: list[float],
    certified: int,
    times: Times,
    setup: float,
    failure: str,
) -> Measure:
    return Measure(
        workload=workload.name,
        method=method,
        tolerance=tolerance,
        samples=count,
        answered=len(errors),
        certified=certified,
        **times.microseconds(),
        median=float(np.median(errors)) if errors else float("nan"),
        worst=max(errors, default=float("nan")),
        setup=1e3 * setup,
        failure=failure,
    )


def _batch(workload: Workload, samples: Sequence[Sample], method: str) -> Measure:
    """Measure `loadshare.solve_many` for all positions on one core, everything included.

    The case was solved before; for `OURS_FIRST` it is a new object (see `_single`).
    """
    engine = "vectorised" if method == OURS_NUMPY else "compiled"
    keep = ("torque", "displacement")

    def solve(count: int, times: Times | None = None) -> tuple[Any, float]:
        some, times, case = workload.some(count), times or Times(), workload.case
        if method == OURS_FIRST:
            case = Case(case.to_dict(), name=case.name)
        answers = times.take(
            lambda: ls.solve_many(case, some, keep=keep, engine=engine, workers=1),
            count * positions,
        )
        return answers, times.wall[-1] * count * positions

    positions = build_train(workload.case).count
    _, setup = solve(min(16, workload.count))
    # The number of samples is found from a run long enough that the cost of a call hardly counts.
    needed, some = samples[-1].number + 1, min(workload.count, 1000)
    _, seconds = solve(some)
    count = int(min(workload.count, max(needed, PATIENCE * some / max(seconds, 1e-6))))
    solve(count)
    times = Times()
    answers, seconds = solve(count, times)
    for _ in range(RUNS - 1):
        if seconds < PATIENCE:
            solve(count, times)
    errors = []
    meshes, gears = [str(m) for m in answers.mesh.values], [str(g) for g in answers.gear.values]
    for sample in samples:
        k = sample.number
        if bool(answers.certified.values[k, 0]):
            torque = dict(zip(meshes, answers.torque.values[k, 0].tolist(), strict=True))
            moved = dict(zip(gears, answers.displacement.values[k, 0], strict=True))
            errors.append(error_of(sample, torque, moved))
    total = int(answers.certified.values.sum())
    every = answers.certified.size
    refused = "" if total == every else f"{every - total} of {every} refused"
    return _summary(
        workload, method, None, len(samples), errors, len(errors), times, setup, refused
    )


def _single(workload: Workload, samples: Sequence[Sample], name: str) -> Measure:
    """Measure `loadshare.solve` at all positions, of a new case or of one solved just before.

    A case is new if this object was never solved or built into a train; what was learnt from cases
    with other numbers is still known.
    """
    errors, times, failure = [], Times(), ""
    setup = Times()
    setup.take(lambda: ls.solve(samples[0].case, engine="compiled"))
    for sample in samples:
        case = (
            Case(sample.case.to_dict(), name=sample.case.name) if name == OURS_NEW else sample.case
        )
        try:
            if name == OURS_SOLVE:
                ls.solve(case, engine="compiled")
            result = times.take(
                partial(ls.solve, case, engine="compiled"), build_train(sample.case).count
            )
        except ls.Refused as refused:
            failure = failure or str(refused)
            continue
        position = result.positions[0]
        moved = {g: np.array(p) for g, p in position.displacement.items()}
        errors.append(error_of(sample, dict(position.torque), moved))
    return _summary(
        workload, name, None, len(samples), errors, len(errors), times, setup.wall[0], failure
    )


def _peer(workload: Workload, samples: Sequence[Sample], entry: Entry, tolerance: float) -> Measure:
    forms = [s.reduced if entry.reduced else s.form for s in samples]
    setup_start = time.perf_counter()
    peer = entry.make(tolerance)
    errors: list[float] = []
    times = Times()
    certified, tried, failure = 0, 0, ""
    clock: Clock | None = getattr(peer, "clock", None)
    claims: list[Claim | Failure] = []
    try:
        peer.prepare(forms[0])
    except Failure as no_answer:
        claims = [no_answer] * len(forms)
    setup = time.perf_counter() - setup_start
    with suppress(Failure):
        peer.solve(forms[0])
    started = time.perf_counter()
    if not claims and hasattr(peer, "solve_many"):
        peer.solve_many(forms)
        claims = times.take(partial(peer.solve_many, forms), len(forms), clock)
    elif not claims:
        for form in forms:
            if time.perf_counter() - started > PATIENCE:
                break
            try:
                claims.append(times.take(partial(peer.solve, form), 1, clock))
            except Failure as no_answer:
                claims.append(no_answer)
    for sample, form, claim in zip(samples, forms, claims, strict=False):
        tried += 1
        if isinstance(claim, Failure):
            failure = failure or str(claim)
            continue
        found = form.equilibrium(claim.x, claim.forces, claim.pulls)
        certified += certify(sample.train, found).passed
        errors.append(error_of(sample, *claimed(sample.train, found)))
    return _summary(
        workload, entry.name, tolerance, tried, errors, certified, times, setup, failure
    )
