"""Scales by which answers of contact problems are judged: a claim cannot inflate them."""

import math

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
    TableLaw,
    residuals,
    solve_contact,
)

ALMOST_RIGID = PowerLaw(1e-30)
STIFF_BEHIND = TableLaw((0.0, 1e-9, 1e14), (0.0, 1e-12, 1.1e-12))


def wedged(law: PowerLaw | TableLaw, load: float = -3000.0) -> ContactProblem:
    """Return a block on a spring between two stops without play."""
    stops = (
        Row("right", "stop", np.array([1.0]), 0.0, law),
        Row("left", "stop", np.array([-1.0]), 0.0, law),
    )
    return ContactProblem(("x",), np.array([[1e6]]), np.array([load]), stops)


@pytest.mark.parametrize("law", [RIGID, ALMOST_RIGID, STIFF_BEHIND])
@pytest.mark.parametrize("squeeze", [1e6, 1e10, 1e13])
def test_stops_that_squeeze_do_not_hide_a_load(law: PowerLaw | TableLaw, squeeze: float) -> None:
    """3000 N are missing, however hard the two stops are claimed to press one another."""
    judged = residuals(wedged(law), np.zeros(1), {"left": squeeze, "right": squeeze}, {})
    assert judged.balance == pytest.approx(1.0)


def test_friction_that_is_never_used_does_not_hide_a_load() -> None:
    grips = Radial(
        "grips", np.eye(2), np.zeros(2), RadialLaw((Piece(1e13, 0.0, math.inf, "slip"),))
    )
    wall = Row("wall", "stop", np.array([1.0, 0.0]), 0.0, RIGID)
    held = ContactProblem(("x", "y"), np.eye(2), np.array([5.0, 0.0]), (wall,), (), (grips,))
    wrong = residuals(held, np.zeros(2), {"wall": 1e12}, {"grips": np.array([-1e12, 0.0])})
    assert wrong.worst == pytest.approx(1.0)
    right = residuals(held, np.zeros(2), {"wall": 2.0}, {"grips": np.array([3.0, 0.0])})
    assert right.worst < 1e-15


@pytest.mark.parametrize("gap", [1e-13, 1e-10, 1e-3, 1e6])
@pytest.mark.parametrize("spring", [1e-3, 1.0, 1e9])
def test_without_load_gaps_and_springs_are_the_scale(gap: float, spring: float) -> None:
    """A stop pushes a block away from the rest position of its spring: F = k g."""
    stop = Row("stop", "stop", np.array([-1.0]), -gap, RIGID)
    pushed = ContactProblem(("x",), np.array([[spring]]), np.zeros(1), (stop,))
    found = solve_contact(pushed)
    assert found.place["x"] == pytest.approx(gap, rel=1e-12)
    assert found.force["stop"] == pytest.approx(spring * gap, rel=1e-12)
    assert residuals(pushed, np.zeros(1), {}, {}).worst > 0.1
    short = {"stop": 0.99 * spring * gap}
    assert residuals(pushed, np.array([gap]), short, {}).worst > 1e-3
    off = {"stop": 0.99 * spring * gap}
    assert residuals(pushed, np.array([0.99 * gap]), off, {}).worst > 1e-3


@pytest.mark.parametrize("overlap", [1e-12, 1e-6, 1.0])
def test_contacts_that_squeeze_a_body_without_springs_or_load(overlap: float) -> None:
    """Both overlap by g at rest: b₁F + b₂F = 2g."""
    pads = (
        Row("right", "stop", np.array([1.0]), -overlap, PowerLaw(2e-6)),
        Row("left", "stop", np.array([-1.0]), -overlap, PowerLaw(6e-6)),
    )
    squeezed = ContactProblem(("x",), np.zeros((1, 1)), np.zeros(1), pads)
    force = 2.0 * overlap / 8e-6
    x = 2e-6 * force - overlap
    found = solve_contact(squeezed)
    assert found.force == pytest.approx({"right": force, "left": force}, rel=1e-9)
    assert found.place["x"] == pytest.approx(x, rel=1e-9)
    for wrong in ({"right": force}, {"right": 0.99 * force, "left": 0.99 * force}, {}):
        assert residuals(squeezed, np.array([x]), wrong, {}).worst > 1e-3


