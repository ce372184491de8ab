"""Only one command works in a folder at a time; a second is told so, a killed one blocks none."""

import errno
import os
import re
import signal
import socket
import subprocess
import sys
import threading

import pytest

import loadshare as ls
from loadshare import lock
from loadshare.lock import LOCK, alone_in

HOLDER = """
import sys, time
from pathlib import Path
from loadshare.lock import alone_in
with alone_in(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(3600.0)
"""


@pytest.fixture
def holder(tmp_path):
    """Start another process that works in the folder."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    words = [sys.executable, "-c", HOLDER, tmp_path]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.kill()


def test_who_comes_second_is_told_who_is_there_and_since_when(tmp_path, holder):
    with pytest.raises(ls.LoadshareError) as caught, alone_in(tmp_path):
        pass
    who = f"in use by process {holder.pid} on {re.escape(socket.gethostname())}, since "
    assert re.search(who + r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d [+-]\d{4}\.", str(caught.value))


def test_who_was_killed_is_in_nobodys_way(tmp_path, holder):
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    assert (tmp_path / LOCK).exists()
    with alone_in(tmp_path):
        assert f"process {os.getpid()} on" in (tmp_path / LOCK).read_text()
    assert list(tmp_path.iterdir()) == []


def test_two_never_hold_it_at_once(tmp_path):
    """Each removes the file when it is done, while others are about to lock it."""
    inside, most, done = [], [], []

    def work() -> None:
        while len(done) < 300:
            try:
                with alone_in(tmp_path):
                    inside.append(1)
                    most.append(len(inside))
                    done.append(1)
                    inside.pop()
            except ls.LoadshareError:
                pass

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert max(most) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("code", [errno.EROFS, errno.EACCES])
def test_where_nothing_can_be_written_nobody_is_kept_out(tmp_path, monkeypatch, code):
    def refuse(*_):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(lock.os, "open", refuse)
    with alone_in(tmp_path), alone_in(tmp_path):
        pass


def test_a_file_system_without_locks_is_reported(tmp_path, monkeypatch, caplog):
    def refuse(_):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(lock, "_lock", refuse)
    with alone_in(tmp_path):
        pass
    assert "this file system has no locks" in caplog.text


def test_a_link_in_its_place_is_not_followed(tmp_path):
    other = tmp_path / "other.txt"
    other.write_text("mine", encoding="utf-8")
    (tmp_path / LOCK).symlink_to(other)
    with alone_in(tmp_path):
        pass
    assert other.read_text(encoding="utf-8") == "mine"
