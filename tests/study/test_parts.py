"""A set followed between two points on its own equations, with few certified solves."""

from dataclasses import replace

import numpy as np
import pytest

import loadshare as ls
from loadshare.study.follow.line import Line
from loadshare.study.follow.search import ChangeSearch
from loadshare.study.parameter import read_parameter

FIRST = 9
"""Number of certified solves with which every search starts."""


def pressed(stiffness: str) -> ls.Case:
    """Return a pair whose driver rests on a round limit ring."""
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


def loop() -> ls.Case:
    """Return two pairs, wound up against each other, on floats that open when their meshes do."""
    return ls.Case(
        {
            "operating": {
                "input": "g1",
                "output": "h2",
                "torque": "-66 N*m",
                "running": "clockwise",
                "forces": {"g2": ["-240 N", "-1350 N", "0 N"]},
            },
            "gears": {
                "g1": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]},
                "g2": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]},
                "h1": {"base_radius": "90 mm", "centre": ["149 mm", "0 mm"], "support": "1e8 N/m"},
                "h2": {"base_radius": "90 mm", "centre": ["149 mm", "0 mm"]},
            },
            "meshes": {
                "g1-h1": {"backlash": "0.19 mm", "stiffness": "4e6 N*m/rad"},
                "g2-h2": {"backlash": "0.29 mm", "stiffness": "2e6 N*m/rad"},
            },
            "shafts": {
                "first": {"ends": ["g1", "g2"], "stiffness": "6e5 N*m/rad", "clocking": "2.2 mrad"},
                "second": {"ends": ["h1", "h2"], "stiffness": "rigid"},
            },
            "bearings": {"g1": {"clearance": "20 um", "stiffness": "7e8 N/m"}},
            "splines": {
                "g2": {
                    "bending_stiffness": "8e7 N/m",
                    "clearance": "50 um",
                    "friction_force": "90 N",
                }
            },
            "rings": {"h2": {"radius": "40 um", "stiffness": "5e7 N/m"}},
            "errors": {"g1": {"installation": ["-49 um", "-12 um"]}},
        }
    )


def idlers() -> dict[str, object]:
    """Return changes that add two gears with so much backlash that they may turn freely."""
    places = {"i": ["60 mm", "60 mm"], "j": ["75 mm", "105 mm"]}
    mesh = {"gap": "10 mrad", "backlash": "2 mm", "stiffness": "1e6 N*m/rad"}
    gears = {
        f"gears.{name}": {"base_radius": "20 mm", "centre": centre, "support": "rigid"}
        for name, centre in places.items()
    }
    return gears | {f"meshes.{name}": mesh for name in ("g1-i", "i-j", "j-h1")}


def searched(case: ls.Case, key: str, low: float, high: float, unit: str) -> ChangeSearch:
    return ChangeSearch(Line(case, read_parameter(case, key, unit), low, high), 1, low, high)


@pytest.fixture
def solves(monkeypatch):
    """Return the values that are solved and certified."""
    asked = []
    solved = Line.solved

    def counted(self, position, values):
        asked.extend(values.tolist())
        return solved(self, position, values)

    monkeypatch.setattr(Line, "solved", counted)
    return asked


@pytest.mark.parametrize("stiffness", ["3e9 N/m", "3e7 N/m", "rigid"])
@pytest.mark.parametrize(("low", "high"), [(1e-3, 100.0), (50.0, 60.0)])
def test_a_float_that_moves_straight_outwards_does_not_turn(stiffness, low, high, solves):
    """Its ring is stiff in one direction and soft in the other. When it was taken as stiff in both,
    nothing was proved about a ring that widens by more than it is compressed.
    """
    search = searched(pressed(stiffness), "rings.a.radius", low, high, "um")
    search.run()
    assert (search.changes, search.gaps) == ([], [])
    assert len(solves) == FIRST


def test_a_body_at_rest_elsewhere_is_followed_across_its_room(solves):
    """A free body may rest anywhere: if on opposite sides at both ends, it has room in between."""
    search = searched(loop(), "meshes.g1-h1.backlash", 0.6, 0.7, "mm")
    values = np.array([0.6, 0.7])
    first, last = search.points(values)
    assert first.active == last.active
    equations, numbers = search.equations(first.active), search.line.numbers(1, values)
    state = equations.state(np.array([first.z, last.z]), numbers)
    (bearing,) = (k for k in equations.radials if k not in equations.polar_at)
    names = search.line.structure.coordinates.names
    at = [names.index(f"gear g1 {axis}") for axis in "xy"]
    ends = []
    for k, point in enumerate((first, last)):
        z = point.z.copy()
        edge = (-1.0) ** k * 0.95 * state.laws[bearing].reach[k] * np.array([0.6, 0.8])
        z[at] += edge - state.polars[bearing].offset[k]
        ends.append(replace(point, z=z))
    solves.clear()
    assert search.proved_alike([(ends[0], ends[1])]) == []
    assert search.gaps == []
    assert solves == []


@pytest.mark.parametrize(
    "changed", [{}, pytest.param(idlers(), marks=pytest.mark.slow)], ids=["loop", "idlers"]
)
def test_events_at_which_a_body_loses_all_its_forces_are_proved(changed, solves):
    """The forces on a float vanish with its mesh; free idlers do not disturb the proof."""
    search = searched(loop().replace(changed), "meshes.g1-h1.backlash", 0.0, 0.3, "mm")
    search.run()
    assert [change.confirmed for change in search.changes] == [True, True]
    assert search.gaps == []
    assert len(solves) == FIRST


def test_what_round_off_hides_is_not_solved_again_and_again(solves):
    """Balls are so soft at first that their float is lost in round-off before they lose contact."""
    ball = {"clearance": "20 um", "ball_stiffness": "5e9 N/m^1.5"}
    case = loop().replace({"bearings.g1": ball})
    search = searched(case, "meshes.g1-h1.backlash", 0.0, 0.3, "mm")
    search.run()
    assert [change.confirmed for change in search.changes] == [True, False]
    (gap,) = search.gaps
    assert gap.last.value - gap.first.value < 1e-6
    assert gap.first.value <= search.changes[1].value <= gap.last.value
    assert len(solves) == FIRST
