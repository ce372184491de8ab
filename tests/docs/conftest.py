"""Pages are tried as their readers do."""

import pytest

from loadshare.outside import OUTSIDE


@pytest.fixture(autouse=True)
def nothing_outside(monkeypatch):
    """No case reads a file outside of its folder, unless it is told to."""
    monkeypatch.delenv(OUTSIDE)
