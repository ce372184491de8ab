"""What holds for all tests."""

import os
import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from tests.reproducible import SAME

from loadshare.job import engines, hot
from loadshare.job.engines import engine_named
from loadshare.outside import OUTSIDE

# Mesh laws that tests compute stay out of the user's cache.
os.environ["LOADSHARE_CACHE"] = str(Path(__file__).parent.parent / ".pytest_cache" / "laws")

# Tests write cases into folders of their own that inherit shipped ones.
os.environ[OUTSIDE] = "1"

settings.register_profile("same", SAME)
settings.load_profile("same")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--shuffle", metavar="SEED", type=int, help="Run in a random order.")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Shuffle files, and tests within each, where a seed is given: what a file shares stays so."""
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


@pytest.fixture(autouse=True)
def numpy_alone() -> Iterator[None]:
    """Which kernel is at hand depends on what ran before: who asks for none here has NumPy's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hot, "engine_at_hand", engine_named)
        patch.setattr(engines, "loaded", lambda: False)
        yield
