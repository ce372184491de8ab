"""Tolerance study of the seed's transmission: time, rate and memory, also for a peer.

Run with ``python -m benchmarks.tolerance [--samples N] [--workers K] [--peers N]``. The peer is a
loop over CVXPY with parameters, compiled once and solved again for every sample and position. It
gets the first samples of the study, and its answers are compared with the study's. The time of the
peer includes neither the preparation of its data nor its compilation; the time of the study
includes everything.
"""

from __future__ import annotations

import argparse
import os
import resource
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

import loadshare as ls
from benchmarks.machine_facts import facts
from benchmarks.peers import PEERS
from benchmarks.peers.form import form_of
from benchmarks.peers.loop import Failure
from loadshare.results.share import forces_of, largest_shares, mesh_torques
from loadshare.scene import assemble
from loadshare.study.tolerance.result import Tolerance
from loadshare.train import build_train

CASE = Path(__file__).parents[1] / "cases/fgfbstts/tolerance.toml"
STUDY = "errors"


def main() -> None:
    """Run the study, then the peer, and print a Markdown table."""
    parser = argparse.ArgumentParser(description="Time, rate and memory of a tolerance study.")
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--sampling", choices=("random", "sobol"), default="random")
    parser.add_argument("--peers", type=int, default=20, help="number of samples for the peer")
    options = parser.parse_args()
    case = ls.load_case(CASE)
    with tempfile.TemporaryDirectory() as folder:
        watch = Watch()
        start = time.perf_counter()
        ends: list[float] = []
        found = ls.tolerance(
            case,
            study=STUDY,
            samples=options.samples,
            sampling=options.sampling,
            indices=0,
            worst=False,
            out=Path(folder) / "study",
            workers=options.workers,
            engine="compiled",
            progress=lambda done, total: ends.append(time.perf_counter()),
        )
        whole = time.perf_counter() - start
        own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        worker = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        together = watch.stop()
        disk = sum(file.stat().st_size for file in found.parts)
        positions = len(found.settings["positions"])
        equilibria = options.samples * positions
        rows = [
            ("samples × positions", f"{options.samples:,} × {positions}"),
            ("inputs", str(len(found.inputs.every))),
            ("worker processes", str(options.workers)),
            ("time, all included [s]", f"{whole:.1f}"),
            ("of it, sampling and solving [s]", f"{ends[-1] - ends[0]:.1f}"),
            ("equilibria per second", f"{equilibria / whole:,.0f}"),
            ("peak memory: study [MiB]", f"{own / 1024:.0f}"),
            ("peak memory: a worker [MiB]", f"{worker / 1024:.0f}"),
            ("peak memory: all together [MiB]", f"{together / 1024:.0f}"),
            ("Parquet [MB]", f"{disk / 1e6:.0f}"),
            ("certified samples", f"{found.samples - found.refused:,}"),
            ("largest residual", f"{found.residual:.1e}"),
        ]
        rows += peer_way(case, found, options.peers, whole / equilibria)
    rows += [(name, value) for name, value in facts().items()]
    print("| | |\n|---|---|")  # noqa: T201
    print("\n".join(f"| {name} | {value} |" for name, value in rows))  # noqa: T201


class Watch(threading.Thread):
    """Largest resident memory of this process and its workers together [KiB] (Linux)."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.peak = 0
        self._done = threading.Event()
        self.start()

    def run(self) -> None:
        """Sample the memory five times a second."""
        while not self._done.wait(0.2):
            self.peak = max(self.peak, sum(map(_resident, self._processes())))

    def stop(self) -> int:
        """End, and return the peak."""
        self._done.set()
        self.join()
        return self.peak

    def _processes(self) -> list[str]:
        tasks = Path(f"/proc/{os.getpid()}/task").glob("*/children")
        return [str(os.getpid()), *(pid for task in tasks for pid in task.read_text().split())]


def _resident(process: str) -> int:
    try:
        lines = Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("VmRSS"))


def peer_way(case: ls.Case, found: Tolerance, count: int, ours: float) -> list[tuple[str, str]]:
    """Solve the first samples by CVXPY with parameters; `ours` is the study's time for each [s]."""
    entry = PEERS["CVXPY, parameters"]
    tolerance = min(entry.tolerances)
    peer = entry.make(tolerance)
    columns = [one.column for one in found.inputs.every]
    inputs = found.to_frame(columns).head(count).to_numpy()
    omega = found.to_frame(["omega.system"])["omega.system"].to_numpy()
    like, spent, apart, failed = None, 0.0, 0.0, 0
    positions = found.settings["positions"]
    for sample, values in enumerate(inputs):
        train = build_train(case.replace(found.inputs.changes(values.tolist())))
        forces = []
        for index in positions:
            form = form_of(assemble(train, index), like)
            if like is None:
                like = form
                peer.prepare(form)
                peer.solve(form)
            start = time.perf_counter()
            try:
                claim = peer.solve(form)
            except Failure:
                failed += 1
                continue
            finally:
                spent += time.perf_counter() - start
            forces.append(form.equilibrium(claim.x, claim.forces, claim.pulls).flank_force)
        torques = mesh_torques(train, forces_of(train, forces))
        top = largest_shares(torques, train.stages)["system"]
        if len(forces) == len(positions) and not np.isnan(top).all():
            apart = max(apart, abs(float(np.nanmax(top)) - omega[sample]))
    each = spent / (count * len(positions))
    return [
        ("peer: CVXPY with parameters, samples", f"{count} at tolerance {tolerance:g}"),
        ("peer: time per equilibrium [µs]", f"{1e6 * each:,.0f}"),
        ("study: time per equilibrium, all included [µs]", f"{1e6 * ours:.2f}"),
        ("ratio", f"{each / ours:,.0f}"),
        ("peer: equilibria not solved", str(failed)),
        ("largest difference of Ω", f"{apart:.1e}"),
    ]


if __name__ == "__main__":
    main()
