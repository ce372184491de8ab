"""Coordinates that the forces of a contact problem leave undetermined, and those they determine."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from loadshare.contact import (
    RIGID,
    Arc,
    ArcRow,
    ContactProblem,
    Piece,
    PowerLaw,
    Radial,
    RadialLaw,
    Row,
    solve_contact,
)

SPRING = RadialLaw((Piece(0.0, 1e3, math.inf, "spring"),))
PIN = RadialLaw((Piece(0.0, 0.0, 0.0, "pin"),))
FRICTION = RadialLaw((Piece(5.0, 0.0, math.inf, "slip"),))
DRUM = RadialLaw((Piece(0.0, 0.0, 0.1, "inside"),))
SPLINE = RadialLaw(
    (Piece(0.0, 1e3, 0.01, "stick"), Piece(10.0, 0.0, 0.05, "slip"), Piece(10.0, 1e3, 1.0, "stop"))
)
"""It sticks up to 10 N at 10 mm, slips up to 60 mm and then bends again."""


def disc(
    law: RadialLaw,
    load: Sequence[float] = (0.0, 0.0),
    rows: Sequence[Row] = (),
    centre: Sequence[float] = (0.0, 0.0),
) -> ContactProblem:
    """Return a disc without springs on one radial element."""
    held = Radial("held", np.eye(2), np.array(centre), law)
    return ContactProblem(("x", "y"), np.zeros((2, 2)), np.array(load), tuple(rows), (), (held,))


def block(left: PowerLaw, right: PowerLaw, play: float = 0.0) -> ContactProblem:
    """Return a block without spring or load between two stops."""
    stops = (Row("left", "stop", [-1.0], 0.0, left), Row("right", "stop", [1.0], play, right))
    return ContactProblem(("x",), np.zeros((1, 1)), np.zeros(1), stops)


@pytest.mark.parametrize("law", [SPRING, PIN, FRICTION, SPLINE])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (1.0, 2.0)])
def test_what_pulls_back_from_everywhere_holds_without_load(
    law: RadialLaw, centre: tuple[float, float]
) -> None:
    found = solve_contact(disc(law, centre=centre))
    assert found.place == pytest.approx({"x": centre[0], "y": centre[1]}, abs=1e-12)
    assert not found.undetermined


@pytest.mark.parametrize("right", [RIGID, PowerLaw(1e-6), PowerLaw(0.0, 1e-6)])
@pytest.mark.parametrize("left", [RIGID, PowerLaw(1e-6)])
def test_stops_that_touch_from_both_sides_hold(left: PowerLaw, right: PowerLaw) -> None:
    assert not solve_contact(block(left, right)).undetermined
    assert solve_contact(block(left, right, play=1e-6)).undetermined == {"x"}


def test_three_stops_around_a_disc_hold_it_and_two_do_not() -> None:
    ways = [np.array([math.cos(a), math.sin(a)]) for a in (0.3, 0.3 + 2.0, 0.3 + 4.0)]
    stops = [Row(f"stop {k}", "stop", way, 0.0, RIGID) for k, way in enumerate(ways)]
    for count, expected in ((3, set()), (2, {"x", "y"})):
        around = ContactProblem(("x", "y"), np.zeros((2, 2)), np.zeros(2), stops[:count])
        assert solve_contact(around).undetermined == expected


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        ((10.0, 0.0), {"x"}),
        ((0.0, -10.0), {"y"}),
        ((6.0, 8.0), {"x", "y"}),
        ((9.0, 0.0), set()),
        ((11.0, 0.0), set()),
    ],
)
def test_a_spline_slips_under_exactly_its_friction(
    load: tuple[float, float], expected: set[str]
) -> None:
    """It is in equilibrium anywhere from 10 to 60 mm along the load."""
    assert solve_contact(disc(SPLINE, load)).undetermined == expected


def test_a_spring_along_it_holds_what_slips() -> None:
    """The spring carries 10 N with 10 mm at 1 kN/m, the friction the other 10 N."""
    slips = Radial("spline", np.eye(2), np.zeros(2), SPLINE)
    springs = np.diag([1e3, 0.0])
    found = solve_contact(ContactProblem(("x", "y"), springs, [30.0, 0.0], radials=(slips,)))
    assert found.place == pytest.approx({"x": 0.02, "y": 0.0}, abs=1e-12)
    assert not found.undetermined


@pytest.mark.parametrize(
    ("side", "expected"), [(-1.0, set()), (1.0, {"x", "y"})], ids=["outside", "inside"]
)
def test_a_wall_that_touches_a_round_drum(side: float, expected: set[str]) -> None:
    """A wall at the edge of a drum of 0.1 leaves all of the drum free, or only its own point."""
    wall = Row("wall", "stop", np.array([side, 0.0]), side * 0.1, RIGID)
    found = solve_contact(disc(DRUM, rows=[wall]))
    assert found.undetermined == expected
    if not expected:
        assert found.place == pytest.approx({"x": 0.1, "y": 0.0}, abs=1e-9)


def test_a_body_that_is_pressed_onto_an_arc_is_held_along_it() -> None:
    """Anywhere else on the arc, the contact force would not be opposite to the load."""
    arc = Arc(np.array([0.1, 0.0, 0.0]), np.zeros(3), 1e-3)
    relative = np.vstack([np.eye(2), np.zeros((1, 2))])
    rolls = ArcRow("arc", arc, relative, RIGID, 0.0)
    found = solve_contact(
        ContactProblem(("x", "y"), np.zeros((2, 2)), np.array([-1e3, 0.0]), arcs=(rolls,))
    )
    assert found.place == pytest.approx({"x": -1e-3, "y": 0.0}, abs=1e-12)
    assert not found.undetermined
