"""One kill: a command is started, one of its processes is killed, and the command is run again."""

from __future__ import annotations

import json
import os
import secrets
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from tests.kills.cluster import Cluster, await_workers

CASES = Path(__file__).parents[2] / "cases"
PATHS = ("star", "two_path", "branches", "fgfbstts/base.toml", "fgfbstts/load.toml")
STUDY = """
extends = "clocking_error.toml"

[study.scatter]
kind = "tolerance"
samples = 32768
indices = 64
seed = 3
limit = 1.1
quantiles = [0.5]

[study.scatter.inputs.'shafts."wheelA-pinionA".clocking']
distribution = "normal"
mean = "0 mrad"
deviation = "1 mrad"

[study.scatter.inputs.'shafts."wheelB-pinionB".clocking']
distribution = "normal"
mean = "0 mrad"
deviation = "1 mrad"
"""
KINDS = ("batch", "local", "cluster")
TARGETS = ("parent", "group", "worker")
GONE = 5.0
"""Seconds after which nothing may be left of a killed command."""
LIMIT = 600.0
"""Seconds after which a command counts as hanging."""
MARK = "LOADSHARE_KILLS"
"""Environment variable that marks all processes of a command."""
DIED = (0, 143, -signal.SIGTERM, -signal.SIGKILL)
"""Exit codes that a killed command may have."""


@dataclass(frozen=True)
class Trial:
    """The result of one kill.

    Attributes
    ----------
    number : int
    kind, target : str
        One of `KINDS` and one of `TARGETS`.
    met : bool
        Whether the process to be killed existed.
    after : float
        Seconds from the start of the command to the kill.
    gone : float
        Seconds until no killed process was left.
    orphans : tuple of str
        Processes that were left after `GONE`.
    faults : tuple of str
        Other faults, including differences.
    """

    number: int
    kind: str
    target: str
    met: bool
    after: float
    gone: float
    orphans: tuple[str, ...]
    faults: tuple[str, ...]


@dataclass(frozen=True)
class Bench:
    """The commands on which kills are tried.

    Attributes
    ----------
    folder : Path
        Contains ``study.toml``, and the output of undisturbed commands.
    cluster : Cluster or None
        Cluster that solves the kind of that name.
    seconds : dict
        Duration of an undisturbed command, by kind.
    outputs : dict
        Its printed output, by kind.
    """

    folder: Path
    cluster: Cluster | None
    seconds: dict[str, float]
    outputs: dict[str, str]

    @classmethod
    def of(cls, folder: Path, kinds: tuple[str, ...], cluster: Cluster | None = None) -> Bench:
        """Run each command once, undisturbed."""
        shutil.copy(CASES / "two_path" / "clocking_error.toml", folder)
        (folder / "study.toml").write_text(STUDY, encoding="utf-8")
        bench = cls(folder, cluster, {}, {})
        for kind in kinds:
            start = time.monotonic()
            with _running(bench.words(kind, folder / kind)) as (process, _):
                out, err = process.communicate(timeout=LIMIT)
            if process.returncode != 0:
                raise RuntimeError(f"{kind}, undisturbed: {err}")
            bench.seconds[kind] = time.monotonic() - start
            bench.outputs[kind] = out
        return bench

    def output(self, kind: str, out: Path) -> str:
        """Return the printed output of an undisturbed command of a kind that writes to a folder."""
        return self.outputs[kind].replace(str(self.folder / kind), str(out))

    def words(self, kind: str, out: Path) -> list[str]:
        """Return the command of a kind that writes to a folder."""
        if kind == "batch":
            return ["batch", *(str(CASES / path) for path in PATHS), "-j", "2", "-o", str(out)]
        words = ["tolerance", str(self.folder / "study.toml"), "--no-worst", "-o", str(out)]
        if kind != "cluster":
            return words
        assert self.cluster is not None
        return [*words, "--scheduler", self.cluster.address]


