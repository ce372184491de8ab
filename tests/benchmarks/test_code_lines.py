"""The counts of `python -m benchmarks.code_lines`."""

from importlib.util import find_spec
from pathlib import Path

import pytest

from benchmarks.code_lines import BRANCHED, LONG, code_lines, package, text

MODULE = '''"""Docstring,
of two lines."""

import os  # counts once

# A comment.
SIZE = 3
"""A string that stands alone."""

TEXT = """
two lines of data, and the empty one

"""


def total(
    a,
    b,
):
    """Docstring."""
    return (
        a  # kept
        # not kept
        + b
    )
'''


def test_lines_of_code_are_counted():
    # import 1, SIZE 1, TEXT 4, the head 4, the body 4.
    assert code_lines(MODULE) == 14
    assert code_lines("") == code_lines('"""Only words."""\n# and more\n') == 0
    assert code_lines("x = 1; y = 2\n") == 1


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("src/loadshare/errors.py", "loadshare"),
        ("src/loadshare/solver/hot/compiled.py", "loadshare.solver"),
        ("benchmarks/peers/form.py", "benchmarks.peers"),
        ("benchmarks/kept.py", "benchmarks"),
    ],
)
def test_a_file_counts_for_its_package(file, name):
    assert package(Path(file)) == name


@pytest.mark.skipif(find_spec("ruff") is None, reason="ruff is not installed")
def test_long_and_branched_functions_are_listed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    body = "    x = 1\n"
    long = f"def exactly():\n{body * (LONG - 1)}\n\ndef longer():\n{body * LONG}"
    branch = "    if x:\n        x = 0\n"
    forked = f"def just(x):\n{branch * (BRANCHED - 1)}\n\ndef forked(x):\n{branch * BRANCHED}"
    (tmp_path / "many.py").write_text(f"{long}\n\n{forked}")
    report = text([Path()])
    assert f"{LONG + 1:7}  longer  many.py:{LONG + 3}\n" in report
    assert f"{BRANCHED + 1:7}  forked" in report
    assert "exactly" not in report
    assert "just" not in report
