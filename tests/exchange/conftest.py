"""What tests of files from elsewhere share."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture
def written(tmp_path):
    """Return how a file is written."""

    def write(content: bytes, name: str = "unit.rexs") -> Path:
        path = tmp_path / name
        path.write_bytes(content)
        return path

    return write
