"""The tutorial and the page on gearboxes, followed literally from a fresh installation.

Every command is typed as printed, in an empty home and an empty folder; its output must be what the
page shows. Needs a package index.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
KEPT = ("PATH", "LANG", "LC_ALL", "TZ", "OPENBLAS_NUM_THREADS")
"""Environment variables that a new user has as well."""

spec = importlib.util.spec_from_file_location("blocks", ROOT / "tests/docs/blocks.py")
blocks = sys.modules.setdefault("blocks", importlib.util.module_from_spec(spec))
spec.loader.exec_module(blocks)


def _pip(python: Path | str, *words: object) -> None:
    done = subprocess.run(
        [str(python), "-m", "pip", *map(str, words)], capture_output=True, text=True, check=False
    )
    if done.returncode and "find a version" in done.stderr + done.stdout:
        pytest.skip("no package index")
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """Return the folder of commands of a new environment with the wheel."""
    place = tmp_path_factory.mktemp("fresh")
    _pip(sys.executable, "wheel", "--quiet", "--no-deps", "--wheel-dir", place, ROOT)
    (wheel,) = place.glob("loadshare-*.whl")
    venv.create(place / "env", with_pip=True)
    commands = place / "env" / ("Scripts" if sys.platform == "win32" else "bin")
    _pip(commands / "python", "install", "--quiet", "-c", ROOT / "constraints.txt", wheel)
    return commands


@pytest.fixture
def newcomer(installed, tmp_path, monkeypatch) -> Path:
    """Set a new user's environment: an empty home, and an empty folder to work in."""
    path = f"{installed}{os.pathsep}{os.environ['PATH']}"
    for name in list(os.environ):
        if name not in KEPT:
            monkeypatch.delenv(name)
    (tmp_path / "home").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("PATH", path)
    monkeypatch.setenv("COLUMNS", "90")
    monkeypatch.setenv("PYTHONUTF8", "1")
    work = tmp_path / "work"
    work.mkdir()
    monkeypatch.chdir(work)
    return installed


def _printed(python: Path, earlier: list[str], block: str) -> str:
    """Return what a Python block prints after those before it, in one new process."""
    before = "\n".join(earlier)
    code = (
        "import contextlib, io\n"
        "names = {'__name__': '__main__'}\n"
        "with contextlib.redirect_stdout(io.StringIO()):\n"
        f"    exec({before!r}, names)\n"
        f"exec({block!r}, names)\n"
    )
    done = subprocess.run([python, "-c", code], capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("page", ["docs/tutorial.md", "docs/gearbox.md"])
def test_a_page_from_a_fresh_installation(newcomer, page):
    """Both pages promise to need nothing but the package."""
    text = (ROOT / page).read_text(encoding="utf-8")
    python, earlier, printed, shown = newcomer / "python", [], None, 0
    for block in blocks.blocks_of(text):
        if block.language == "python":
            printed = _printed(python, earlier, block.text)
            earlier.append(block.text)
            continue
        if block.language == "console":
            real = blocks.run_console(block.text)
        elif block.language == "text" and printed is not None:
            real = printed
        else:
            continue
        printed = None
        assert blocks.differences(block.text, real) == [], block.text.splitlines()[0]
        shown += 1
    assert shown >= 6


@pytest.mark.slow
def test_shipped_cases_come_with_a_fresh_installation(newcomer):
    code = (
        "import loadshare as ls\n"
        "print(len(ls.examples()) > 20, 'solve' in dir(ls))\n"
        "print(ls.solve(ls.examples('star/floating_sun_4')))\n"
    )
    words = [newcomer / "python", "-c", code]
    done = subprocess.run(words, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("True True\nResult of floating_sun_4: 1 of 1 positions certified")
