"""The contact programme: Hertz's limits, other solvers, wrong answers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from tests.reproducible import examples
from tests.tooth.ltca.hertz import PointContact, compression
from tests.tooth.ltca.judged import certify_contact

from loadshare.contact.backends.backend import SOLVERS, backend
from loadshare.errors import Refused
from loadshare.settings import TEETH
from loadshare.tooth.contact import programme as contact_programme
from loadshare.tooth.contact.problem import ContactBatch, ToothContact
from loadshare.tooth.contact.programme import by_interface, exchange, solve_contact, solve_contacts
from loadshare.tooth.contact.strips import StripLine, contact_modulus, half_width

STEEL = ((206e9, 206e9), (0.3, 0.3))
E_STAR = contact_modulus(*STEEL)
RADIUS = 1.0 / (2.0 / 25e-3 + 2.0 / 50e-3)


def crowned(points, length, across, along):
    """Return two crowned half-spaces that touch in the middle of a line."""
    part = np.full(points, length / points)
    place = np.cumsum(part) - 0.5 * part - 0.5 * length
    line = StripLine(part, np.full(points, across), np.full(points, along), *STEEL)
    return ToothContact(np.zeros((points, points)), 0.5 * along * place**2, (line,))


def uneven(seed, points=24, lines=2):
    """Return lines on a random compliance with random gaps of a few microns."""
    rng = np.random.default_rng(seed)
    count = points * lines
    root = rng.normal(size=(count, count)) / count
    bulk = 1e-8 * (root @ root.T + 0.2 * np.ones((count, count)))
    strips = tuple(
        StripLine(np.full(points, 1e-3), np.full(points, 80.0), np.zeros(points), *STEEL)
        for _ in range(lines)
    )
    gap = 1e-6 * rng.gamma(1.0, 4.0, size=count)
    return ToothContact(bulk, gap - gap.min(), strips)


def test_two_spheres():
    """Figures of validation.md within 0.5 %, exponent 2/3 within 0.002; 50 points on 1.5 mm."""
    problem = crowned(50, 1.5e-3, 1.0 / RADIUS, 1.0 / RADIUS)
    load = np.array([100.0, 200.0, 800.0])
    found = [solve_contact(problem, p) for p in load]
    approach = np.array([c.approach for c in found])
    pressure = [problem.lines[0].pressure(c.force).max() / 1e6 for c in found]
    np.testing.assert_allclose(approach * 1e6, [3.749, 5.951, 14.996], rtol=5e-3)
    np.testing.assert_allclose(pressure, [1528, 1926, 3057], rtol=5e-3)
    exponent = np.polyfit(np.log(load), np.log(approach), 1)[0]
    assert exponent == pytest.approx(2.0 / 3.0, abs=0.002)


def test_points_converge_to_the_ellipse():
    """The error decreases faster than in proportion to the spacing: observed order about 1.6."""
    contact = PointContact((1.0 / RADIUS, 0.3 / RADIUS), E_STAR)
    exact = float(contact.approach(200.0))
    errors = [
        abs(solve_contact(crowned(n, 3e-3, 1 / RADIUS, 0.3 / RADIUS), 200.0).approach / exact - 1)
        for n in (25, 50, 100, 200)
    ]
    assert errors[-1] < 2e-4
    assert np.log2(errors[0] / errors[-1]) / 3.0 > 1.2


@pytest.mark.parametrize("ratio", [2.0, 1.0, 0.2, 0.02])
def test_ellipses(ratio):
    """This holds for any axis ratio, including a line along the minor axis: 0.5 %."""
    contact = PointContact((1.0 / RADIUS, ratio / RADIUS), E_STAR)
    a, b = (float(x) for x in contact.axes(300.0))
    half = b if ratio > 1.0 else a
    found = solve_contact(crowned(81, 2.4 * half, 1 / RADIUS, ratio / RADIUS), 300.0)
    assert found.approach == pytest.approx(float(contact.approach(300.0)), rel=5e-3)


def test_line_contact_against_its_closed_form():
    """A long line without crowning, compression of both bodies to the depth h: within 1 %."""
    points, depth, length, q = 60, 3e-3, 0.3, 2e5
    line = StripLine(
        np.full(points, length / points),
        np.full(points, 100.0),
        np.zeros(points),
        *STEEL,
        depth=(np.full(points, depth),) * 2,
    )
    problem = ToothContact(np.zeros((points, points)), np.zeros(points), (line,))
    found = solve_contact(problem, q * length)
    width = float(half_width(q, 100.0, E_STAR))
    closed = 2.0 * float(compression(q, width, depth, 206e9, 0.3))
    assert found.approach == pytest.approx(closed, rel=1e-2)
    assert found.force.sum() == pytest.approx(q * length, rel=1e-14)


@given(st.integers(0, 10_000), st.floats(-3.0, 5.0))
@settings(max_examples=examples(20, 40))
def test_every_load_is_certified(seed, exponent):
    """From a thousandth of a newton up, the certificate passes by orders of magnitude."""
    problem, load = uneven(seed), 10.0**exponent
    found = solve_contact(problem, load)
    again = certify_contact(problem, load, found.force, found.approach)
    assert again.worst < 1e-11
    assert found.force.sum() == pytest.approx(load, rel=1e-13)
    assert np.all(found.force >= 0.0)
    assert np.all(found.distance >= -1e-13 * found.approach)


@given(st.integers(0, 10_000))
@settings(max_examples=15)
def test_more_load_more_approach_and_the_tangent_is_the_slope(seed):
    problem = uneven(seed)
    low, high = (solve_contact(problem, 2000.0 * (1.0 + e)) for e in (-1e-5, 1e-5))
    middle = solve_contact(problem, 2000.0)
    assert low.approach < middle.approach < high.approach
    slope = (high.approach - low.approach) / (2000.0 * 2e-5)
    # A point that opens or closes within the step may change the slope slightly.
    assert middle.tangent == pytest.approx(slope, rel=1e-3)


def test_contacts_solved_together_are_those_solved_alone():
    """Compliances, lines and loads are unequal; tolerance: round-off of one solution."""
    problems, loads = [uneven(1), crowned(48, 3e-3, 1 / RADIUS, 0.3 / RADIUS)], [900.0, 200.0]
    batch = ContactBatch(problems)
    for problem, load, found in zip(
        problems, loads, solve_contacts(batch, np.array(loads)), strict=True
    ):
        alone = solve_contact(problem, load)
        np.testing.assert_allclose(found.force, alone.force, atol=1e-11 * load)
        assert found.approach == pytest.approx(alone.approach, rel=1e-12)
        assert found.tangent == pytest.approx(alone.tangent, rel=1e-10)
        assert certify_contact(problem, load, found.force, found.approach).passed


def test_a_refused_contact_of_several_is_named(monkeypatch):
    problems = [replace(uneven(k), name=f"phase {k}") for k in (1, 2)]
    with pytest.raises(ValueError, match="load = 0"):
        solve_contacts(ContactBatch(problems), np.array([900.0, 0.0]))
    monkeypatch.setattr(contact_programme, "TEETH", TEETH._replace(passes=1))
    with pytest.raises(Refused, match=r"^phase 1: the contact under 900 N did not converge"):
        solve_contacts(ContactBatch(problems), np.array([900.0, 800.0]))


def test_a_compliance_that_is_no_number_is_refused():
    problem = uneven(1)
    with pytest.raises(Refused, match="singular or not a number"):
        solve_contact(replace(problem, bulk=np.full_like(problem.bulk, np.nan)), 900.0)


def test_a_warm_start_does_not_change_the_answer():
    problem = uneven(7)
    cold = solve_contact(problem, 900.0)
    warm = solve_contact(problem, 900.0, warm=solve_contact(problem, 20.0).force)
    np.testing.assert_allclose(warm.force, cold.force, atol=1e-11 * 900.0)
    assert warm.approach == pytest.approx(cold.approach, rel=1e-12)


@pytest.mark.parametrize("solver", SOLVERS)
def test_back_ends_exchange_and_nnls_agree(solver):
    """At fixed widths the contact is one quadratic programme, whoever solves it."""
    problem = uneven(3)
    force = np.full(48, 1500.0 / 48)
    secant = problem.compliance(force)[0]
    even = 0.5 * (secant + secant.T)
    ours = exchange(even, problem.gap, 1500.0, np.ones(48, dtype=bool))
    theirs = by_interface(even, problem.gap, 1500.0, force, backend(solver))
    np.testing.assert_allclose(theirs, ours, atol=1e-9 * 1500.0)
    # NNLS with the load as a heavy row: the weight 1e5 gives an error of its inverse square.
    root = np.linalg.cholesky(even / even.max())
    gap = np.linalg.solve(root, problem.gap / even.max())
    rows = np.vstack([root.T, np.full((1, 48), 1e5)])
    other, _ = nnls(rows, np.append(-gap, 1e5 * 1500.0))
    np.testing.assert_allclose(other, ours, atol=1e-5 * 1500.0)


@pytest.mark.parametrize("solver", SOLVERS)
def test_an_exchange_that_goes_in_a_circle_is_reported(solver):
    """It closes and opens the same points of this definite matrix endlessly; a solver does not."""
    matrix = np.array(
        [[91.5, 21, -25, 81], [21, 34.5, 28, 11], [-25, 28, 50.5, -31], [81, 11, -31, 75.5]]
    )
    gap, every = np.array([38.0, 9.0, 4.0, 34.0]), np.ones(4, dtype=bool)
    assert exchange(matrix, gap, 1.0, every) is None
    assert every.all()
    force = by_interface(matrix, gap, 1.0, np.full(4, 0.25), backend(solver))
    distance = matrix @ force + gap
    approach = distance @ force
    assert force.sum() == pytest.approx(1.0, rel=1e-12)
    assert np.all(force >= 0.0)
    np.testing.assert_allclose(distance[force > 0.0], approach, rtol=1e-9)
    assert np.all(distance > approach * (1.0 - 1e-9))


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_solver_interface_takes_over_from_the_exchange(monkeypatch, solver):
    """A back-end solves every programme of the contact: the same answer, as well converged."""
    problem = uneven(9)
    ours = solve_contact(problem, 700.0)
    monkeypatch.setattr(contact_programme, "TEETH", TEETH._replace(exchanges=0))
    theirs = solve_contact(problem, 700.0, solver=solver)
    np.testing.assert_allclose(theirs.force, ours.force, atol=1e-10 * 700.0)
    assert theirs.approach == pytest.approx(ours.approach, rel=1e-11)


def test_scaling_of_units():
    """Half the modulus and twice the curvature leave the widths unchanged and double every
    compliance; with twice the gaps, the same forces give twice the approach.
    """
    one = uneven(11)
    soft = tuple(
        replace(line, curvature=2.0 * line.curvature, modulus=(103e9, 103e9)) for line in one.lines
    )
    other = ToothContact(2.0 * one.bulk, 2.0 * one.gap, soft)
    a, b = solve_contact(one, 700.0), solve_contact(other, 700.0)
    np.testing.assert_allclose(b.force, a.force, atol=1e-10 * 700.0)
    assert b.approach == pytest.approx(2.0 * a.approach, rel=1e-11)


def test_wrong_answers_fail_the_certificate():
    problem = uneven(5)
    good = solve_contact(problem, 500.0)
    force, approach = good.force, good.approach
    open_point = int(np.flatnonzero(force == 0.0)[0])
    closed_point = int(np.argmax(force))
    moved = force.copy()
    moved[open_point], moved[closed_point] = 1e-3, force[closed_point] - 1e-3
    pulled = force.copy()
    pulled[open_point], pulled[closed_point] = -1e-3, force[closed_point] + 1e-3
    wrong = {
        "complementarity": (moved, approach),
        "pull": (pulled, approach),
        "balance": (1.0001 * force, approach),
        "penetration": (force, 1.001 * approach),
    }
    assert certify_contact(problem, 500.0, force, approach).passed
    for name, (p, z) in wrong.items():
        verdict = certify_contact(problem, 500.0, p, z)
        assert name in verdict.failing
    assert not certify_contact(problem, 500.0, np.full_like(force, np.nan), approach).passed


def test_what_does_not_pass_is_refused(monkeypatch):
    problem = uneven(5)
    # Any forces count as converged.
    monkeypatch.setattr(contact_programme, "TEETH", TEETH._replace(settled=1.0))
    with pytest.raises(Refused, match="does not pass its certificate") as refusal:
        solve_contact(problem, 500.0)
    assert "complementarity" in refusal.value.figures


def test_a_load_that_does_not_press_is_an_error():
    with pytest.raises(ValueError, match="allowed: above 0 N"):
        solve_contact(uneven(1), 0.0)
