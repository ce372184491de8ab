"""Parts solved on a Dask cluster."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from itertools import islice
from typing import TYPE_CHECKING, Any

from loadshare._version import __version__
from loadshare.errors import LoadshareError
from loadshare.libraries import pa
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.folder import Folder
from loadshare.study.tolerance.job import Part, known_job

if TYPE_CHECKING:
    from distributed import Client

JOIN = 10.0
"""Seconds to wait for the scheduler, and for the first worker."""
WAIT = 30.0
"""Seconds to wait for another worker when the last one is gone."""
LOOK = 2.0
"""Seconds between two checks whether there are workers."""
SHOWN = 5
"""Number of workers that are named at most."""


def part_table(job: str, part: Part) -> pa.Table:
    """Solve a part on a worker, which needs nothing but the package.

    Raises
    ------
    LoadshareError
        If the worker, perhaps one that joined late, has another version than the one asked for.
    """
    known = known_job(job)
    if known.settings["version"] != __version__:
        there = f"loadshare {__version__} there, {known.settings['version']} here"
        raise LoadshareError(f"a worker has another version: {there}")
    return known.table(part)


def solve_on_cluster(folder: Folder, parts: Sequence[Part], address: str) -> Iterator[Part]:
    """Solve parts on a cluster, write them here, and yield each when it is written.

    A part whose worker is lost is solved by another; the scheduler sees to that.

    Parameters
    ----------
    folder : Folder
        On this machine; the workers need not reach it.
    parts : sequence of Part
    address : str
        Of the scheduler, as in ``"tcp://10.0.0.1:8786"``.

    Raises
    ------
    LoadshareError
        If `distributed` is not installed, the scheduler cannot be reached or is lost, there are no
        workers, workers have other versions than this machine, or a part fails.
    """
    try:
        from distributed import Client
    except ImportError:
        raise LoadshareError(
            "a cluster needs the package distributed: pip install 'loadshare[cluster]'"
        ) from None
    try:
        client = Client(address, timeout=JOIN)
    except (OSError, ValueError) as error:
        raise LoadshareError(f"scheduler {address}: cannot be reached: {error}") from None
    with client:
        try:
            _check_workers(client, address)
            yield from _solved(client, folder, parts, address)
        except (CancelledError, OSError) as error:
            # A file that this machine cannot write is no fault of the cluster.
            if client.status == "running":
                raise
            raise LoadshareError(
                f"scheduler {address}: the connection was lost. {folder.kept()}"
            ) from error


def _solved(client: Client, folder: Folder, parts: Sequence[Part], address: str) -> Iterator[Part]:
    # Sent with every part: scattered data would be lost with the worker that holds it.
    job = folder.job.to_json()
    queue = iter(parts)
    ahead = TOLERANCE.ahead * max(sum(client.nthreads().values()), 1)
    waiting: dict[Any, Part] = {}

    def send(count: int) -> None:
        for part in islice(queue, count):
            waiting[client.submit(part_table, job, part, pure=False)] = part

    send(ahead)
    while waiting:
        for future in _first(client, list(waiting), folder, address):
            part = waiting[future]
            try:
                table = future.result(timeout=WAIT)
            except CancelledError:
                raise
            except TimeoutError:
                # The worker was lost before its result was fetched: another solves the part.
                continue
            except Exception as error:
                raise LoadshareError(
                    f"part {part.number} of {part.design} failed on the cluster: "
                    f"{type(error).__name__}: {error}. {folder.kept()}"
                ) from error
            del waiting[future]
            future.release()
            folder.write(part, table)
            send(1)
            yield part


def _first(client: Client, futures: list[Any], folder: Folder, address: str) -> set[Any]:
    """Wait until a future is done, and return all that are."""
    from distributed import wait

    seen = time.monotonic()
    while True:
        try:
            done: set[Any] = wait(futures, timeout=LOOK, return_when="FIRST_COMPLETED").done
        except TimeoutError:
            if client.nthreads():
                seen = time.monotonic()
            elif time.monotonic() - seen > WAIT:
                raise LoadshareError(f"{_without_workers(address)} {folder.kept()}") from None
        else:
            return done


def _check_workers(client: Client, address: str) -> None:
    """Check that there are workers, with the same versions as this machine.

    Raises
    ------
    LoadshareError
        If there are none, or some have other versions; it names them.
    """
    try:
        client.wait_for_workers(1, timeout=JOIN)
    except TimeoutError:
        raise LoadshareError(_without_workers(address)) from None
    workers = client.get_versions()["workers"].items()
    pythons = {worker: _python(one["host"]["python"]) for worker, one in workers}
    apart = _apart("Python", _python(sys.version), pythons)
    # Code can be sent only to the same Python, so the package's version is queried only then.
    apart = apart or _apart("loadshare", __version__, client.run(_version(), on_error="return"))
    if apart:
        more = [f"  and {len(apart) - SHOWN} more"] if len(apart) > SHOWN else []
        raise LoadshareError(
            "\n".join(
                [
                    f"scheduler {address}: workers differ from this machine:",
                    *apart[:SHOWN],
                    *more,
                    "Nothing was sent. Install the same versions on all, and restart the workers.",
                ]
            )
        )


def _without_workers(address: str) -> str:
    return (
        f"scheduler {address}: no worker is connected. Start one with "
        f"`dask worker {address}`, on a machine where loadshare is installed."
    )


def _python(version: str) -> str:
    """Return the part of a Python version that matters: 3.12.1 can read the code of 3.12.2."""
    return ".".join(version.split(".")[:2])


def _version() -> Callable[[], str]:
    """Return a function that finds a worker's version; sent as code, as it may lack the package."""

    def version() -> str:
        from importlib import import_module

        try:
            return str(import_module("loadshare._version").__version__)
        except ImportError:
            return "is missing"

    return version


def _apart(what: str, here: str, there: Mapping[str, object]) -> list[str]:
    """Return a line for each worker that has another version."""
    return [
        f"  {worker}: {what} {v} there, {here} here" for worker, v in there.items() if v != here
    ]