@pytest.mark.parametrize("load", [0.0, 1e-3])
@pytest.mark.parametrize("offset", [1e-6, 1.0])
def test_springs_that_strain_one_another_under_next_to_no_load(load: float, offset: float) -> None:
    """Two springs k, offset by m: each carries k m/2, to its last digits, and half of the load."""
    other = Radial(
        "other",
        np.eye(2),
        np.array([offset, 0.0]),
        RadialLaw((Piece(0.0, 1e9, 2.0 * offset, "spring"), Piece(5e9 * offset, 0.0, 1.0, "end"))),
    )
    springs = 1e9 * np.eye(2)
    strained = ContactProblem(("x", "y"), springs, np.array([load, 0.0]), radials=(other,))
    found = solve_contact(strained)
    assert found.place["x"] == pytest.approx(offset / 2 + load / 2e9, rel=1e-14)
    assert found.pull["other"][0] == pytest.approx(-1e9 * offset / 2 + load / 2, rel=1e-12)
    away = np.array([0.51 * offset, 0.0])
    pull = {"other": np.array([-0.49e9 * offset, 0.0])}
    assert residuals(strained, away, {}, pull).worst > 1e-3


def test_a_body_squeezed_a_million_times_as_hard_as_it_is_loaded() -> None:
    """A stiff pad presses it into the corner between a rigid stop and a rigid rim."""
    law = RadialLaw((Piece(0.0, 0.0, 1.0, "inside"),))
    matrix = np.array([[1.17, 1.39, -1.35], [-0.11, 0.41, -0.2]])
    rim = Radial("rim", matrix, np.array([1.0, 2.0]), law)
    rows = (
        Row("stop", "stop", np.array([-2.0, -1.0, -1.0]), 1.0, RIGID),
        Row("pad", "stop", np.array([-1.0, 1.0, 0.0]), 3.0, PowerLaw(1e-12)),
    )
    springs = np.outer([2e3, 0.0, 1e3], [2e3, 0.0, 1e3])
    body = ContactProblem(("x", "y", "z"), springs, [-1e6, -1e6, -1e6], rows, radials=(rim,))
    found = solve_contact(body)
    place = np.array(list(found.place.values()))
    pushed = matrix.T @ found.pull["rim"] + springs @ place + 1e6
    pushed += found.force["stop"] * rows[0].vector + found.force["pad"] * rows[1].vector
    assert np.linalg.norm(matrix @ place - rim.centre) == pytest.approx(1.0, rel=1e-12)
    assert found.force["pad"] == pytest.approx((rows[1].vector @ place - 3.0) / 1e-12, rel=1e-9)
    assert np.abs(pushed).max() < 1e-9 * found.force["pad"]


@pytest.mark.parametrize("seed", range(4))
def test_a_pin_holds_in_any_direction_though_its_centre_rounds(seed: int) -> None:
    """A pin without play carries any force; its offset is what rounding leaves, without direction.

    The place and the forces follow from the two balances and the pin: 6 equations by elimination.
    The displacements are far larger than the play of the drum, by which lengths are measured.
    """
    rng = np.random.default_rng(seed)
    pins, leans = rng.normal(size=(2, 4)), rng.normal(size=(2, 4))
    load = 10.0 * rng.normal(size=4)
    pin = Radial("pin", pins, np.zeros(2), RadialLaw((Piece(0.0, 0.0, 0.0, "inside"),)))
    wall = RadialLaw((Piece(0.0, 0.0, 0.5, "inside"), Piece(0.0, 2.0, math.inf, "wall")))
    drum = Radial("drum", leans, np.zeros(2), wall)
    held = ContactProblem(tuple("abcd"), np.zeros((4, 4)), load, radials=(pin, drum))
    found = solve_contact(held)
    pushed = np.linalg.solve(np.vstack([pins, leans]).T, load)
    assert np.concatenate([found.pull["pin"], found.pull["drum"]]) == pytest.approx(pushed)
    offset = (0.5 + np.linalg.norm(pushed[2:]) / 2.0) / np.linalg.norm(pushed[2:]) * pushed[2:]
    place = np.linalg.solve(np.vstack([pins, leans]), np.concatenate([np.zeros(2), offset]))
    assert np.array(list(found.place.values())) == pytest.approx(place)
    turned = dict(found.pull) | {"drum": found.pull["drum"][::-1]}
    assert residuals(held, place, {}, turned).worst > 1e-3
    aside = place + np.linalg.pinv(pins) @ np.array([1e-6, 0.0])
    assert residuals(held, aside, {}, found.pull).worst > 1e-7
