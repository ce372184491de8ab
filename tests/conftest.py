"""What holds for all tests."""

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
from loadshare.report import beside

# Mesh laws that tests compute stay out of the user's cache.
os.environ["LOADSHARE_CACHE"] = str(Path(__file__).parent.parent / ".pytest_cache" / "laws")

# Tests write cases into folders of their own that inherit shipped ones.
os.environ[OUTSIDE] = "1"

KEPT = 50_000
"""Objects after which cycles among them are looked for."""

settings.register_profile("same", SAME)
settings.load_profile("same")


def pytest_configure(config: pytest.Config) -> None:
    reproducible.QUICK = "not slow" in config.getoption("markexpr")
    # Most of what is imported and collected stays; to look through it took a fifteenth of all time.
    gc.set_threshold(KEPT)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--shuffle", metavar="SEED", type=int, help="Run in a random order.")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Choose what is quick, and shuffle tests if a seed is given."""
    _choose_quick(items)
    _shuffle(config, items)


def _choose_quick(items: list[pytest.Item]) -> None:
    """Of the sets of parameters of a test leave so many as it says, and mark the others as slow.

    Which ones hangs on their names alone, wherever the files lie: in their own order, those of one
    engine might be left.
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
    """Shuffle files, and tests within each: what a file shares stays so."""
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
    """The one browser of a worker; who uses it makes it as new first."""
    with chromium(tmp_path_factory.mktemp("profile")) as found:
        yield found


@pytest.fixture(scope="session", autouse=True)
def drawn_once() -> Iterator[Any]:
    """A picture that was drawn is not drawn again: the same specification gives the same text."""
    known: dict[str, Any] = {}
    begin = beside.begin

    def kept(conversion: str, what: object, **settings: Any) -> Any:
        name = json.dumps([conversion, what, settings])
        made = known.get(name)
        if made is None or (made.done() and made.exception() is not None):
            made = known[name] = begin(conversion, what, **settings)
        return made

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(beside, "begin", kept)
        yield begin


@pytest.fixture
def drawn_anew(drawn_once: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """For tests of that: each picture is drawn."""
    monkeypatch.setattr(beside, "begin", drawn_once)


@pytest.fixture(autouse=True)
def numpy_alone() -> Iterator[None]:
    """Which kernel is at hand depends on what ran before: who asks for none here has NumPy's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hot, "engine_at_hand", engine_named)
        patch.setattr(engines, "loaded", lambda: False)
        yield
