"""Kill commands at random times: ``python -m tests.kills --count 200 --seed 1``.

Prints what must not happen, and how often it did; leaves with 1 if anything did.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import typer
from tests.kills.cluster import await_workers, cluster
from tests.kills.trial import KINDS, Bench, Trial, trial


def _run() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.kills", description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first kill")
    options = parser.parse_args()
    start = time.monotonic()
    every = []
    with TemporaryDirectory() as temporary, cluster(Path(temporary), 2) as started:
        await_workers(started.address, 2)
        bench = Bench.of(Path(temporary), KINDS, started)
        typer.echo(", ".join(f"{kind}: {s:.1f} s" for kind, s in bench.seconds.items()))
        for number in range(options.first, options.first + options.count):
            every.append(trial(bench, options.seed, number))
            _tell(every[-1], options.seed)
    typer.echo(f"{len(every)} tried in {time.monotonic() - start:.0f} s")
    return _summarised(every)


def _tell(found: Trial, seed: int) -> None:
    met = "killed" if found.met else "was done already"
    where = f"{found.number} {found.kind}: {found.target} {met} at {found.after:.2f} s"
    typer.echo(f"{where}, gone after {found.gone:.2f} s")
    for fault in (*(f"orphan: {one}" for one in found.orphans), *found.faults):
        typer.echo(f"    {fault}")
    if found.orphans or found.faults:
        typer.echo(f"    --seed {seed} --first {found.number} --count 1")


def _summarised(every: list[Trial]) -> int:
    """Print the figures; return the exit code."""
    for kind, target in sorted({(one.kind, one.target) for one in every}):
        some = [one for one in every if (one.kind, one.target) == (kind, target)]
        killed = sum(one.met for one in some)
        count = Counter(
            orphans=sum(len(one.orphans) for one in some), faults=sum(len(f.faults) for f in some)
        )
        gone = max(one.gone for one in some)
        typer.echo(
            f"{kind}, {target}: {killed} killed, {count['orphans']} orphans, "
            f"{count['faults']} faults, gone after {gone:.2f} s at most"
        )
    killed, orphans = sum(one.met for one in every), sum(len(one.orphans) for one in every)
    faults = sum(len(one.faults) for one in every)
    typer.echo(f"in all: {killed} killed, {orphans} orphans, {faults} faults")
    return 1 if orphans or faults else 0


if __name__ == "__main__":
    sys.exit(_run())
