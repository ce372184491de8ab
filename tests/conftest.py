"""Settings and fixtures of all tests."""

import gc
import json
import os
import random
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from tests import reproducible
from tests.chromium import chromium
from tests.reproducible import SAME

from loadshare.job import engines, hot
from loadshare.job.engines import engine_named
from loadshare.outside import OUTSIDE
from loadshare.report import converter

# Mesh laws that tests compute must not go to the user's cache.
os.environ["LOADSHARE_CACHE"] = str(Path(__file__).parent.parent / ".pytest_cache" / "laws")

# Tests write cases into their own folders that inherit shipped ones.
os.environ[OUTSIDE] = "1"

KEPT = 50_000
"""Number of new objects after which cyclic garbage is collected."""

settings.register_profile("same", SAME)
settings.load_profile("same")


def pytest_configure(config: pytest.Config) -> None:
    reproducible.QUICK = "not slow" in config.getoption("markexpr")
    # Most of what is imported and collected stays alive; searching it took a fifteenth of all time.
    gc.set_threshold(KEPT)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--shuffle", metavar="SEED", type=int, help="Run in a random order.")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Choose the quick tests, and shuffle tests if a seed is given."""
    _choose_quick(items)
    _shuffle(config, items)


def _choose_quick(items: list[pytest.Item]) -> None:
    """Keep the stated number of parameter sets of each test, and mark the others as slow.

    The choice depends on their names alone, wherever the files are: in the order of parameters,
    only those of one engine might be kept.
    """
    here = str(Path(__file__).parents[1])
    alike: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("quick") and not item.get_closest_marker("slow"):
            alike.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for several in alike.values():
        (count,) = several[0].get_closest_marker("quick").args
        several.sort(key=lambda item: zlib.crc32(item.nodeid.replace(here, "").encode()))
        for item in several[count:]:
            item.add_marker(pytest.mark.slow)


def _shuffle(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Shuffle files, and tests within each: tests of one file stay together."""
    seed = config.getoption("--shuffle")
    if seed is None:
        return
    by_file: dict[Path, list[pytest.Item]] = {}
    for item in items:
        by_file.setdefault(item.path, []).append(item)
    order = random.Random(seed)
    files = list(by_file.values())
    order.shuffle(files)
    for file in files:
        order.shuffle(file)
    items[:] = [item for file in files for item in file]


@pytest.fixture(scope="session")
def chrome(tmp_path_factory) -> Iterator[Any]:
    """Yield the one browser of a worker; each test resets it first."""
    with chromium(tmp_path_factory.mktemp("profile")) as found:
        yield found


@pytest.fixture(scope="session", autouse=True)
def drawn_once() -> Iterator[Any]:
    """Keep every picture that was drawn: the same specification gives the same text."""
    known: dict[str, Any] = {}
    begin = converter.begin

    def kept(conversion: str, what: object, **settings: Any) -> Any:
        name = json.dumps([conversion, what, settings])
        made = known.get(name)
        if made is None or (made.done() and made.exception() is not None):
            made = known[name] = begin(conversion, what, **settings)
        return made

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(converter, "begin", kept)
        yield begin


@pytest.fixture
def drawn_anew(drawn_once: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw each picture again, for tests of drawing."""
    monkeypatch.setattr(converter, "begin", drawn_once)


@pytest.fixture(autouse=True)
def numpy_alone() -> Iterator[None]:
    """Use NumPy unless a test asks for a kernel: whether one is loaded depends on earlier tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hot, "available_engine", engine_named)
        patch.setattr(engines, "loaded", lambda: False)
        yield
