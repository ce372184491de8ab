"""One flipped bit in a file that a command wrote: detected, or the data read do not change."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pyarrow import parquet
from tests.study.tolerance.test_runs import INPUTS, PATHS
from tests.support import CASES, shipped

import loadshare as ls
from loadshare.study.tolerance.folder import STUDY, WORST, Folder
from loadshare.study.tolerance.job import Job


@dataclass(frozen=True, slots=True)
class Subject:
    """A file, and its readers.

    Attributes
    ----------
    kind : str
    file : pathlib.Path
    whole : bytes
        The bytes that were written.
    notices : callable
        Reads the file; returns whether a change of it was detected.

    Notes
    -----
    `notices` raises `AssertionError` if it reads something other than what was written.
    """

    kind: str
    file: Path
    whole: bytes
    notices: Callable[[], bool]

    def flip(self, place: int) -> bool:
        """Flip one bit of the file, return whether that was detected, and restore it."""
        damaged = bytearray(self.whole)
        damaged[place // 8] ^= 1 << (place % 8)
        self.file.write_bytes(damaged)
        try:
            return self.notices()
        finally:
            self.file.write_bytes(self.whole)


def subjects(folder: Path) -> Iterator[Subject]:
    """Write files of every kind and yield them.

    Parameters
    ----------
    folder : pathlib.Path
        An empty folder.
    """
    yield from _results(folder)
    yield from _study(folder / "study")


def _results(folder: Path) -> Iterator[Subject]:
    found = ls.solve(CASES / "fgfbstts" / "limit_ring.toml", positions=[1, 2])
    for ending, write in (("json", found.to_json), ("nc", found.to_netcdf)):
        file = folder / f"result.{ending}"
        write(file)

        def notices(file: Path = file) -> bool:
            try:
                read = ls.load_result(file)
            except ls.ResultError:
                return True
            assert read == found
            assert read.stamp == found.stamp
            assert read.case.to_dict() == found.case.to_dict()
            return False

        yield Subject(f"result.{ending}", file, file.read_bytes(), notices)


def _study(out: Path) -> Iterator[Subject]:
    ls.tolerance(shipped(PATHS), INPUTS, out=out, samples=400, seed=3, engine="vectorised")
    about = json.loads((out / STUDY).read_text(encoding="utf-8"))
    job = Job(about["case"], about["text"], about["settings"])
    folder = Folder(out, job)
    part, worst = folder.all[0], folder.worst()
    assert worst is not None
    right = parquet.read_table(folder.file(part))

    def part_notices() -> bool:
        if part in folder.missing():
            return True
        assert parquet.read_table(folder.file(part)).equals(right)
        return False

    def worst_notices() -> bool:
        read = folder.worst()
        assert read in (None, worst)
        return read is None

    def study_notices() -> bool:
        file = out / STUDY
        before = file.read_bytes()
        try:
            Folder(out, job)
        except ls.LoadshareError:
            return True
        assert json.loads(file.read_text(encoding="utf-8")) == about
        return file.read_bytes() != before

    for kind, file, notices in (
        ("part", folder.file(part), part_notices),
        (WORST, out / WORST, worst_notices),
        (STUDY, out / STUDY, study_notices),
    ):
        yield Subject(kind, file, file.read_bytes(), notices)


def places(subject: Subject, count: int, seed: int) -> list[int]:
    """Draw bits of a file."""
    rng = np.random.default_rng([seed, *subject.kind.encode()])
    drawn: list[int] = rng.integers(0, 8 * len(subject.whole), count).tolist()
    return drawn
