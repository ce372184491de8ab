"""What holds for all tests."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from tests.reproducible import SAME

from loadshare.job import hot
from loadshare.job.engines import engine_named
from loadshare.outside import OUTSIDE

# Mesh laws that tests compute stay out of the user's cache.
os.environ["LOADSHARE_CACHE"] = str(Path(__file__).parent.parent / ".pytest_cache" / "laws")

# Tests write cases into folders of their own that inherit shipped ones.
os.environ[OUTSIDE] = "1"

settings.register_profile("same", SAME)
settings.load_profile("same")


@pytest.fixture(autouse=True)
def numpy_alone() -> Iterator[None]:
    """Which kernel is at hand depends on what ran before: who asks for none here has NumPy's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hot, "engine_at_hand", engine_named)
        yield
