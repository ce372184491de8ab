"""A sample of faults; ``python -m tests.faults`` tries all of them."""

import os
from collections import Counter
from datetime import UTC, datetime

import pytest
from tests.faults.scenes import ENVIRONMENT, batch_scenes, file_scenes, masked, study_scenes
from tests.faults.server import Server
from tests.faults.shim import FAULTS, Shim, why_not
from tests.faults.trial import Stage

from loadshare.report.page.report import report_page

pytestmark = pytest.mark.skipif(bool(why_not()), reason=why_not())
SMALL = {scene.name: scene for scene in (*batch_scenes(2), *study_scenes(64, 1, 0), *file_scenes())}
TRIED = 6
"""Number of faults of a scene in `make test`."""
QUICK = ("batch over others", "sweep.csv", "refused.json")


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """Yield the library that makes calls fail, and the server that runs commands."""
    folder = tmp_path_factory.mktemp("faults")
    shim = Shim(folder)
    with Server(folder, shim.environment() | ENVIRONMENT) as server:
        yield server, shim


@pytest.mark.parametrize("name", QUICK)
@pytest.mark.quick(2)
def test_some_faults_leave_nothing_wrong(served, tmp_path, name):
    stage = Stage(SMALL[name], tmp_path, *served)
    planned = stage.plan()
    found = [stage.trial(*one) for one in planned[:: -(-len(planned) // TRIED)]]
    assert [str(one) for one in found if one.wrong] == []
    assert sum(one.seen.hit > 0 for one in found) > len(found) // 2


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SMALL if not name.startswith("study")])
def test_no_fault_leaves_anything_wrong(served, tmp_path, name):
    stage = Stage(SMALL[name], tmp_path, *served)
    assert [str(one) for k, f in stage.plan() if (one := stage.trial(k, f)).wrong] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in SMALL if name.startswith("study")])
def test_no_fault_leaves_anything_wrong_in_a_study(served, tmp_path, name):
    """Most of its thousands of calls read columns and are alike; only some are tried."""
    stage = Stage(SMALL[name], tmp_path, *served)
    assert [str(one) for k, f in stage.plan(5) if (one := stage.trial(k, f)).wrong] == []


def test_pages_are_compared_but_for_the_minute():
    """This fails if the wording of the time on pages changes."""
    pages = [
        report_page([], datetime(2026, 1, 2, 3, minute, tzinfo=UTC)).encode() for minute in (4, 5)
    ]
    assert pages[0] != pages[1]
    assert masked("page.html", pages[0]) == masked("page.html", pages[1])


def test_every_call_is_seen_and_every_fault_met(served, tmp_path):
    """For one file that is written: each step by its name, and a kill at each."""
    stage = Stage(SMALL["result.json over another"], tmp_path, *served)
    names = Counter(name for name, path in stage.log if "result.json" in path)
    for step in ("write", "fsync", "rename", "chmod"):
        assert names[step] == 1
    writing = [k + 1 for k, (name, _) in enumerate(stage.log) if name == "write"]
    for fault in FAULTS:
        found = stage.trial(writing[0], fault)
        assert found.seen.hit
        assert found.seen.name == "write"
        assert found.code == {"kill": -9, "short": 0, "EINTR": 0}.get(fault, 2)
        assert found.wrong == ()


def test_all_is_on_the_disk_before_it_has_its_name(served, tmp_path):
    """No write follows the fsync of the file, and the folder is synced after the rename."""
    stage = Stage(SMALL["result.nc"], tmp_path, *served)
    (temporary,) = {path for name, path in stage.log if name == "write" and "result.nc" in path}
    events = [name for name, path in stage.log if path == temporary]
    last = len(events) - 1 - events[::-1].index("fsync")
    assert not {"write", "pwrite64", "ftruncate64"} & set(events[last:])
    moved = [name for name, _ in stage.log].index("rename")
    folder = os.path.dirname(temporary)  # noqa: PTH120 -- of a text
    assert ("fsync", folder) in stage.log[moved:]
    # A new folder's name is in its parent, which must be synced too.
    made = stage.log.index(("mkdir", folder))
    assert ("fsync", os.path.dirname(folder)) in stage.log[made:moved]  # noqa: PTH120


def test_the_harness_finds_what_must_not_be(tmp_path):
    """A check that cannot fail would prove nothing: this library overwrites files in place."""
    shim, stage = Shim(tmp_path), tmp_path / "stage"
    stage.mkdir()
    with Server(tmp_path, shim.environment() | ENVIRONMENT, "tests.faults.broken") as server:
        made = Stage(SMALL["result.json over another"], stage, server, shim)
        number = [name for name, _ in made.log].index("write") + 1
        found = {fault: made.trial(number, fault) for fault in ("kill", "EIO", "short")}
    for fault in ("kill", "EIO"):
        assert {one.kind for one in found[fault].wrong} == {"corrupt"}
    assert found["short"].wrong == ()
