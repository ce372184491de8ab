"""A terminal shows that libraries are being loaded, and the message is removed afterwards."""

from __future__ import annotations

import os
import time
from contextlib import contextmanager, redirect_stderr

import pytest

from loadshare import compile_watch
from loadshare.cli import waiting
from loadshare.cli.waiting import hush

pty = pytest.importorskip("pty")


@contextmanager
def terminal():
    """Replace stderr by a terminal; yield a function that reads what it received.

    It is used in the test's body, because pytest restores its streams between fixtures and test.
    """
    ours, theirs = pty.openpty()
    os.set_blocking(ours, False)

    def sent():
        try:
            return os.read(ours, 10_000).decode()
        except BlockingIOError:
            return ""

    with os.fdopen(theirs, "w", encoding="utf-8") as stream, redirect_stderr(stream):
        yield sent
    os.close(ours)


def _shown(sent):
    for _ in range(500):
        if text := sent():
            return text
        time.sleep(0.01)
    return ""


def test_what_takes_long_is_reported_until_something_is_printed(monkeypatch, capsys):
    monkeypatch.setattr(waiting, "DELAY", 0.01)
    with terminal() as sent:
        with waiting.waiting():
            assert _shown(sent) == waiting.LINE
            waiting.echo("an answer")
            assert sent() == "\r\033[K"
        assert sent() == ""
    assert capsys.readouterr().out == "an answer\n"


def test_what_is_quick_or_quiet_tells_nothing(monkeypatch):
    monkeypatch.setattr(waiting, "DELAY", 0.01)
    with terminal() as sent:
        hush(True)
        try:
            with waiting.waiting():
                time.sleep(0.1)
        finally:
            hush(False)
        monkeypatch.setattr(waiting, "DELAY", 60.0)
        with waiting.waiting():
            pass
        assert sent() == ""


def test_nothing_is_printed_without_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr(waiting, "DELAY", 0.0)
    with waiting.waiting():
        time.sleep(0.05)
    assert capsys.readouterr().err == ""


def test_a_quiet_command_does_not_tell_that_it_compiles(monkeypatch, caplog):
    compile_watch.watch.wait(60.0)
    monkeypatch.setattr(compile_watch, "PATIENCE", 0.02)

    def compiled():
        watch = compile_watch.Watch()
        with waiting.waiting():
            watch.started()
            time.sleep(0.1)
            watch.not_kept("the folder is read-only")
            watch.ended()
            watch.wait(10.0)
        messages = [record.message for record in caplog.records]
        caplog.clear()
        return messages

    hush(True)
    try:
        assert compiled() == [
            "Compiling: what was compiled could not be kept (the folder is read-only)."
        ]
    finally:
        hush(False)
    assert len(compiled()) == 3
