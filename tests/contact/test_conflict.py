"""Rigid rows that contradict each other are named, without rows that have no part in it."""

import numpy as np
import pytest

from loadshare.contact import (
    RIGID,
    ContactProblem,
    Piece,
    PowerLaw,
    Radial,
    RadialLaw,
    Row,
    solve_contact,
)
from loadshare.errors import Refused


@pytest.mark.parametrize("stiffness", [0.0, 1e6])
def test_stops_that_contradict_one_another_are_named(stiffness):
    """x <= 50 um and x >= 200 um contradict; x <= 1 mm and a soft stop have no part in it."""
    rows = (
        Row("upper", "stop", [1.0], 5e-5, RIGID),
        Row("lower", "stop", [-1.0], -2e-4, RIGID),
        Row("far", "stop", [1.0], 1e-3, RIGID),
        Row("soft", "stop", [1.0], 0.0, PowerLaw(1e-8, 0.0)),
    )
    with pytest.raises(Refused, match=r"contradict one another: upper, lower$"):
        solve_contact(ContactProblem(("x",), [[stiffness]], [3.0], rows))
    # Stops that just meet do not contradict each other.
    meets = (rows[0], Row("lower", "stop", [-1.0], -5e-5, RIGID))
    found = solve_contact(ContactProblem(("x",), [[stiffness]], [3.0], meets))
    assert found.place["x"] == pytest.approx(5e-5, rel=1e-9)


def test_three_sides_without_a_place_are_named():
    """x >= 0, y >= 0 and x + y <= -1e-4, whatever the size of the vectors."""
    rows = tuple(
        Row(name, "stop", np.array(vector), gap, RIGID)
        for name, vector, gap in (
            ("left", [-1e3, 0.0], 0.0),
            ("below", [0.0, -1.0], 0.0),
            ("slope", [1.0, 1.0], -1e-4),
        )
    )
    with pytest.raises(Refused, match=r"contradict one another: left, below, slope$"):
        solve_contact(ContactProblem(("x", "y"), 1e6 * np.eye(2), [1.0, 2.0], rows))


def test_a_disc_that_lies_beyond_a_stop_is_named_with_it():
    """Discs may contradict rows too: 3 µm about (1, 0) µm is within x ≤ 4 µm."""
    drum = Radial(
        "drum", np.eye(2), np.array([1e-6, 0.0]), RadialLaw((Piece(0.0, 0.0, 3e-6, "in"),))
    )

    def block(gap: float) -> ContactProblem:
        stop = Row("stop", "stop", np.array([-2.0, 0.0]), -2.0 * gap, RIGID)
        load = np.array([10.0, 3.0])
        return ContactProblem(("x", "y"), np.zeros((2, 2)), load, rows=(stop,), radials=(drum,))

    assert solve_contact(block(3.9e-6)).passed
    with pytest.raises(Refused, match=r"contradict one another: drum, stop$|: stop, drum$"):
        solve_contact(block(4.1e-6))
