"""Samples that are not kept: deleted after SIGTERM, and after SIGKILL by the next study."""

import os
import signal
import subprocess
import sys
import tempfile
import time

import pytest
from tests.cli.conftest import plain_environment
from tests.support import CASES

import loadshare as ls
from loadshare.lock import LOCK, alone_in
from loadshare.study.tolerance.temporary import INSIDE, NEW, PREFIX, TemporaryFolder, remove_left

STUDY = """extends = '{ring}'
[study.scatter]
kind = "tolerance"
samples = {samples}
indices = 0
[study.scatter.inputs]
"rings.4.float" = {{ distribution = "uniform", low = "2 um", high = "12 um" }}
"""


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def made(place, name: str, *held: str, age: float = 2.0 * NEW):
    """Make a folder with a lock that nobody holds, and other files."""
    folder = place / name
    folder.mkdir()
    (folder / LOCK).touch()
    for file in held:
        (folder / file).mkdir()
        (folder / file / "part-000000.parquet").touch()
    then = time.time() - age
    os.utime(folder / LOCK, (then, then))
    return folder


def test_it_is_there_as_long_as_the_answer(place):
    floats = {"rings.*.float": {"distribution": "uniform", "low": "0 um", "high": "12 um"}}
    case = CASES / "fgfbstts" / "limit_ring.toml"
    options = {"samples": 16, "indices": 0, "positions": [1], "worst": False}
    found = ls.tolerance(case, floats, **options)
    (folder,) = place.iterdir()
    remove_left(place)
    assert (folder / INSIDE / "study.json").is_file()
    assert found.to_frame().shape[0] == 16
    del found
    assert list(place.iterdir()) == []


def test_what_killed_processes_left_is_removed_and_nothing_else(place):
    gone = made(place, f"{PREFIX}killed", INSIDE)
    kept = [
        made(place, f"{PREFIX}new", INSIDE, age=0.0),
        made(place, f"{PREFIX}own", INSIDE, "results"),
        made(place, "loadshare-results", INSIDE),
        made(place, f"{PREFIX}held", INSIDE),
    ]
    (place / f"{PREFIX}link").symlink_to(gone)
    elsewhere = place / "elsewhere"
    elsewhere.mkdir()
    linked = made(place, f"{PREFIX}linked")
    (linked / INSIDE).symlink_to(elsewhere)
    with alone_in(kept[-1]):
        then = time.time() - 2.0 * NEW
        os.utime(kept[-1] / LOCK, (then, then))
        TemporaryFolder().remove()
        assert not gone.exists()
        assert all((folder / INSIDE).is_dir() for folder in kept)
        assert (linked / INSIDE).is_symlink()
        assert elsewhere.is_dir()


@pytest.mark.skipif(os.name != "posix", reason="no such signals on this system")
@pytest.mark.parametrize(
    "words", [("study", "{}", "scatter"), pytest.param(("tolerance", "{}"), marks=pytest.mark.slow)]
)
def test_sigterm_leaves_nothing(tmp_path, words):
    case = tmp_path / "case.toml"
    ring = (CASES / "fgfbstts" / "limit_ring.toml").as_posix()
    case.write_text(STUDY.format(ring=ring, samples=4_000_000), encoding="utf-8")
    place = tmp_path / "temporary"
    place.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "loadshare", *(word.format(case) for word in words)],
        env=plain_environment(TMPDIR=str(place)),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    end = time.monotonic() + 120.0
    while not any(place.glob(f"{PREFIX}*/{INSIDE}/study.json")) and time.monotonic() < end:
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=120.0)
    assert process.returncode == 143, err
    assert "Interrupted" in err
    assert "othing is kept" in err
    assert "Traceback" not in err
    assert list(place.glob(f"{PREFIX}*")) == []
