"""One fault: a command whose k-th call fails, the files that remain, and the command again."""

from __future__ import annotations

import json
import random
import re
import shutil
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.faults.scenes import OLD, SUMMARY, Scene, masked
from tests.faults.server import Ended, Server
from tests.faults.shim import FAULTS, Seen, Shim

from loadshare.lock import LOCK

Files = dict[str, bytes]
LEFT = re.compile(r"^(.*/)?\.(.+)\.[0-9a-f]{16}$")
"""Names of temporary files that a killed process may leave until the command is run again."""
CHANGING = ("mkdir", "rename", "unlink", "fsync", "flock", "chmod", "chown")
KINDS = ("told", "lost", "corrupt", "unusable", "different", "left")
"""Kinds of fault: a wrong report of the error; files that are lost; files that are neither the old
nor the requested ones; a repeated command that fails; files that then differ from those of an
undisturbed run; and temporary files that remain."""


@dataclass(frozen=True, slots=True)
class Wrong:
    """A fault that was found.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    what : str
    """

    kind: str
    what: str


@dataclass(frozen=True, slots=True)
class Trial:
    """An injected fault and its effects.

    Attributes
    ----------
    scene : str
    number : int
        Number of the call, from 1.
    fault : str
        Key of `FAULTS`.
    seen : Seen
    code : int
        Exit code of the command whose call failed.
    wrong : tuple of Wrong
    """

    scene: str
    number: int
    fault: str
    seen: Seen
    code: int
    wrong: tuple[Wrong, ...]

    def __str__(self) -> str:
        call = f"{self.fault} in {self.seen.name} {Path(self.seen.path).name}"
        faults = "; ".join(f"{w.kind}: {w.what}" for w in self.wrong)
        return f"{self.scene}, call {self.number} ({call}), code {self.code}: {faults or 'well'}"


