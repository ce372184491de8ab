"""Parts solved on a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any

from loadshare.errors import LoadshareError
from loadshare.settings import TOLERANCE
from loadshare.study.tolerance.folder import Folder
from loadshare.study.tolerance.job import Part, known_job

if TYPE_CHECKING:
    import pyarrow as pa

WAIT = "30s"
"""How long an answer of the scheduler is awaited."""


def part_table(job: str, part: Part) -> pa.Table:
    """Solve a part on a worker, which needs nothing but the package."""
    return known_job(job).table(part)


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
        If `distributed` is not installed, the scheduler cannot be reached, or a part fails.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise LoadshareError(
            "a cluster needs the package distributed: pip install 'loadshare[cluster]'"
        ) from None
    try:
        client = Client(address, timeout=WAIT)
    except (OSError, ValueError) as error:
        raise LoadshareError(f"scheduler {address}: cannot be reached: {error}") from None
    with client:
        # Sent with every part: what is scattered would be lost with the worker that holds it.
        job = folder.job.to_json()
        queue = iter(parts)
        threads = sum(client.nthreads().values())

        def send(part: Part) -> Any:
            return client.submit(part_table, job, part, pure=False)

        waiting = {send(part): part for part in islice(queue, TOLERANCE.ahead * max(threads, 1))}
        found = as_completed(list(waiting))
        for future in found:
            part = waiting.pop(future)
            try:
                table = future.result()
            except Exception as error:
                raise LoadshareError(
                    f"part {part.number} of {part.design} failed on the cluster: "
                    f"{type(error).__name__}: {error}"
                ) from error
            future.release()
            folder.write(part, table)
            for following in islice(queue, 1):
                sent = send(following)
                waiting[sent] = following
                found.add(sent)
            yield part
