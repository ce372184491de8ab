"""The forms of a programme, solved by others, give the certified equilibrium again."""

from itertools import product

import clarabel
import numpy as np
import osqp
import pytest
from scipy.sparse import triu

import loadshare as ls
from loadshare.contact.backends.clarabel_ import cones_of
from loadshare.contact.forms import ComplementarityForm
from loadshare.contact.programme import Point

SPLIT = "cases/branches/split_torque_2.toml"
RING = "cases/fgfbstts/limit_ring.toml"
EVERY = "cases/fgfbstts/all_elements.toml"


def same(formulation, answer) -> None:
    true = formulation.answer.equilibrium
    for name, force in true.flank_force.items():
        scale = max(true.flank_force.values())
        assert answer.equilibrium.flank_force[name] == pytest.approx(force, abs=1e-11 * scale)
    assert answer.certificate.passed


def forced(form: ComplementarityForm) -> np.ndarray:
    """Solve a small complementarity problem by trying every set of contacts."""
    size = len(form.vector)
    for acting in product([True, False], repeat=size):
        on = np.flatnonzero(acting)
        z = np.zeros(size)
        block = form.matrix[np.ix_(on, on)]
        z[on] = -np.linalg.lstsq(block, form.vector[on], rcond=None)[0]
        w = form.matrix @ z + form.vector
        if (z >= -1e-9).all() and (w >= -1e-9).all() and abs(w[on]).max(initial=0.0) < 1e-9:
            return z
    raise AssertionError("no set of contacts fits")


@pytest.mark.parametrize("reduce", [True, False])
def test_a_qp_by_osqp(reduce: bool) -> None:
    formulation = ls.formulate(SPLIT, reduce=reduce)
    form = formulation.qp()
    solver = osqp.OSQP()
    solver.setup(
        form.quadratic, form.linear, form.matrix, form.lower, form.upper, verbose=False,
        eps_abs=1e-7, eps_rel=1e-7, max_iter=200_000,
    )  # fmt: skip
    answer = solver.solve(raise_error=False)
    assert len(form.variables) == len(form.linear)
    assert len(form.rows) == len(formulation.programme.names)
    same(formulation, formulation.read(form.point(answer.x, answer.y)))


def test_a_complementarity_problem_by_trying_every_set() -> None:
    formulation = ls.formulate(SPLIT)
    form = formulation.lcp()
    assert len(form.unknowns) == len(form.vector)
    assert np.linalg.eigvalsh(form.matrix + form.matrix.T)[0] > -1e-12
    same(formulation, formulation.read(form.point(forced(form))))


@pytest.mark.parametrize("exact_hertz", [False, True])
def test_cones_by_clarabel(exact_hertz: bool) -> None:
    formulation = ls.formulate(RING, 2, exact_hertz=exact_hertz)
    form = formulation.conic()
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    answer = clarabel.DefaultSolver(
        triu(form.quadratic, format="csc"),
        form.linear,
        form.matrix,
        form.bounds,
        cones_of(form),
        settings,
    ).solve()
    same(formulation, formulation.read(form.point(np.array(answer.x), np.array(answer.z))))


def test_a_loose_gear_whose_flanks_have_hertz_laws() -> None:
    """It may be anywhere within its play, except where an unloaded flank would overlap."""
    law = {"b": "5e-7 rad/(N*m)", "c": "2e-7 rad/(N*m)^(2/3)"}
    gears = {
        "g1": {"base_radius": "50 mm", "support": "free", "centre": ["0 mm", "0 mm"]},
        "g2": {"base_radius": "50 mm", "support": "300 N/um", "centre": ["0 mm", "0 mm"]},
        "h1": {"base_radius": "90 mm", "support": "300 N/um", "centre": ["149 mm", "0 mm"]},
        "h2": {"base_radius": "90 mm", "support": "18 N/um", "centre": ["149 mm", "0 mm"]},
    }
    meshes = {
        "g1-h1": {"driver": "g1", "driven": "h1", "backlash": "0.26 mm", "law": law},
        "g2-h2": {"driver": "g2", "driven": "h2", "backlash": "0.12 mm", "law": law},
    }
    shafts = {
        "in": {"ends": ["g1", "g2"], "stiffness": "12000 N*m/rad", "clocking": "-0.012 rad"},
        "out": {"ends": ["h1", "h2"], "stiffness": "rigid"},
    }
    operating = {"input": "g1", "output": "h2", "torque": "-1.8 N*m"}
    case = ls.Case({"operating": operating, "gears": gears, "meshes": meshes, "shafts": shafts})
    formulation = ls.formulate(case)
    written = formulation.cvxpy()
    written.problem.solve(solver="CLARABEL")
    read = formulation.read(written.point())
    expected = ls.solve(case).positions[0].torque
    assert read.equilibrium.flank_force["g2-h2 coast"] * 0.05 == pytest.approx(1.8, rel=1e-12)
    assert expected["g2-h2"] == pytest.approx(-1.8, rel=1e-12)


def test_cvxpy() -> None:
    formulation = ls.formulate(RING)
    form = formulation.cvxpy()
    form.problem.solve(solver="CLARABEL")
    same(formulation, formulation.read(form.point()))


def test_what_is_left_out_is_named_with_its_reason() -> None:
    lean, whole = ls.formulate(EVERY), ls.formulate(EVERY, reduce=False)
    left = dict(lean.removed)
    assert set(whole.programme.names) > set(lean.programme.names)
    for name in set(whole.programme.names) - set(lean.programme.names):
        assert left[name]


def test_no_qp_of_a_spline() -> None:
    with pytest.raises(ValueError, match=r"spline .* second-order cones"):
        ls.formulate(EVERY, reduce=False).qp()


def test_answers_that_do_not_belong_to_the_programme_are_named() -> None:
    formulation = ls.formulate(SPLIT, reduce=False)
    with pytest.raises(TypeError, match=r"a point .* is needed, not int"):
        formulation.read(5)
    with pytest.raises(ValueError, match=r"x: an array .* of shape \(5,\) .*, not shape \(4,\)"):
        formulation.read(Point(np.zeros(4), np.zeros(5), np.zeros((0, 2))))
    for wrong in (np.nan, np.inf):
        with pytest.raises(ValueError, match="forces: contains a number that is not finite"):
            formulation.read(Point(np.zeros(5), np.full(5, wrong), np.zeros((0, 2))))
        with pytest.raises(ValueError, match="z: contains a number that is not finite"):
            formulation.lcp().point(np.full(len(formulation.lcp().vector), wrong))
    with pytest.raises(ValueError, match=r"z: an array of numbers .* is needed, not None"):
        formulation.qp().point(None, None)
    with pytest.raises(ValueError, match=r"z: an array of numbers .* is needed, not 'a'"):
        formulation.lcp().point("a")
    with pytest.raises(ValueError, match="no answer to read: not solved yet"):
        formulation.cvxpy().point()
