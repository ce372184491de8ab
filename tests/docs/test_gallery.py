"""Notebooks of the gallery: their output and pictures are those that their pages show."""

from __future__ import annotations

import importlib.util
import json
import re
import sys
from pathlib import Path

import pytest
from tests.support import mostly_slow

ROOT = Path(__file__).parents[2]
GALLERY = ROOT / "docs" / "gallery"
PAGES = sorted(p.name for p in GALLERY.glob("*.md") if p.stem != "index")


def _load(name: str, folder: Path):
    spec = importlib.util.spec_from_file_location(name, folder / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


gallery = _load("gallery", Path(__file__).parent)
hooks = _load("hooks", ROOT / "docs")


@pytest.mark.parametrize("page", mostly_slow(PAGES, {"planets.md"}))
def test_a_page_shows_what_its_blocks_print_and_draw(page):
    text = (GALLERY / page).read_text(encoding="utf-8")
    drawn = 0
    with gallery.blocks.workplace():
        for block, printed, image, figure in gallery.cells(text, page):
            output = gallery.shown_output(text, block)
            shown = output.text if output else ""
            assert gallery.blocks.differences(shown, printed) == []
            assert (figure is None) == (image == ""), block.text
            if image:
                drawn += 1
                kept = (GALLERY / image).read_text(encoding="utf-8")
                drawn_words = [" ".join(gallery.words(svg)) for svg in (kept, figure.to_svg())]
                assert gallery.blocks.differences(*drawn_words) == []
    assert drawn > 0


@pytest.mark.parametrize("page", PAGES)
def test_a_page_opens_with_a_question_and_closes_with_an_answer(page):
    text = (GALLERY / page).read_text(encoding="utf-8")
    assert text.startswith("# ")
    opening = text.partition("```")[0]
    assert "?" in opening
    assert "## A second way" in text
    answer = text.partition("## Answer")[2]
    assert re.search(r"```text\n\S", answer)
    assert 5 <= len(re.findall("^```python$", text, re.MULTILINE)) <= 10


def test_every_notebook_is_listed_and_every_picture_shown():
    index = (GALLERY / "index.md").read_text(encoding="utf-8")
    shown = set()
    for page in PAGES:
        assert f"({page})" in index
        assert f"({page.removesuffix('.md')}.ipynb)" in index
        shown |= set(re.findall(r"\(pictures/(\w+\.svg)\)", (GALLERY / page).read_text("utf-8")))
    assert shown == {p.name for p in (GALLERY / "pictures").iterdir()}


@pytest.mark.parametrize("page", PAGES)
def test_a_notebook_has_the_blocks_of_its_page_and_no_output(page):
    text = (GALLERY / page).read_text(encoding="utf-8")
    whole = json.loads(hooks.notebook(text))
    code = ["".join(c["source"]) for c in whole["cells"] if c["cell_type"] == "code"]
    assert code == [b.strip() for b in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)]
    prose = "".join("".join(c["source"]) for c in whole["cells"] if c["cell_type"] == "markdown")
    assert "```text" not in prose
    assert "![" not in prose


@pytest.mark.slow
def test_a_notebook_runs_in_a_kernel_and_shows_its_pictures():
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    text = hooks.notebook((GALLERY / "planets.md").read_text(encoding="utf-8"))
    book = nbformat.reads(text, as_version=4)
    nbformat.validate(book)
    nbclient.NotebookClient(book, timeout=120).execute()
    shown = [o for c in book.cells if c.cell_type == "code" for o in c.outputs]
    assert any("image/svg+xml" in o.get("data", {}) for o in shown)
    assert "Four planets are better" in "".join(o.get("text", "") for o in shown)
