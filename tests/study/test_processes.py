"""Parallel work in processes: whoever calls it, and whatever happens to a process."""

import os
import signal
import subprocess
import sys
import threading
import time

import psutil
import pytest

from loadshare.errors import LoadshareError
from loadshare.processes import side_by_side


def test_every_item_is_done_once():
    assert sorted(side_by_side(lambda n: n * n, range(7), 2)) == [(n, n * n) for n in range(7)]
    assert list(side_by_side(abs, [], 2)) == []


@pytest.mark.skipif(sys.platform == "win32", reason="a folder in use stays there")
def test_without_a_current_folder_no_process_can_be_started_and_that_is_said(tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with pytest.raises(LoadshareError, match="the current folder no longer exists"):
        list(side_by_side(abs, [1], 2))


def test_only_what_kills_its_process_is_lost():
    def work(n):
        if n == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return -n

    found = dict(side_by_side(work, range(6), 2))
    assert found == {n: None if n == 3 else -n for n in range(6)}


def test_a_process_that_dies_costs_one_more_try_and_leaves_the_others_side_by_side(tmp_path):
    """The fourth of 40 items kills its process at first; from the 21st on, items meet in pairs."""

    def work(n):
        with (tmp_path / f"{n}").open("a") as log:
            log.write("started ")
        if n == 3 and (tmp_path / "3").read_text() == "started ":
            os.kill(os.getpid(), signal.SIGKILL)
        other = tmp_path / f"{n ^ 1}"
        end = time.monotonic() + 60.0
        while n >= 20 and not other.exists():
            if time.monotonic() > end:
                return "alone"
            time.sleep(0.001)
        return "met"

    found = list(side_by_side(work, range(40), 2))
    assert sorted(found) == [(n, "met") for n in range(40)]
    # It is tried again after all others have started.
    assert [n for n, _ in found].index(3) >= 38
    starts = {n: (tmp_path / f"{n}").read_text().count("started") for n in range(40)}
    assert starts == {n: 2 if n == 3 else 1 for n in range(40)}


def test_a_process_that_dies_between_two_items_takes_none_with_it():
    found = {}
    for item, pid in side_by_side(lambda _: os.getpid(), range(3), 1):
        found[item] = pid
        if item == 0:
            victim = psutil.Process(pid)
            victim.kill()
            gone, _ = psutil.wait_procs([victim], timeout=60.0)
            assert gone
    assert sorted(found) == [0, 1, 2]
    assert None not in found.values()
    assert found[1] == found[2] != found[0]


def test_what_is_under_way_is_finished_when_no_more_is_to_be_started():
    started = []
    found = side_by_side(lambda n: n, range(9), 1, lambda: len(started) > 1)
    for item, _ in found:
        started.append(item)
    assert started == [0, 1]


def test_nobody_asks_for_more(tmp_path):
    """Running work is killed, however long it would take."""

    def work(n):
        if n:
            (tmp_path / "pid").write_text(f"{os.getpid()} ")
            time.sleep(3600.0)

    found = side_by_side(work, range(2), 2)
    next(found)
    while not (tmp_path / "pid").exists() or not (tmp_path / "pid").read_text().endswith(" "):
        time.sleep(0.01)
    found.close()
    assert not psutil.pid_exists(int((tmp_path / "pid").read_text()))


def test_what_work_raises_is_raised():
    def work(n):
        raise ZeroDivisionError(f"item {n}")

    with pytest.raises(ZeroDivisionError, match="item 0"):
        next(side_by_side(work, range(3), 1))


def test_workers_have_one_thread_of_blas_and_leave_interrupts():
    def work(_):
        return os.environ["OPENBLAS_NUM_THREADS"], signal.getsignal(signal.SIGINT)

    assert next(side_by_side(work, [0], 1)) == (0, ("1", signal.SIG_IGN))


def test_a_thread_may_ask():
    found = []
    thread = threading.Thread(target=lambda: found.extend(side_by_side(abs, [-1], 1)))
    thread.start()
    thread.join()
    assert found == [(-1, 1)]


def test_a_script_needs_no_guard(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from loadshare.processes import side_by_side\n"
        "print('started', *side_by_side(lambda n: n + 1, [1, 2], 1))\n",
        encoding="utf-8",
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout == "started (1, 2) (2, 3)\n"