def trial(bench: Bench, seed: int, number: int, kinds: tuple[str, ...] = KINDS) -> Trial:
    """Kill one process at one time; seed and number determine both.

    Parameters
    ----------
    bench : Bench
    seed, number : int
    kinds : tuple of str
        Kinds; kind and target are taken in turn.
    """
    random = np.random.default_rng([seed, number])
    kind = kinds[number % len(kinds)]
    target = TARGETS[number // len(kinds) % len(TARGETS)]
    after = float(random.uniform(0.0, 0.95)) * bench.seconds[kind]
    out = bench.folder / f"{kind}-{number}"
    if kind == "cluster" and bench.cluster is not None:
        # A worker that was killed before is back after some seconds.
        await_workers(bench.cluster.address, len(bench.cluster.workers))
    faults: list[str] = []
    with _running(bench.words(kind, out)) as (process, mark):
        with suppress(subprocess.TimeoutExpired):
            process.wait(after)
        workers = partial(_crew, process.pid, bench.cluster if kind == "cluster" else None)
        met, victim = _kill(process, target, workers, random)
        if target == "worker":
            # When a worker dies, the command must continue and give the complete result.
            victims = [victim] if victim is not None else []
            gone, orphans = _left(lambda: [one for one in victims if _alive(one)])
            faults += _ended(process, (0,))
        else:
            gone, orphans = _left(lambda: _marked(mark))
            faults += _ended(process, DIED)
        faults += [f"left at the end: {one}" for one in _left(lambda: _marked(mark))[1]]
    with _running(bench.words(kind, out)) as (process, mark):
        # A batch prints the time of each case, so its output differs.
        faults += _ended(process, (0,), None if kind == "batch" else bench.output(kind, out))
        faults += [f"left after the second: {one}" for one in _left(lambda: _marked(mark))[1]]
    faults += differences(kind, bench.folder / kind, out)
    if not faults:
        shutil.rmtree(out)
    return Trial(number, kind, target, met, after, gone, orphans, tuple(faults))


def differences(kind: str, undisturbed: Path, out: Path) -> list[str]:
    """Return the differences between two folders, byte by byte.

    Only the summary of a batch may differ: it states the time of each case, and which were kept.
    """
    files = {file.relative_to(undisturbed) for file in undisturbed.rglob("*") if file.is_file()}
    found = {file.relative_to(out) for file in out.rglob("*") if file.is_file()}
    differing = [f"{kind}: {file} is there in one only" for file in sorted(files ^ found)]
    for file in sorted(files & found):
        one, other = (folder / file for folder in (undisturbed, out))
        if kind == "batch" and file.name == "summary.json":
            same = _summary(one) == _summary(other)
        else:
            same = one.read_bytes() == other.read_bytes()
        if not same:
            differing.append(f"{kind}: {file} differs")
    return differing


def _summary(file: Path) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    del content["counts"]
    for case in content["cases"]:
        del case["seconds"]
        case["outcome"] = {"kept": "certified"}.get(case["outcome"], case["outcome"])
    return content


@contextmanager
def _running(words: list[str]) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run a command in a session of its own; none of its processes outlives the block."""
    mark = secrets.token_hex(8)
    variables = os.environ | {
        "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        "PYTHONUTF8": "1",
        "COLUMNS": "200",
        MARK: mark,
    }
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.kills.launch", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        env=variables,
        start_new_session=True,
    )
    try:
        yield process, mark
    finally:
        for left in _marked(mark):
            with suppress(psutil.NoSuchProcess):
                left.kill()
        process.communicate()


def _kill(
    process: subprocess.Popen[str],
    target: str,
    workers: Callable[[], list[psutil.Process]],
    random: np.random.Generator,
) -> tuple[bool, psutil.Process | None]:
    """Kill the target; return whether it existed, and which worker it was."""
    if target == "worker":
        while process.poll() is None:
            if found := workers():
                victim = found[int(random.integers(len(found)))]
                with suppress(psutil.NoSuchProcess):
                    victim.kill()
                    return True, victim
            time.sleep(0.01)
        return False, None
    if process.poll() is not None:
        return False, None
    if target == "parent":
        process.send_signal(signal.SIGKILL)
    else:
        os.killpg(process.pid, signal.SIGTERM)
    return True, None


def _crew(parent: int, cluster: Cluster | None) -> list[psutil.Process]:
    """Return the workers of a command, or those of the cluster that works for it."""
    parents = [parent] if cluster is None else [one.pid for one in cluster.workers]
    word = "popen_loky" if cluster is None else "spawn_main"
    every = [child for one in parents for child in _children(one)]
    return [child for child in every if word in " ".join(_words(child))]


def _children(parent: int) -> list[psutil.Process]:
    try:
        return list(psutil.Process(parent).children(recursive=True))
    except psutil.NoSuchProcess:
        return []


def _words(process: psutil.Process) -> list[str]:
    try:
        return list(process.cmdline())
    except psutil.Error:
        return []


def _alive(process: psutil.Process) -> bool:
    try:
        return bool(process.is_running() and process.status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False


def _marked(mark: str) -> list[psutil.Process]:
    """Return the processes of a command that are alive, including itself."""
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            if process.environ().get(MARK) == mark and _alive(process):
                found.append(process)
    return found


def _left(alive: Callable[[], list[psutil.Process]]) -> tuple[float, tuple[str, ...]]:
    """Wait until nothing is alive; return how long that took, and what is left after `GONE`."""
    start = time.monotonic()
    while True:
        left = alive()
        seconds = time.monotonic() - start
        if not left or seconds > GONE:
            return seconds, tuple(f"{one.pid} {' '.join(_words(one))}" for one in left)
        time.sleep(0.02)


def _ended(
    process: subprocess.Popen[str], codes: tuple[int, ...], expected: str | None = None
) -> list[str]:
    """Return what is wrong with the end of a command."""
    try:
        out, err = process.communicate(timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return ["hangs"]
    wrong = [] if process.returncode in codes else [f"code {process.returncode}: {err[-500:]}"]
    if "Traceback" in err:
        wrong.append(err[-2000:])
    if expected is not None and out != expected:
        wrong.append(f"says something else:\n{out}")
    return wrong
