"""Pages are tested as their readers use them."""

import pytest

from loadshare.outside import OUTSIDE


@pytest.fixture(autouse=True)
def nothing_outside(monkeypatch):
    """Keep cases from reading files outside their folders, unless told to."""
    monkeypatch.delenv(OUTSIDE)
