"""Try unintended inputs: ``python -m tests.fuzz --count 100000 --processes 2``.

Prints what must not happen, once of each kind, and keeps the input in `corpus`, where the tests try
it again; leaves with 1 if anything did.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import typer
from tests.fuzz.corpus import keep
from tests.fuzz.trial import Trial, compile_first, drawn, trial

MEMORY = 2 << 30
"""Bytes of memory that an input may take beyond those of the process."""


def _alone(seed: int, number: int) -> Trial:
    most = _data() + MEMORY
    resource.setrlimit(resource.RLIMIT_DATA, (most, resource.RLIM_INFINITY))
    with _empty() as folder:
        return trial(seed, number, folder)


def _data() -> int:
    """Return the bytes of data of this process; 0 if the system does not report them."""
    with suppress(OSError), Path("/proc/self/status").open(encoding="ascii") as lines:
        return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmData"))
    return 0


@contextmanager
def _empty() -> Iterator[Path]:
    """Make a folder inside a temporary one, because an input may refer to the parent folder."""
    with TemporaryDirectory() as above:
        folder = Path(above) / "in"
        folder.mkdir()
        yield folder


def _kept(seed: int, number: int) -> Path:
    """Draw an input again and keep it."""
    with _empty() as folder:
        kind, words = drawn(seed, number, folder)
        return keep(f"{kind}-{seed}-{number}", kind, words, folder)


def _run() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    with ProcessPoolExecutor(1) as pool:
        # In a process of its own, because the memory of the compiler would count as an input's.
        pool.submit(compile_first).result()
    start, reported, faults, codes = time.monotonic(), time.monotonic(), 0, Counter[str]()
    seen: set[str] = set()
    with ProcessPoolExecutor(options.processes) as pool:
        numbers = range(options.first, options.first + options.count)
        every = pool.map(partial(_alone, options.seed), numbers, chunksize=20)
        for done, found in enumerate(every, 1):
            codes[f"{found.kind} {found.code}"] += 1
            if found.fault:
                faults += 1
                if found.fault not in seen:
                    seen.add(found.fault)
                    kept = _kept(found.seed, found.number)
                    typer.echo(f"{found.fault}\n    {' '.join(found.words)[:200]}\n    {kept}")
            if time.monotonic() - reported > 10.0:
                reported = time.monotonic()
                typer.echo(f"{done:,} tried, {faults} faults, {reported - start:.0f} s")
    typer.echo(f"{options.count:,} tried in {time.monotonic() - start:.0f} s: {faults} faults")
    typer.echo(", ".join(f"{kind}: {count}" for kind, count in sorted(codes.items())))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(_run())
