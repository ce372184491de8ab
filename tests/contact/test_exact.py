"""The exact active-set solve against brute force, and systems of deficient rank.

Source: formulation, sections 4 and 11. The reference tries every set of closed contacts with plain
linear algebra.
"""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from loadshare.contact.exact import ActiveSet, first_guess, identify, solve_exact
from loadshare.contact.kkt import solve_symmetric
from loadshare.contact.programme import Point, Programme


def problem(seed: int, rigid: bool, size: int = 5, contacts: int = 7) -> Programme:
    """Return a random contact problem with a definite H, so that any load has one answer."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(size, size))
    rows = rng.normal(size=(contacts, size))
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    return Programme(
        coordinates=tuple(f"coordinate {k}" for k in range(size)),
        stiffness=root @ root.T + 0.1 * np.eye(size),
        load=rng.normal(size=size),
        names=tuple(f"contact {e}" for e in range(contacts)),
        rows=rows,
        gaps=rng.uniform(0.0, 0.2, contacts),
        linear=np.zeros(contacts) if rigid else rng.uniform(0.1, 2.0, contacts),
        hertz=np.zeros(contacts),
        assumed_closed=np.zeros(contacts, dtype=bool),
        cones=(),
    )


def by_brute_force(p: Programme) -> tuple[np.ndarray, np.ndarray]:
    """Try every active set; the right one pushes everywhere and penetrates nowhere."""
    n, m = len(p.load), len(p.gaps)
    for count in range(n + 1):
        for chosen in map(list, itertools.combinations(range(m), count)):
            a = p.rows[chosen]
            matrix = np.block([[p.stiffness, a.T], [a, -np.diag(p.linear[chosen])]])
            solution = np.linalg.solve(matrix, np.concatenate([p.load, p.gaps[chosen]]))
            x, closed = solution[:n], solution[n:]
            apart = p.gaps - p.rows @ x
            if (closed >= 0.0).all() and np.delete(apart, chosen).min(initial=0.0) >= 0.0:
                forces = np.zeros(m)
                forces[chosen] = closed
                return x, forces
    raise AssertionError("no set of contacts is consistent")


@pytest.mark.parametrize("rigid", [False, True], ids=["elastic", "rigid"])
@pytest.mark.parametrize("seed", range(25))
def test_the_exact_solve_finds_what_brute_force_finds(seed, rigid):
    """It starts from no contact at all and from the right set. The condition number of the systems
    is below 1e4, hence 1e-11.
    """
    p = problem(seed, rigid)
    x, forces = by_brute_force(p)
    right = ActiveSet(tuple(bool(f > 0.0) for f in forces), ())
    for guess in (first_guess(p), right):
        solved = solve_exact(p, guess)
        if solved is None:
            assert guess != right
            continue
        point, active = solved
        assert point.x == pytest.approx(x, abs=1e-11)
        assert point.forces == pytest.approx(forces, abs=1e-11)
        assert active == right


@pytest.mark.parametrize("seed", range(10))
def test_an_active_set_is_read_from_an_approximate_answer(seed):
    """The error is a hundred times that of any back-end; every contact is still classified."""
    p = problem(seed, rigid=False)
    x, forces = by_brute_force(p)
    rng = np.random.default_rng(seed + 1000)
    near = Point(
        x + 1e-6 * rng.normal(size=x.size),
        forces + 1e-6 * rng.normal(size=forces.size),
        np.zeros((0, 2)),
    )
    clear = np.abs(forces - (p.gaps + p.linear * forces - p.rows @ x)) > 1e-4
    found = np.array(identify(p, near).closed)
    assert (found == (forces > 0.0))[clear].all()


def test_what_a_set_leaves_open_goes_to_its_least_norm_or_stays():
    """One body is on a spring; nothing holds the other, 3 away from 0 and beyond a stop at 1."""
    p = replace(
        problem(0, rigid=True, size=2, contacts=1),
        stiffness=np.diag([2.0, 0.0]),
        load=np.array([1.0, 0.0]),
        rows=np.array([[0.0, -1.0]]),
        gaps=np.array([-1.0]),
    )
    start = Point(np.array([0.0, 3.0]), np.zeros(1), np.zeros((0, 2)))
    for stay, place in ((False, 1.0), (True, 3.0)):
        point, active = solve_exact(p, first_guess(p), start, stay=stay)
        assert point.x == pytest.approx([0.5, place], abs=1e-15)
        assert point.forces == pytest.approx([0.0], abs=1e-15)
        assert active.closed == (not stay,)


def test_a_regular_system_is_solved_to_round_off():
    """The system is badly scaled on purpose, with entries over twelve decades."""
    rng = np.random.default_rng(3)
    core = rng.normal(size=(6, 6))
    scale = 10.0 ** rng.uniform(-6, 6, 6)
    matrix = (core + core.T) * scale[:, None] * scale
    expected = rng.normal(size=6) / scale
    solved = solve_symmetric(matrix, matrix @ expected, 4)
    assert solved.values == pytest.approx(expected, rel=1e-10)
    assert solved.moves.shape == (4, 0)


def test_a_singular_system_gives_the_least_norm_and_its_free_direction():
    """Two masses with one spring between them and no ground may move together."""
    matrix = np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 2.0]])
    solved = solve_symmetric(matrix, np.array([1.0, -1.0, 4.0]), 3)
    assert solved.values == pytest.approx([0.5, -0.5, 2.0], abs=1e-14)
    assert solved.moves.shape == (3, 1)
    assert np.abs(solved.moves[:, 0]) == pytest.approx([0.5**0.5, 0.5**0.5, 0.0], abs=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_least_norm_against_the_pseudo_inverse(seed):
    """A random semidefinite H of deficient rank, with a load in its range."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(6, 4))
    matrix = root @ root.T
    right = matrix @ rng.normal(size=6)
    solved = solve_symmetric(matrix, right, 6)
    assert solved.values == pytest.approx(np.linalg.pinv(matrix) @ right, rel=1e-9, abs=1e-9)
    assert np.linalg.norm(matrix @ solved.moves) < 1e-12 * np.linalg.norm(matrix)
    assert solved.moves.shape[1] == 2


def test_a_load_that_nothing_holds_has_no_answer():
    matrix = np.array([[1.0, -1.0], [-1.0, 1.0]])
    assert solve_symmetric(matrix, np.array([1.0, 1.0]), 2) is None
