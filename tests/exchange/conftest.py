"""Shared fixtures of tests of files from other programs."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a file."""

    def write(content: bytes, name: str = "unit.rexs") -> Path:
        path = tmp_path / name
        path.write_bytes(content)
        return path

    return write
