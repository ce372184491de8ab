"""Parts solved side by side on this machine, in processes of their own.

Two threads were measured to solve 111 000 equilibria a second of the seed's study, two processes
139 000 once they run (2.4 s to start); so each worker is a process. It hears from its standard
input which part is next and ends when that closes, so that nothing is left behind when the study
itself is killed. A worker imports no script of the user's: `tolerance` can be called from any,
without a guard.
"""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from loadshare.errors import LoadshareError
from loadshare.study.tolerance.folder import Folder
from loadshare.study.tolerance.job import Job, Part

ATTEMPTS = 2
"""How often a part is tried whose worker dies."""


def solve_parts(folder: Folder, parts: Sequence[Part], workers: int) -> Iterator[Part]:
    """Solve parts in worker processes and yield each when it is written.

    Parameters
    ----------
    folder : Folder
    parts : sequence of Part
    workers : int
        Processes.

    Raises
    ------
    LoadshareError
        If a worker fails, or dies twice on a part.
    """
    waiting: queue.SimpleQueue[Part] = queue.SimpleQueue()
    done: queue.SimpleQueue[Part | BaseException] = queue.SimpleQueue()
    for part in parts:
        waiting.put(part)
    crew = [_Worker(folder, waiting, done) for _ in range(min(workers, len(parts)))]
    for worker in crew:
        worker.start()
    try:
        for _ in parts:
            found = done.get()
            if isinstance(found, BaseException):
                raise found
            yield found
    finally:
        for worker in crew:
            worker.stop()


class _Worker(threading.Thread):
    """Feeds one process with parts."""

    def __init__(
        self,
        folder: Folder,
        waiting: queue.SimpleQueue[Part],
        done: queue.SimpleQueue[Part | BaseException],
    ) -> None:
        super().__init__(daemon=True)
        self.folder, self.waiting, self.done = folder, waiting, done
        self.process: subprocess.Popen[str] | None = None
        self.stopped = False

    def run(self) -> None:
        try:
            while not self.stopped:
                part = self.waiting.get_nowait()
                self._solve(part)
                self.done.put(part)
        except queue.Empty:
            pass
        except Exception as error:  # noqa: BLE001 -- told where the parts are awaited
            self.done.put(error)
        finally:
            self._end()

    def stop(self) -> None:
        """End the process, at once where it is at work."""
        self.stopped = True
        process = self.process
        if process is not None:
            process.kill()
        self.join()

    def _solve(self, part: Part) -> None:
        for _ in range(ATTEMPTS):
            process = self.process or self._begin()
            reply = self._ask(process, f"{part.design} {part.number} {part.rows}")
            if reply is not None:
                if "error" in reply:
                    raise LoadshareError(f"part {part.number} of {part.design}: {reply['error']}")
                return
            self._end()
            if self.stopped:
                return
        raise LoadshareError(
            f"part {part.number} of {part.design}: its worker process died {ATTEMPTS} times, "
            "perhaps for want of memory. Parts that are done are kept: the same command goes on "
            "from there."
        )

    def _begin(self) -> subprocess.Popen[str]:
        # One thread of BLAS in each: its matrices are small, and its sums then always round alike.
        # A worker finds the package where this process found it.
        environment = {
            **os.environ,
            "OPENBLAS_NUM_THREADS": "1",
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        }
        self.process = subprocess.Popen(
            [sys.executable, "-m", "loadshare.study.tolerance.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
            text=True,
            encoding="utf-8",
        )
        head = json.dumps({"job": self.folder.job.to_json(), "folder": str(self.folder.path)})
        self._say(self.process, head)
        return self.process

    def _ask(self, process: subprocess.Popen[str], line: str) -> dict[str, str] | None:
        """Return the reply to a line; None from a process that died."""
        assert process.stdout is not None
        if not self._say(process, line):
            return None
        answer = process.stdout.readline()
        return dict(json.loads(answer)) if answer else None

    def _say(self, process: subprocess.Popen[str], line: str) -> bool:
        assert process.stdin is not None
        try:
            process.stdin.write(line + "\n")
            process.stdin.flush()
        except OSError:
            return False
        return True

    def _end(self) -> None:
        process, self.process = self.process, None
        if process is None:
            return
        assert process.stdin is not None
        assert process.stdout is not None
        with suppress(OSError):
            process.stdin.close()
        process.wait()
        process.stdout.close()


def solve_here(folder: Folder, parts: Sequence[Part]) -> Iterator[Part]:
    """Solve parts in this process and yield each when it is written."""
    for part in parts:
        folder.write(part, folder.job.table(part))
        yield part


def folder_of(head: str) -> Folder:
    """Return the folder that a worker is told of."""
    told = json.loads(head)
    return Folder(Path(told["folder"]), Job.from_json(told["job"]))