class Stage:
    """A scene, with the files that an undisturbed run leaves.

    Parameters
    ----------
    scene : Scene
    folder : pathlib.Path
        An empty folder.
    server : Server
    shim : Shim
    """

    def __init__(self, scene: Scene, folder: Path, server: Server, shim: Shim) -> None:
        self.scene, self.server, self.shim = scene, server, shim
        self.root, self._start = folder / "now", folder / "before"
        self.words = tuple(word.replace("{}", str(self.root)) for word in scene.words)

        def run(words: tuple[str, ...]) -> None:
            ended = server.run(words, fork=False)
            assert ended.code == 0, ended.output

        scene.prepare(self.root, run)
        self.root.rename(self._start)
        self.before = _files(self._start)
        self._set()
        # Once in the server itself, which keeps the answers, and once like all that follow.
        first = server.run(self.words, fork=False)
        self.after, self.code = _files(self.root), first.code
        self.log = self._logged(folder / "log")
        assert _files(self.root).keys() == self.after.keys()
        # The printed output when all files exist.
        self.out = server.run(self.words, fork=False).out

    def _logged(self, log: Path) -> list[tuple[str, str]]:
        """Return the calls of an undisturbed run: the name of each, and its path."""
        self._set()
        self.shim.arm(self.root, log=log)
        ended = self._given()
        self.shim.disarm()
        assert ended.code == self.code, ended.output
        lines = log.read_text(encoding="utf-8").splitlines()
        return [(name, path) for _, name, path in (line.split("\t") for line in lines)]

    def plan(self, step: int = 1, once: bool = False) -> list[tuple[int, str]]:
        """Return the calls that shall fail, each with its fault, in a fixed order.

        Calls that write meet every fault, unless each call is to fail once; calls that read meet
        one of the faults in turn. Of all these, every `step`-th is taken.
        """
        every, numbers = list(FAULTS), range(len(self.log))
        planned = [
            (k + 1, fault)
            for k in numbers
            for fault in (every if self._writes(k) and not once else [every[k % len(every)]])
        ]
        # Shuffled, so that an early stop has still tried calls and faults of all kinds.
        random.Random(1).shuffle(planned)
        return planned[::step]

    def _writes(self, k: int) -> bool:
        name, path = self.log[k]
        if LEFT.match(path) or name in CHANGING:
            return True
        # Opening and closing a folder to sync it count as writing.
        around = self.log[max(k - 1, 0) : k + 2]
        return any(n == "fsync" and p == path for n, p in around)

    def trial(self, number: int, fault: str) -> Trial:
        """Make a call fail, and run the command again."""
        self._set()
        self.shim.arm(self.root, number, fault)
        ended = self._given()
        seen = self.shim.disarm()
        wrong = [*self._reported(ended, seen, fault), *self._state(ended)]
        again = self._given()
        wrong += self._resumed(again)
        return Trial(self.scene.name, number, fault, seen, ended.code, tuple(wrong))

    def _given(self) -> Ended:
        return self.server.run(self.words, apart=self.scene.apart)

    def _set(self) -> None:
        shutil.rmtree(self.root, ignore_errors=True)
        shutil.copytree(self._start, self.root)

    def _reported(self, ended: Ended, seen: Seen, fault: str) -> Iterator[Wrong]:
        """Judge how a command with a failed call ended."""
        if "Traceback" in ended.output or "Exception ignored" in ended.output:
            yield Wrong("told", f"a traceback: {ended.err.strip().splitlines()[-1]}")
        elif ended.code == -signal.SIGKILL:
            if fault != "kill" or not seen.hit:
                yield Wrong("told", "was killed")
        elif ended.code not in (self.code, 2, *self.scene.again):
            yield Wrong("told", f"left with {ended.code}: {ended.output.strip()[-200:]}")
        elif ended.code != self.code and not self._named(ended.output, fault, Path(seen.path)):
            yield Wrong("told", f"names no file: {ended.output.strip()[-200:]}")

    def _named(self, output: str, fault: str, failed: Path) -> bool:
        """Return whether the output names the file, or one that was to be in the folder.

        If a disk stays full, the file that ends a command need not be the first that failed.
        """
        if FAULTS[fault].lasting:
            return str(self.root) in output
        match = LEFT.match(str(failed))
        if match:
            return f"{match[1]}{match[2]}" in output
        return str(failed) in output

    def _state(self, ended: Ended) -> Iterator[Wrong]:
        """Judge the files on disk after the fault."""
        now = _files(self.root)
        for name, content in now.items():
            allowed = [files[name] for files in (self.before, self.after) if name in files]
            if LEFT.match(name) or _tells(name, content) or Path(name).name == LOCK:
                continue
            if not any(_same(name, content, one) for one in allowed):
                yield Wrong("corrupt", name)
        yield from (Wrong("lost", name) for name in self.before if name not in now)
        if ended.code == self.code == 0:
            yield from (Wrong("lost", f"{n}, and not a word") for n in self.after if n not in now)
            # A summary reports a result that could not be read, and so was not kept.
            kept = [n for n in now if n in self.after and not _tells(n, now[n])]
            old = [n for n in kept if not _same(n, now[n], self.after[n])]
            yield from (Wrong("different", f"{name}, and not a word") for name in old)

    def _resumed(self, again: Ended) -> Iterator[Wrong]:
        """Judge the repeated command."""
        now = _files(self.root)
        if again.code != self.code or "Traceback" in again.output:
            yield Wrong("unusable", f"left with {again.code}: {again.output.strip()[-300:]}")
            return
        yield from (Wrong("left", name) for name in now if LEFT.match(name))
        yield from (Wrong("lost", f"{n}, also then") for n in self.after if n not in now)
        for name, content in now.items():
            if LEFT.match(name):
                continue
            if name not in self.after or not _same(name, content, self.after[name]):
                yield Wrong("different", name)
        if self.scene.words[0] == "tolerance" and again.out != self.out:
            yield Wrong("different", "what is printed")


def _files(folder: Path) -> Files:
    found = (file for file in sorted(folder.rglob("*")) if not file.is_dir())
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in found}


def _tells(name: str, content: bytes) -> bool:
    """Return whether a file is complete and reports what went wrong: a batch's summary, a page."""
    if name.endswith(".html"):
        return b"cannot be used" in content and content.rstrip().endswith(b"</html>")
    try:
        return Path(name).name == SUMMARY and "cases" in json.loads(content)
    except json.JSONDecodeError:
        return False


def _same(name: str, one: bytes, other: bytes) -> bool:
    if one == other:
        return True
    if OLD in (one, other):
        return False
    try:
        return masked(name, one) == masked(name, other)
    except json.JSONDecodeError:
        return False
