"""A set followed between two points on its own equations: how few certified solves that takes."""

import pytest

import loadshare as ls
from loadshare.study.follow.line import Line
from loadshare.study.follow.search import Search
from loadshare.study.parameter import read_parameter

FIRST = 9
"""Certified solves with which every search begins."""


def pressed(stiffness: str) -> ls.Case:
    """A pair whose driver rests on a round limit ring."""
    return ls.Case(
        {
            "operating": {"input": "a", "output": "b", "torque": "500 N*m"},
            "gears": {
                "a": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]},
                "b": {"base_radius": "90 mm", "centre": ["149 mm", "0 mm"], "support": "3e8 N/m"},
            },
            "meshes": {"a-b": {"stiffness": "4e5 N*m/rad"}},
            "rings": {"a": {"radius": "1 um", "stiffness": stiffness}},
        }
    )


def searched(case: ls.Case, key: str, low: float, high: float, unit: str) -> Search:
    return Search(Line(case, read_parameter(case, key, unit), low, high), 1, low, high)


@pytest.fixture
def solves(monkeypatch):
    """Values that were solved and certified."""
    asked = []
    solved = Line.solved

    def counted(self, position, values):
        asked.extend(values.tolist())
        return solved(self, position, values)

    monkeypatch.setattr(Line, "solved", counted)
    return asked


@pytest.mark.parametrize("stiffness", ["3e9 N/m", "3e7 N/m", "rigid"])
@pytest.mark.parametrize(("low", "high"), [(50.0, 60.0)])
def test_a_float_that_moves_straight_outwards_does_not_turn(stiffness, low, high, solves):
    """Its ring is stiff one way and soft the other: counted as stiff both ways nothing was proved
    of a ring that widens by more than it is pressed in.
    """
    search = searched(pressed(stiffness), "rings.a.radius", low, high, "um")
    search.run()
    assert (search.changes, search.gaps) == ([], [])
    assert len(solves) == FIRST
