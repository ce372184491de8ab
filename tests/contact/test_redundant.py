"""Elements that hold the same coordinates: their shares of a load are not unique, but bounded.

Forces that balance one another may be added to an equilibrium; friction bounds them. Source:
formulation, sections 4 and 5.
"""

import math

import numpy as np
import pytest

from loadshare.contact import RIGID, ContactProblem, Piece, Radial, RadialLaw, Row, solve_contact


def pad(name: str, matrix, friction: float) -> Radial:
    """Return a friction pad without a spring or a stop behind it."""
    slips = RadialLaw((Piece(friction, 0.0, math.inf, "slip"),))
    return Radial(name, np.array(matrix, dtype=float), np.zeros(2), slips)


@pytest.mark.parametrize("stiffness", [0.0, 1e6])
@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0])
@pytest.mark.parametrize("load", [3.0, 9.0, 11.5])
@pytest.mark.quick(8)
def test_two_pads_share_what_neither_bears_in_halves(stiffness, angle, load):
    """With bounds of 10 N and 2 N, half of 9 N is too much for one, all of 11.5 N for the other.

    Balance holds to 1e-9 of the load, which the certificate of a contact problem allows.
    """
    pads = (pad("strong", np.eye(2), 10.0), pad("weak", np.eye(2), 2.0))
    loads = load * np.array([math.cos(angle), math.sin(angle)])
    found = solve_contact(ContactProblem(("x", "y"), stiffness * np.eye(2), loads, (), (), pads))
    assert found.place == pytest.approx({"x": 0.0, "y": 0.0}, abs=1e-15)
    assert sum(found.pull.values()) == pytest.approx(loads, abs=1e-9 * load)
    assert np.linalg.norm(found.pull["strong"]) <= 10.0
    assert np.linalg.norm(found.pull["weak"]) <= 2.0


def test_pads_that_share_one_coordinate_only():
    pads = (
        pad("strong", [[1, 0, 0], [0, 1, 0]], 40.0),
        pad("weak", [[1, 0, 0], [0, 0, 1]], 9.0),
    )
    spring, loads = 1e6 * np.eye(3), np.array([30.0, 1.0, 2.0])
    found = solve_contact(ContactProblem(("x", "y", "z"), spring, loads, (), (), pads))
    assert list(found.place.values()) == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)
    strong, weak = found.pull["strong"], found.pull["weak"]
    assert [strong[0] + weak[0], strong[1], weak[1]] == pytest.approx([30.0, 1.0, 2.0], abs=1e-7)
    assert np.linalg.norm(weak) <= 9.0


def test_a_pad_beside_a_rigid_stop_and_a_pin():
    """A pad of 2 N, two opposed stops without play, and 9 N: the stops carry the rest."""
    stops = tuple(Row(n, "stop", [s, 0.0], 0.0, RIGID) for n, s in (("l", -1.0), ("r", 1.0)))
    problem = ContactProblem(
        ("x", "y"), np.zeros((2, 2)), [9.0, 1.5], stops, (), (pad("pad", np.eye(2), 2.0),)
    )
    found = solve_contact(problem)
    pull = found.pull["pad"]
    assert pull[1] == pytest.approx(1.5, abs=1e-8)
    assert found.force["r"] - found.force["l"] + pull[0] == pytest.approx(9.0, abs=1e-8)
    assert np.linalg.norm(pull) <= 2.0


def redundant(seed: int) -> ContactProblem:
    """Return pads, stops with friction in front, drums and rigid rows that are linearly dependent.

    The load is made of forces that all of them admit at rest, so that an equilibrium exists.
    """
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    load, radials, rows = np.zeros(n), [], []
    for j in range(int(rng.integers(2, 6))):
        matrix = rng.integers(-2, 3, (2, n)) if rng.random() < 0.6 else rng.normal(size=(2, n))
        matrix = matrix.astype(float) if matrix.any() else np.ones((2, n))
        friction = 10.0 ** rng.uniform(0.0, 1.5)
        behind = [
            (Piece(friction, 0.0, math.inf, "slip"),),
            (Piece(friction, 1e5, math.inf, "slip"),),
            (Piece(friction, 0.0, 1e-4, "slip"),),
            (Piece(friction, 0.0, 1e-4, "slip"), Piece(2 * friction, 1e6, math.inf, "stop")),
        ][int(rng.integers(0, 4))]
        angle, part = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(0.0, 0.95)
        load += friction * part * np.array([math.cos(angle), math.sin(angle)]) @ matrix
        radials.append(Radial(f"pad {j}", matrix, np.zeros(2), RadialLaw(behind)))
    for e in range(int(rng.integers(0, 4))):
        vector = rng.normal(size=n)
        load += vector * rng.uniform(0.0, 20.0)
        rows.append(Row(f"stop {e}", "stop", vector, 0.0, RIGID))
        if rng.random() < 0.3:
            rows.append(Row(f"stop {e} back", "stop", -vector, 0.0, RIGID))
    root = rng.normal(size=(n, n))
    spring = 1e6 * (root @ root.T + 0.05 * np.eye(n)) * rng.integers(0, 2)
    names = tuple(f"x{k}" for k in range(n))
    return ContactProblem(names, 0.5 * (spring + spring.T), load, tuple(rows), (), tuple(radials))


@pytest.mark.parametrize("seed", range(60))
@pytest.mark.quick(10)
def test_random_elements_share_as_each_admits(seed):
    """At rest every pad carries an admissible force; the test sums the forces independently.

    If springs hold a place, it is unique and at rest, to 1e-12 m; forces agree to 1e-8 of the
    largest.
    """
    problem = redundant(seed)
    found = solve_contact(problem)
    x = np.array(list(found.place.values()))
    left = problem.stiffness @ x - problem.load
    left += sum((r.vector * found.force[r.name] for r in problem.rows), np.zeros(problem.size))
    left += sum(r.matrix.T @ found.pull[r.name] for r in problem.radials)
    band = 1e-8 * max(np.abs(problem.load).max(), *found.force.values(), 1.0)
    assert np.abs(left).max() <= band
    for row in problem.rows:
        gap = row.gap - row.vector @ x
        assert gap >= -1e-12
        assert 0.0 <= found.force[row.name] <= (np.inf if gap <= 1e-12 else 0.0)
    if problem.stiffness.any():
        assert np.abs(x).max() <= 1e-12
        for radial in problem.radials:
            bears = np.linalg.norm(found.pull[radial.name])
            assert bears <= radial.source.pieces[0].force + band
