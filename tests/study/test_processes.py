"""Work side by side in processes: whoever calls it, and whatever becomes of a process."""

import os
import signal
import subprocess
import sys
import threading

import pytest

from loadshare.processes import side_by_side


def test_every_item_is_done_once():
    assert sorted(side_by_side(lambda n: n * n, range(7), 2)) == [(n, n * n) for n in range(7)]
    assert list(side_by_side(abs, [], 2)) == []


def test_only_what_kills_its_process_is_lost():
    def work(n):
        if n == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return -n

    found = dict(side_by_side(work, range(6), 2))
    assert found == {n: None if n == 3 else -n for n in range(6)}


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
        "print('begun', *side_by_side(lambda n: n + 1, [1, 2], 1))\n",
        encoding="utf-8",
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout == "begun (1, 2) (2, 3)\n"
