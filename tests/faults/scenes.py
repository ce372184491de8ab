"""Commands that write files: the files before, the command, the differences allowed afterwards."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from tests.support import CASES

from loadshare.outside import OUTSIDE
from loadshare.settings import TOLERANCE

Prepare = Callable[[Path, Callable[[Sequence[str]], None]], None]
"""Fills a folder; its second argument runs a command."""

UNREADABLE = 1
"""Exit code of a batch with one case that cannot be read: it stops no other."""
OTHER = "1e-8"
"""A tolerance with which results differ, and so are written again."""


@dataclass(frozen=True)
class Scene:
    """A command that is run again and again.

    Attributes
    ----------
    name : str
    words : tuple of str
        Arguments, in which ``{}`` stands for the folder; cases are in ``in``, all output in
        ``out``.
    prepare : callable
    again : tuple of int
        Exit codes, besides 2, with which an error may be reported.
    apart : bool
        Whether its workers are separate processes.
    """

    name: str
    words: tuple[str, ...]
    prepare: Prepare
    again: tuple[int, ...] = ()
    apart: bool = False


SUMMARY = "summary.json"
MINUTE = re.compile(rb"\d{4}-\d\d-\d\d \d\d:\d\d UTC")


def masked(name: str, content: bytes) -> bytes:
    """Return the part of a file that must be the same in every run.

    A batch's summary states the time of each case and whether its result was kept; a page states
    the time of its creation.
    """
    if name.endswith(".html"):
        return MINUTE.sub(b"", content)
    if Path(name).name != SUMMARY:
        return content
    document = json.loads(content)
    del document["counts"]
    for case in document["cases"]:
        del case["seconds"], case["outcome"]
    return json.dumps(document).encode()


def batch_scenes(count: int) -> list[Scene]:
    """Return batches of some cases: into no folder, over other results, and over half of them."""

    def cases(folder: Path) -> None:
        write_cases(folder / "in", count)

    def fresh(folder: Path, run: Callable[[Sequence[str]], None]) -> None:
        cases(folder)

    def over(folder: Path, run: Callable[[Sequence[str]], None]) -> None:
        cases(folder)
        run(("batch", f"{folder}/in", "-o", f"{folder}/out", "-j", "1", "--tolerance", OTHER))

    def half(folder: Path, run: Callable[[Sequence[str]], None]) -> None:
        over(folder, run)
        run(("batch", f"{folder}/in", "-o", f"{folder}/out", "-j", "1"))
        for file in sorted((folder / "out").iterdir())[::2]:
            file.unlink()

    words = ("batch", "{}/in", "-o", "{}/out", "-j", "1")
    scenes = {"batch": fresh, "batch over others": over, "batch, half of it there": half}
    return [Scene(name, words, prepare, (UNREADABLE,)) for name, prepare in scenes.items()]


def write_cases(folder: Path, count: int) -> None:
    """Write the shipped cases except the one with teeth, and stars with other torques."""
    folder.mkdir(parents=True)
    files = [f for f in sorted(CASES.rglob("*.toml")) if f.parent.name != "pairs"]
    files = [f for f in files if "geometry" not in f.name]
    files.sort(key=lambda file: (file.parent.name == "fgfbstts", file.name != "base.toml"))
    for file in files[:count]:
        (folder / file.name).write_bytes(file.read_bytes())
    for number in range(count - len(files)):
        text = f'extends = "floating_sun_3.toml"\noperating.torque = "{400 + number} N*m"\n'
        (folder / f"torque_{number}.toml").write_text(text, encoding="utf-8")


def study_scenes(samples: int, positions: int, indices: int) -> list[Scene]:
    """Return tolerance studies: into no folder, an empty one, and one of an interrupted study."""
    case = (
        'extends = "base/tolerance.toml"\n'
        f"study.errors.samples = {samples}\nstudy.errors.indices = {indices}\n"
        f"study.errors.positions = {list(range(1, positions + 1))}\n"
    )
    words = ("tolerance", "{}/in/case.toml", "-o", "{}/out", "--workers", "1")

    def fresh(folder: Path, run: Callable[[Sequence[str]], None]) -> None:
        base = folder / "in" / "base"
        base.mkdir(parents=True)
        for name in ("base", "limit_ring", "tolerance"):
            (base / f"{name}.toml").write_bytes((CASES / "fgfbstts" / f"{name}.toml").read_bytes())
        (folder / "in" / "case.toml").write_text(case, encoding="utf-8")

    def empty(folder: Path, run: Callable[[Sequence[str]], None]) -> None:
        fresh(folder, run)
        (folder / "out").mkdir()

    def half(folder: Path, run: Callable[[Sequence[str]], None]) -> None:
        fresh(folder, run)
        run(tuple(word.format(folder) for word in words))
        (folder / "out" / "worst.json").unlink()
        # A part of the shares of variance, or of the samples if these are all there is.
        min((folder / "out").rglob("part-*.parquet")).unlink()

    scenes = {"study": fresh, "study in an empty folder": empty, "study, half of it there": half}
    return [Scene(name, words, prepare) for name, prepare in scenes.items()]


def worker_scenes(count: int, samples: int, positions: int, indices: int) -> list[Scene]:
    """Return a batch and a study that two processes solve, as large as that requires."""
    most = TOLERANCE.small // positions // 16 * 16 + 16
    batch = batch_scenes(count)[0]
    study = study_scenes(max(samples, most), positions, indices)[0]
    return [
        replace(scene, name=f"{scene.name} in workers", words=(*scene.words[:-1], "2"), apart=True)
        for scene in (batch, study)
    ]


FLOAT = "rings.4.float=0 um:12 um:3"
FILES: dict[str, tuple[str, ...]] = {
    "result.json": ("run", "{}/in/case.toml", "--position", "1", "-o", "{}/out/result.json"),
    "result.nc": ("run", "{}/in/case.toml", "--position", "1", "-o", "{}/out/result.nc"),
    "result.csv": ("run", "{}/in/case.toml", "--position", "1", "-o", "{}/out/result.csv"),
    "gears.csv": ("run", "{}/in/case.toml", "--position", "1", "-o", "{}/out/"),
    "refused.json": ("run", "{}/in/unheld.toml", "-o", "{}/out/refused.json"),
    "sweep.csv": (
        *("sweep", "{}/in/case.toml", "--position", "1", "--over", FLOAT),
        *("-o", "{}/out/sweep.csv"),
    ),
    "sweep.nc": (
        *("sweep", "{}/in/case.toml", "--position", "1", "--over", FLOAT),
        *("-o", "{}/out/sweep.nc"),
    ),
    "drawing.svg": ("draw", "{}/in/case.toml", "-o", "{}/out/drawing.svg"),
    "page.html": ("report", "{}/in/star.toml", "-o", "{}/out/page.html"),
    "schema.json": ("schema", "-o", "{}/out/schema.json"),
    "case.toml": ("new", "fresh", "-o", "{}/out/case.toml", "--force"),
}
"""Commands that write one file; tables are several files, one after the other."""
OLD = b"what was there before\n"


def file_scenes() -> list[Scene]:
    """Return commands that write one file: into no folder, and over another file."""

    def fresh(folder: Path, run: Callable[[Sequence[str]], None]) -> None:
        cases = folder / "in"
        cases.mkdir(parents=True)
        for name in ("base", "limit_ring"):
            text = (CASES / "fgfbstts" / f"{name}.toml").read_bytes()
            (cases / f"{name}.toml").write_bytes(text)
        (cases / "case.toml").write_text('extends = "limit_ring.toml"\n', encoding="utf-8")
        star = (CASES / "star" / "floating_sun_3.toml").read_bytes()
        (cases / "star.toml").write_bytes(star)
        (cases / "unheld.toml").write_text(UNHELD, encoding="utf-8")

    scenes = []
    for name, words in FILES.items():

        def over(
            folder: Path, run: Callable[[Sequence[str]], None], file: str = f"out/{name}"
        ) -> None:
            fresh(folder, run)
            (folder / "out").mkdir()
            (folder / file).write_bytes(OLD)
            (folder / file).chmod(0o640)

        scenes.append(Scene(name, words, fresh))
        scenes.append(Scene(f"{name} over another", words, over))
    return scenes


UNHELD = """extends = "star.toml"
remove = ['meshes."sun-planet3"', 'meshes."planet3-ring"', "gears.planet3", "stages"]
"""
"""Nothing holds the sun across the line of its planets, so the case is refused."""
ENVIRONMENT = {OUTSIDE: ""}
