"""Studies on a Dask cluster, with its own commands: what is lost, reported and kept."""

import os
import re
import shlex
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from tests.kills.cluster import await_workers, cluster
from tests.study.tolerance.test_runs import bits, environment, run

import loadshare as ls
from loadshare._version import __version__
from loadshare.study.tolerance import cluster as room
from loadshare.study.tolerance.job import Job, Part

pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings(
    "ignore::DeprecationWarning:distributed", "ignore::ResourceWarning"
)
ROOT = Path(__file__).parents[3]
NOBODY = "tcp://127.0.0.1:9"


@pytest.fixture(scope="module")
def reference(tmp_path_factory) -> Path:
    """Run in this process, one block at a time."""
    out = tmp_path_factory.mktemp("reference") / "study"
    run(out, chunk=1)
    return out


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_gives_the_same_bits(reference, tmp_path):
    out = tmp_path / "study"
    with cluster(tmp_path, 2, "--no-nanny") as started:
        await_workers(started.address, 2)
        lost = []

        def kill_one(done: int, _: int) -> None:
            if done and not lost:
                started.workers[0].send_signal(signal.SIGKILL)
                lost.append(done)

        run(out, scheduler=started.address, chunk=1, progress=kill_one)
        assert lost == [4096]
        assert started.workers[0].wait() == -signal.SIGKILL
        assert started.workers[1].poll() is None
    assert bits(out) == bits(reference)


@pytest.mark.slow
def test_a_cluster_that_is_lost_leaves_what_is_done(reference, tmp_path):
    """First the scheduler is lost, then, on another cluster, all workers are."""
    out = tmp_path / "study"
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    with cluster(tmp_path / "one", 2) as started:
        await_workers(started.address, 2)

        def kill_scheduler(done: int, _: int) -> None:
            if done == 4096:
                started.scheduler.send_signal(signal.SIGKILL)
                started.scheduler.wait()

        with pytest.raises(ls.LoadshareError, match=r"the connection was lost. \d of 5 parts"):
            run(out, scheduler=started.address, chunk=1, progress=kill_scheduler)
    kept = {file: file.stat().st_mtime_ns for file in out.glob("part-*.parquet")}
    assert 1 <= len(kept) < 5
    with cluster(tmp_path / "two", 1, "--no-nanny") as started:
        await_workers(started.address, 1)

        def kill_worker(done: int, _: int) -> None:
            if done == 4096 * (len(kept) + 1):
                started.workers[0].send_signal(signal.SIGKILL)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(room, "WAIT", 0.2)
            patch.setattr(room, "LOOK", 0.1)
            with pytest.raises(ls.LoadshareError, match=r"no worker is connected. .* of 5 parts"):
                run(out, scheduler=started.address, chunk=1, progress=kill_worker)
    run(out, chunk=1)
    assert {file: file.stat().st_mtime_ns for file in kept} == kept
    assert bits(out) == bits(reference)


@pytest.mark.slow
def test_the_commands_of_the_documentation(tmp_path):
    """They are given as written, except for a free port, the folder, and fewer samples."""
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```sh\n(dask scheduler.*?)```", page, re.DOTALL)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    scheduler, worker, study = (
        shlex.split(line) for line in block.replace("8786", str(port)).splitlines()
    )
    assert study[-2:] == ["-o", "study"]
    start = [sys.executable, "-c", "from loadshare.cli.main import main; main()", *study[1:-2]]
    command = [*start, "--samples", "64", "--no-worst", "--with", "study.errors.indices=0", "-o"]
    study_in = {"env": environment(), "cwd": ROOT, "capture_output": True, "text": True}
    workers = []
    try:
        for words in (scheduler, worker):
            with (tmp_path / f"{words[1]}.txt").open("wb") as log:
                workers.append(
                    subprocess.Popen(
                        [sys.executable, "-m", *words],
                        env=environment(),
                        cwd=tmp_path,
                        stdout=log,
                        stderr=log,
                        start_new_session=True,
                    )
                )
        await_workers(f"tcp://127.0.0.1:{port}", 2)
        done = subprocess.run([*command, str(tmp_path / "study")], check=False, **study_in)
        assert done.returncode == 0, done.stderr
        workers[0].kill()
        workers[0].wait()
        gone = subprocess.run([*command, str(tmp_path / "other")], check=False, **study_in)
    finally:
        for process in reversed(workers):
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
    assert gone.returncode == 2
    assert "cannot be reached" in gone.stderr
    assert "Traceback" not in gone.stderr
    at = command.index("--scheduler")
    alone = [*command[:at], *command[at + 2 :], str(tmp_path / "other")]
    here = subprocess.run(alone, check=False, **study_in)
    assert here.returncode == 0, here.stderr
    assert here.stdout == done.stdout
    assert bits(tmp_path / "study") == bits(tmp_path / "other")


def test_a_worker_with_another_version_gets_nothing(tmp_path):
    other = tmp_path / "other" / "loadshare"
    other.mkdir(parents=True)
    (other / "__init__.py").touch()
    (other / "_version.py").write_text('__version__ = "9.9"\n', encoding="utf-8")
    variables = {"PYTHONPATH": str(other.parent)}
    with cluster(tmp_path, 1, variables=variables) as started:
        await_workers(started.address, 1)
        message = f"loadshare 9.9 there, {re.escape(__version__)} here"
        with pytest.raises(ls.LoadshareError, match=rf"tcp://[\d.:]+: {message}"):
            run(tmp_path / "study", samples=64, scheduler=started.address)
    assert not list((tmp_path / "study").glob("part-*"))


def test_every_difference_is_named():
    assert room._python("3.12.1 (main)") == room._python("3.12.7.final.0") == "3.12"
    there = {"tcp://a:1": "3.11", "tcp://b:2": "3.12"}
    assert room._apart("Python", "3.11", there) == ["  tcp://b:2: Python 3.12 there, 3.11 here"]
    assert room._version()() == __version__


def test_a_worker_that_came_late_looks_at_the_version_itself():
    job = Job("case", "", {"version": "0.0.1"})
    with pytest.raises(
        ls.LoadshareError, match=rf"loadshare {re.escape(__version__)} there, 0.0.1"
    ):
        room.part_table(job.to_json(), Part("samples", 0, 1))


def test_a_scheduler_without_workers_is_not_waited_for(tmp_path, monkeypatch):
    monkeypatch.setattr(room, "JOIN", 0.2)
    with cluster(tmp_path, 0) as started, pytest.raises(ls.LoadshareError) as caught:
        run(tmp_path / "study", samples=64, scheduler=started.address)
    assert f"{started.address}: no worker is connected. Start one with `dask worker" in str(
        caught.value
    )


def test_a_cluster_that_is_not_there(tmp_path, monkeypatch):
    monkeypatch.setattr(room, "JOIN", 0.2)
    with pytest.raises(ls.LoadshareError, match="cannot be reached"):
        run(tmp_path / "study", samples=64, scheduler=NOBODY)
