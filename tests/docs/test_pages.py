"""Every block of the pages is run; a reader gets the output that the page shows."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def _load(name: str):
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


blocks = _load("blocks")


@pytest.mark.parametrize(
    "page",
    [
        "docs/index.md",
        pytest.param("docs/tutorial.md", marks=pytest.mark.slow),
        pytest.param("docs/gearbox.md", marks=pytest.mark.slow),
        pytest.param("docs/spreadsheets.md", marks=pytest.mark.slow),
        pytest.param("docs/pictures.md", marks=pytest.mark.slow),
        pytest.param("docs/studies.md", marks=pytest.mark.slow),
        "docs/contact.md",
        "docs/results.md",
        "docs/api.md",
        "README.md",
    ],
)
def test_page(page: str):
    text = (ROOT / page).read_text(encoding="utf-8")
    shown = 0
    with blocks.workplace():
        for block, real in blocks.outcomes(text, page):
            assert blocks.differences(block.text, real) == []
            shown += 1
    assert blocks.blocks_of(text), "the page has no block that was found"
    if page not in ("docs/results.md", "docs/studies.md"):
        assert shown > 0


def test_a_wrong_number_is_seen():
    assert blocks.differences("Ω 1.0471 at 3", "Ω 1.0472 at 3")
    assert blocks.differences("a 1.0\nb 2", "a 1.0")
    assert blocks.differences("a 1.0", "a 1.0\nb 2")
    assert blocks.differences("residual 1e-12", "residual 1e-3")
    assert not blocks.differences("load  1000.0001 N", "load 1000.0002 N")
    assert not blocks.differences("moment 2e-11 N 4", "moment 8e-12 N 7-8")
    assert not blocks.differences("a\n…\nz", "a\nb\nc\nz")
    assert blocks.differences("a\n…\nz", "a\nb\nc")
