"""A server of a case in this process, and a browser that may reach it."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
import uvicorn
from tests.chromium import as_new
from tests.support import CASES

from loadshare.case import load_case
from loadshare.explore.guard import hosts_of
from loadshare.explore.server import application

SEED = CASES / "fgfbstts/limit_ring.toml"


@contextlib.contextmanager
def serving(case, file=None) -> Iterator[str]:
    """Yield the address of an explorer of a case."""
    listening = socket.socket()
    listening.bind(("127.0.0.1", 0))
    port = listening.getsockname()[1]
    app = application(case, hosts_of("127.0.0.1", port), file)
    server = uvicorn.Server(uvicorn.Config(app, log_level="error", access_log=False))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    try:
        yield f"http://127.0.0.1:{port}/"
    finally:
        server.should_exit = True
        thread.join(10)
        listening.close()


@pytest.fixture(scope="session")
def seed() -> Iterator[str]:
    """Yield the address of an explorer of the seed's case with limit rings."""
    with serving(load_case(SEED), SEED) as address:
        yield address


@pytest.fixture(scope="session")
def served():
    """Return a context manager that serves a case for one test."""
    return serving


@pytest.fixture(scope="module")
def browser(chrome) -> Any:
    """Return a headless Chromium that reaches this computer but no other."""
    return as_new(chrome, offline=False)
