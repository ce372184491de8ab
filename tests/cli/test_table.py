"""Tables on narrow screens: no figure is cut, no column lost."""

import re

import pytest

from loadshare.cli.tables.table import show, table

HEADS = ("gear", "x [mm]", "reference", "stiffness [N·m/rad]", "rests", "mass")
ROWS = [
    ("sun", "-103.9230", "45.0000", "695110", "on boundary: outer race", "1.578"),
    ("carrier of the second stage", "0.0000", "150.3508", "1.2e+09", "inside", "12.76"),
]


@pytest.mark.parametrize("width", [30, 40, 60, 80, 200])
def test_no_figure_is_cut_and_no_column_lost(width, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(width))
    show("Gears", table(HEADS, ROWS, words=("gear", "rests")))
    printed = capsys.readouterr().out
    found = re.findall(r"[-+.\de]*\d", printed)
    for row in ROWS:
        for figure in (row[1], row[2], row[3], row[5]):
            assert figure in found
    assert all(len(line) <= width for line in printed.splitlines())
    assert {word for head in HEADS for word in head.split()} <= set(printed.split())
    assert ("further columns" in " ".join(printed.split())) == (width < 80)
