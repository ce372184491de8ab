"""Measure every method on every workload: time per equilibrium and true error."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

import loadshare as ls
from benchmarks.peers import PEERS, Entry
from benchmarks.peers.form import Form, form_of
from benchmarks.peers.loop import Claim, Failure
from benchmarks.reference import NoReference, Reference, reference
from benchmarks.workloads import Workload
from loadshare.case import Case
from loadshare.certify import certify
from loadshare.scene import assemble
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium

OURS_BATCH, OURS_NUMPY, OURS_SOLVE = "ours, batch", "ours, batch (NumPy)", "ours, solve"
OURS = (OURS_BATCH, OURS_NUMPY, OURS_SOLVE)
PATIENCE = 12.0
"""Seconds that one method at one tolerance may take on a workload; then it has had its samples."""
RUNS = 3
"""Runs of a batch, of which the median counts."""

Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Measure:
    """One method at one tolerance on one workload.

    Attributes
    ----------
    workload, method : str
    tolerance : float or None
        As asked of the method; None where it has none.
    samples : int
        Samples that it was given and whose error is known.
    answered, certified : int
        Of these: answers it claims, and answers that pass the certificate at 1e-9.
    microseconds : float
        Median time of an answer [µs]; of a batch, its time over its samples.
    median, worst : float
        Relative error of its answers.
    setup : float
        Preparation that is not in the time [ms].
    failure : str
        What it said the first time it had no answer.
    """

    workload: str
    method: str
    tolerance: float | None
    samples: int
    answered: int
    certified: int
    microseconds: float
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
        Among the workload's samples; those without a reference are left out.
    case : Case
    train : Train
    form : Form
    truth : Reference
    """

    number: int
    case: Case
    train: Train
    form: Form
    truth: Reference


def prepare(workload: Workload) -> list[Sample]:
    """Build the samples that peers are given, with their references."""
    samples: list[Sample] = []
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
        samples.append(Sample(number, case, train, form_of(assemble(train, 1), like), truth))
    return samples


def error_of(sample: Sample, torque: dict[str, float], moved: dict[str, np.ndarray]) -> float:
    """Relative error of torques and of determined floats against the reference, the larger one."""
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
    """Torques of an answer [N·m], and displacements [m] in the transverse frames."""
    torque = {}
    for name, mesh in train.meshes.items():
        parts = [mesh.lever(d) * found.flank_force[mesh.flank_name(d)] for d in mesh.flanks]
        torque[name] = float(np.sum(parts))
    return torque, {g: train.gears[g].frame @ p for g, p in found.displacement.items()}


def measure(
    workload: Workload, methods: Iterable[str], tell: Tell, samples: Sequence[Sample] | None = None
) -> list[Measure]:
    """Measure methods on a workload; ours before the peers and once more after them.

    A machine's speed changes within the minutes that the peers take: the mean of both times counts.

    Parameters
    ----------
    workload : Workload
    methods : iterable of str
        Names of peers, and of `OURS`.
    tell : callable
        Called with what is being measured.
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
        if first.method in (OURS_BATCH, OURS_SOLVE) and len(found) > 1:
            tell(f"{workload.title}: {first.method}, once more")
            second = _own(workload, samples, first.method)
            both = 0.5 * (first.microseconds + second.microseconds)
            found[k] = replace(first, microseconds=both)
    return found


def _own(workload: Workload, samples: Sequence[Sample], name: str) -> Measure:
    if name == OURS_SOLVE:
        return _single(workload, samples)
    return _batch(workload, samples, name)


def _summary(
    workload: Workload,
    method: str,
    tolerance: float | None,
    asked: int,
    errors: list[float],
    certified: int,
    times: Sequence[float],
    setup: float,
    failure: str,
) -> Measure:
    return Measure(
        workload=workload.name,
        method=method,
        tolerance=tolerance,
        samples=asked,
        answered=len(errors),
        certified=certified,
        microseconds=1e6 * float(np.median(times)) if len(times) else float("nan"),
        median=float(np.median(errors)) if errors else float("nan"),
        worst=max(errors, default=float("nan")),
        setup=1e3 * setup,
        failure=failure,
    )


def _batch(workload: Workload, samples: Sequence[Sample], method: str) -> Measure:
    """`loadshare.solve_many` of all positions on one core, everything included, once it is warm."""
    engine = "vectorised" if method == OURS_NUMPY else "compiled"
    keep = ("torque", "displacement")

    def solve(count: int) -> tuple[Any, float]:
        some = workload.some(count)
        begun = time.perf_counter()
        found = ls.solve_many(workload.case, some, keep=keep, engine=engine, workers=1)
        return found, time.perf_counter() - begun

    _, setup = solve(min(16, workload.count))
    needed = samples[-1].number + 1
    _, seconds = solve(needed)
    count = int(min(workload.count, max(needed, PATIENCE * needed / max(seconds, 1e-6))))
    solve(count)
    answers, seconds = solve(count)
    times = [seconds, *(solve(count)[1] for _ in range(RUNS - 1) if seconds < PATIENCE)]
    each = float(np.median(times)) / answers.certified.size
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
        workload, method, None, len(samples), errors, len(errors), [each], setup, refused
    )


def _single(workload: Workload, samples: Sequence[Sample]) -> Measure:
    """`loadshare.solve` of a case at all its positions, the second time it is asked."""
    errors, times, failure = [], [], ""
    begun = time.perf_counter()
    ls.solve(samples[0].case, engine="compiled")
    setup = time.perf_counter() - begun
    for sample in samples:
        try:
            ls.solve(sample.case, engine="compiled")
            begun = time.perf_counter()
            result = ls.solve(sample.case, engine="compiled")
        except ls.Refused as refused:
            failure = failure or str(refused)
            continue
        times.append((time.perf_counter() - begun) / len(result.positions))
        position = result.positions[0]
        moved = {g: np.array(p) for g, p in position.displacement.items()}
        errors.append(error_of(sample, dict(position.torque), moved))
    return _summary(
        workload, OURS_SOLVE, None, len(samples), errors, len(errors), times, setup, failure
    )


def _peer(workload: Workload, samples: Sequence[Sample], entry: Entry, tolerance: float) -> Measure:
    begun = time.perf_counter()
    peer = entry.make(tolerance)
    peer.prepare(samples[0].form)
    setup = time.perf_counter() - begun
    with suppress(Failure):
        peer.solve(samples[0].form)
    errors: list[float] = []
    times: list[float] = []
    certified, asked, failure = 0, 0, ""
    started = time.perf_counter()
    if hasattr(peer, "solve_many"):
        forms = [s.form for s in samples]
        peer.solve_many(forms)
        begun = time.perf_counter()
        claims: list[Claim | Failure] = peer.solve_many(forms)
        times = [(time.perf_counter() - begun) / len(forms)]
    else:
        claims = []
        for sample in samples:
            if time.perf_counter() - started > PATIENCE:
                break
            begun = time.perf_counter()
            try:
                claim: Claim | Failure = peer.solve(sample.form)
                times.append(time.perf_counter() - begun)
            except Failure as said:
                claim = said
            claims.append(claim)
    for sample, claim in zip(samples, claims, strict=False):
        asked += 1
        if isinstance(claim, Failure):
            failure = failure or str(claim)
            continue
        found = sample.form.equilibrium(claim.x, claim.forces, claim.pulls)
        certified += certify(sample.train, found).passed
        errors.append(error_of(sample, *claimed(sample.train, found)))
    return _summary(
        workload, entry.name, tolerance, asked, errors, certified, times, setup, failure
    )
