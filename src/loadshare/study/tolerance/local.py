"""Parts solved on this machine, in this process or by several others in parallel.

On the seed's study two threads were measured to solve 111 000 equilibria a second, two processes
139 000 once they run; so each worker is a process.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache, partial
from pathlib import Path

from loadshare.errors import LoadshareError
from loadshare.output import NotWritten
from loadshare.processes import side_by_side
from loadshare.study.tolerance.folder import Folder
from loadshare.study.tolerance.job import Part, known_job


def solve_parts(folder: Folder, parts: Sequence[Part], workers: int) -> Iterator[Part]:
    """Solve parts in worker processes and yield each when it is written.

    Parameters
    ----------
    folder : Folder
    parts : sequence of Part
    workers : int
        Number of processes.

    Raises
    ------
    LoadshareError
        If a part fails, or a worker dies twice on it.
    """
    solve = partial(solve_there, str(folder.path), folder.job.to_json())
    for part, failure in side_by_side(solve, parts, workers):
        if failure is None:
            raise LoadshareError(
                f"part {part.number} of {part.design}: its worker process died twice, perhaps for "
                f"lack of memory. {folder.kept()}"
            )
        if failure:
            raise LoadshareError(f"part {part.number} of {part.design}: {failure}. {folder.kept()}")
        yield part


def solve_there(path: str, job: str, part: Part) -> str:
    """Solve a part in a worker process; return why it failed, or an empty text."""
    try:
        folder = _folder(path, job)
        folder.write(part, folder.job.table(part))
    except NotWritten as error:
        return f"{error.filename} cannot be written: {error.strerror}"
    except Exception as error:  # noqa: BLE001 -- reported by the study; not everything can be pickled
        return f"{type(error).__name__}: {error}"
    return ""


@lru_cache(maxsize=1)
def _folder(path: str, job: str) -> Folder:
    return Folder(Path(path), known_job(job))


def solve_here(folder: Folder, parts: Sequence[Part]) -> Iterator[Part]:
    """Solve parts in this process and yield each when it is written."""
    for part in parts:
        folder.write(part, folder.job.table(part))
        yield part
