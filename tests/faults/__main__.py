"""Let file-system calls fail one after the other: ``python -m tests.faults``.

Prints what must not happen, and how many faults were tried; leaves with 1 if anything went wrong.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import typer
from tests.faults.scenes import (
    ENVIRONMENT,
    Scene,
    batch_scenes,
    file_scenes,
    study_scenes,
    worker_scenes,
)
from tests.faults.server import Server
from tests.faults.shim import Shim, why_not
from tests.faults.trial import KINDS, Stage


def _tried(
    scene: Scene, folder: Path, server: Server, shim: Shim, options: argparse.Namespace
) -> int:
    """Try the faults of a scene, print what was found, and return how many are wrong."""
    stage = Stage(scene, folder, server, shim)
    wrong, faults, bad, reported = Counter[str](), Counter[str](), 0, time.monotonic()
    start = reported
    planned = stage.plan(options.step, options.once)
    for number, fault in planned[options.first :]:
        found = stage.trial(number, fault)
        faults[fault if found.seen.hit else "none"] += 1
        wrong.update({one.kind for one in found.wrong})
        bad += bool(found.wrong)
        if found.wrong:
            typer.echo(f"  {found}")
        if time.monotonic() - reported > 60.0:
            reported = time.monotonic()
            typer.echo(f"  {scene.name}: {sum(faults.values()):,} so far")
        if options.seconds is not None and time.monotonic() - start > options.seconds:
            typer.echo(f"  {scene.name}: stopped after {options.seconds} s")
            break
    met = ", ".join(f"{count} {name}" for name, count in sorted(faults.items()))
    kinds = ", ".join(f"{wrong[kind]} {kind}" for kind in KINDS)
    tried, seconds = sum(faults.values()), time.monotonic() - start
    typer.echo(
        f"{scene.name}: {len(stage.log):,} calls; {tried:,} of {len(planned):,} faults tried in "
        f"{seconds:.0f} s ({met}): {kinds}"
    )
    return bad


def _run() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("--cases", type=int, default=20, help="cases of a batch")
    parser.add_argument("--samples", type=int, default=20_000, help="samples of a study")
    parser.add_argument("--positions", type=int, default=5, help="positions of a study")
    parser.add_argument("--indices", type=int, default=16, help="rows for the shares of variance")
    parser.add_argument("--step", type=int, default=1, help="try every so manieth fault only")
    parser.add_argument("--once", action="store_true", help="let each call fail in one way only")
    parser.add_argument("--first", type=int, default=0, help="leave so many faults out at first")
    parser.add_argument("--only", default="", help="scenes whose name begins so")
    parser.add_argument("--seconds", type=int, help="most for each scene")
    options = parser.parse_args()
    if why_not():
        typer.echo(f"Nothing is tried: {why_not()}.")
        return 2
    study = options.samples, options.positions, options.indices
    scenes = [
        *batch_scenes(options.cases),
        *study_scenes(*study),
        *file_scenes(),
        *worker_scenes(options.cases, *study),
    ]
    bad = 0
    with TemporaryDirectory() as above:
        folder = Path(above)
        shim = Shim(folder)
        with Server(folder, shim.environment() | ENVIRONMENT) as server:
            for number, scene in enumerate(scenes):
                if scene.name.startswith(options.only):
                    own = folder / f"{number}"
                    own.mkdir()
                    bad += _tried(scene, own, server, shim, options)
    typer.echo(f"{bad} faults left something wrong")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(_run())
