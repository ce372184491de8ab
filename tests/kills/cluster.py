"""A Dask cluster on this computer, as in the documentation: a scheduler and two workers."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

LIMIT = 120.0
"""Time limit for a process to start [s]."""


@dataclass(frozen=True)
class Cluster:
    """A scheduler and workers.

    Attributes
    ----------
    address : str
        Address of the scheduler.
    scheduler : subprocess.Popen
    workers : list of subprocess.Popen
        Each restarts its worker when that dies, unless it was told not to.
    """

    address: str
    scheduler: subprocess.Popen[bytes]
    workers: list[subprocess.Popen[bytes]]


@contextmanager
def cluster(
    folder: Path, workers: int, *more: str, variables: dict[str, str] | None = None
) -> Iterator[Cluster]:
    """Start a cluster that ends with the block.

    Parameters
    ----------
    folder : Path
        Folder for logs.
    workers : int
        Number of processes ``dask worker``.
    *more : str
        Further arguments for each.
    variables : dict, optional
        Environment variables of the workers.
    """
    known = folder / "scheduler.json"
    own = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    own |= {"OPENBLAS_NUM_THREADS": "1"}
    started: list[subprocess.Popen[bytes]] = []

    def start(*words: str, **changed: str) -> subprocess.Popen[bytes]:
        with (folder / f"log-{len(started)}.txt").open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "dask", *words],
                env=own | changed,
                stdout=log,
                stderr=log,
                cwd=folder,
                start_new_session=True,
            )
        started.append(process)
        return process

    try:
        scheduler = start(
            *("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"),
            *("--scheduler-file", str(known)),
        )
        address = _address(known)
        workers = [
            start(
                "worker", address, "--nthreads", "1", "--no-dashboard", *more, **(variables or {})
            )
            for _ in range(workers)
        ]
        yield Cluster(address, scheduler, workers)
    finally:
        for process in reversed(started):
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def _address(file: Path) -> str:
    """Return the address that a scheduler writes to a file, once the file is complete."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        with suppress(OSError, ValueError, KeyError):
            return str(json.loads(file.read_text(encoding="utf-8"))["address"])
        time.sleep(0.01)
    raise TimeoutError(f"{file}: no scheduler")


def await_workers(address: str, count: int) -> None:
    """Wait until workers are connected."""
    from distributed import Client

    with Client(address, timeout=LIMIT) as client:
        client.wait_for_workers(count, timeout=LIMIT)
