"""Lines of code by package, and functions that are long or branch often.

Run with ``python -m benchmarks.code_lines src [FOLDER ...]``. A line counts if it carries code:
blank lines, comments, and strings on their own (docstrings) do not. Complexity is McCabe's, as ruff
counts it.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import os
import re
import subprocess
import sys
import tokenize
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

LONG = 80
"""Lines of a function above which it is listed."""
BRANCHED = 25
"""Complexity above which a function is listed."""
NO_CODE = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT),
    *(tokenize.ENCODING, tokenize.ENDMARKER),
}


def code_lines(source: str) -> int:
    """Count the lines of a module that carry code."""
    alone = {
        line
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for line in range(node.lineno, node.end_lineno + 1)  # type: ignore[operator]
    }
    carried = {
        line
        for token in tokenize.generate_tokens(io.StringIO(source).readline)
        if token.type not in NO_CODE
        for line in range(token.start[0], token.end[0] + 1)
    }
    return len(carried - alone)


def long_functions(source: str) -> Iterator[tuple[str, int, int]]:
    """Yield name, first line and number of lines of functions of more than `LONG` lines."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            lines = (node.end_lineno or node.lineno) - node.lineno + 1
            if lines > LONG:
                yield node.name, node.lineno, lines


def branched(folders: Iterable[Path]) -> Iterator[tuple[str, str, int, int]]:
    """Yield file, name, line and complexity of functions of complexity above `BRANCHED`."""
    words = (
        "-m",
        "ruff",
        "check",
        "--isolated",
        "--select=C901",
        "--output-format=json",
        "--exit-zero",
    )
    limit = f"--config=lint.mccabe.max-complexity={BRANCHED}"
    output = subprocess.run(
        [sys.executable, *words, limit, *map(str, folders)],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    for found in json.loads(output):
        name, size = re.search(r"`(.*)` is too complex \((\d+)", found["message"]).groups()  # type: ignore[union-attr]
        yield os.path.relpath(found["filename"]), name, found["location"]["row"], int(size)


def package(file: Path) -> str:
    """Return the package of a file: the first two parts of its path."""
    parts = file.parent.parts
    return ".".join(parts[parts[:1] == ("src",) :][:2])


def text(folders: list[Path]) -> str:
    """Return the counts of folders as text."""
    files = sorted(file for folder in folders for file in folder.rglob("*.py"))
    sources = {file: file.read_text(encoding="utf-8") for file in files}
    counts: Counter[str] = Counter()
    for file, source in sources.items():
        counts[package(file)] += code_lines(source)
    lines = [f"{count:7,}  {name}" for name, count in counts.most_common()]
    lines += [f"{counts.total():7,}  in {len(files)} files", "", f"Functions over {LONG} lines"]
    long = sorted(
        (-size, name, f"{file}:{row}")
        for file, source in sources.items()
        for name, row, size in long_functions(source)
    )
    lines += [f"{-size:7,}  {name}  {place}" for size, name, place in long] or ["   none"]
    lines += ["", f"Functions of McCabe complexity over {BRANCHED}"]
    much = sorted((-size, name, f"{file}:{row}") for file, name, row, size in branched(folders))
    lines += [f"{-size:7,}  {name}  {place}" for size, name, place in much] or ["   none"]
    return "\n".join(lines)


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description="Lines of code, long and branched functions.")
    parser.add_argument("folders", nargs="+", type=Path)
    print(text(parser.parse_args().folders))  # noqa: T201


if __name__ == "__main__":
    main()
