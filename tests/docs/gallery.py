"""The notebooks of the gallery: pages whose blocks are run, and whose pictures are drawn, as shown.

``python tests/docs/gallery.py docs/gallery/float.md …`` writes the output of the blocks into the
pages, and draws their pictures.
"""

from __future__ import annotations

import ast
import importlib.util
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

_IMAGE = re.compile(r"\s*!\[[^\]]+\]\((pictures/\w+\.svg)\)")


def _load(name: str):
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


blocks = _load("blocks")


def cells(page: str, place: str) -> Iterator[tuple[Any, str, str, Any]]:
    """Run the Python blocks of a page; yield each, its output, its picture's file, and the picture.

    A block whose last line is a picture shows it, as in a notebook; the image follows the block.
    """
    names: dict[str, Any] = {"__name__": "page"}
    for block in blocks.blocks_of(page):
        if block.language != "python":
            continue
        tree = ast.parse(block.text)
        last = tree.body[-1] if isinstance(tree.body[-1], ast.Expr) else None
        shows = last is not None and not ast.unparse(last).startswith("print(")
        upto = block.text if not shows else ast.unparse(ast.Module(tree.body[:-1], []))
        printed = blocks.run_python(upto, names, place)
        figure = eval(ast.unparse(last.value), names) if shows else None
        image = _IMAGE.match(page, block.end + len("```\n"))
        yield block, printed, image[1] if image else "", figure


def shown_output(page: str, block: Any) -> Any:
    """Return the ``text`` block directly after a Python block; None if there is none."""
    following = [b for b in blocks.blocks_of(page) if b.start > block.end]
    between = page[block.end : following[0].start] if following else ""
    found = following and following[0].language == "text"
    return following[0] if found and between.split() == ["```", "```text"] else None


def words(svg: str) -> list[str]:
    """Return the words in a picture."""
    return re.findall(r"<text[^>]*>([^<]*)</text>", svg)


def rewrite(file: Path) -> None:
    """Write the output of the blocks into a page, and draw its pictures."""
    page = file.read_text(encoding="utf-8")
    parts, at = [], 0
    with blocks.workplace():
        for block, printed, image, figure in cells(page, str(file)):
            if (output := shown_output(page, block)) is not None:
                parts += [page[at : output.start], printed]
                at = output.end
            if image:
                (file.parent / image).write_text(figure.to_svg(), encoding="utf-8")
    file.write_text("".join(parts) + page[at:], encoding="utf-8")


if __name__ == "__main__":
    for argument in [Path(a).resolve() for a in sys.argv[1:]]:
        rewrite(argument)
