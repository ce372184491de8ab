"""Valid requests: a tolerance that certifies something, and positions that exist."""

import math
from fractions import Fraction

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.certify import certify
from loadshare.certify.tolerance import checked_tolerance
from loadshare.job import explain
from loadshare.job.many import solve_blocks
from loadshare.settings import CERTIFY
from loadshare.train import build_train

NO_TOLERANCE = (
    -1.0,
    0.0,
    1e300,
    math.inf,
    math.nan,
    1.001 * CERTIFY.largest,
    True,
    "1e-9",
    None,
)
SAMPLES = {"rings.4.float [um]": [4.0]}


@pytest.mark.parametrize("tolerance", NO_TOLERANCE, ids=repr)
@pytest.mark.parametrize(
    "ask",
    [
        lambda case, t: ls.solve(case, tolerance=t),
        lambda case, t: explain(case, tolerance=t),
        lambda case, t: ls.solve_many(case, SAMPLES, tolerance=t),
        lambda case, t: next(solve_blocks(case, SAMPLES, tolerance=t)),
        lambda case, t: certify(build_train(case), explain(case).equilibrium, t),
    ],
    ids=["solve", "explain", "solve_many", "solve_blocks", "certify"],
)
def test_a_tolerance_that_certifies_nothing_is_refused(ask, tolerance):
    with pytest.raises(ValueError, match=r"allowed: a number above 0 and up to 0\.001"):
        ask(shipped("fgfbstts/limit_ring"), tolerance)


@pytest.mark.parametrize("given", [10**400, Fraction(1, 10**400)], ids=["large", "small"])
def test_a_tolerance_that_no_double_holds_is_none(given):
    with pytest.raises(ValueError, match="cannot be used for a certificate"):
        checked_tolerance(given)


def test_any_other_tolerance_is_taken():
    assert checked_tolerance(CERTIFY.largest) == CERTIFY.largest
    assert checked_tolerance(np.float64(1e-12)) == 1e-12
    result = ls.solve(shipped("fgfbstts/base"), positions=[1], tolerance=1e-8)
    assert result.stamp.tolerance == 1e-8


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        ([0], "positions 0: this case has positions 1 to 5"),
        ([1.0], r"positions 1\.0: this"),
        ([True], "positions True: this"),
        (["1"], "positions '1': this"),
        ([None], "positions None: this"),
        ([], "positions none given: this"),
        ("12", "positions '12': not a list"),
        (3, "positions 3: not a list"),
        ([2, 1, 2], "positions 2: given more than once"),
    ],
)
def test_positions_that_are_none_are_refused(positions, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        ls.solve(shipped("fgfbstts/limit_ring"), positions=positions)
    with pytest.raises(ValueError, match=f"^{message}"):
        ls.solve_many(shipped("fgfbstts/limit_ring"), SAMPLES, positions=positions)


@pytest.mark.parametrize("position", [0, 9, 1.0, True, "1", None], ids=repr)
def test_a_search_refuses_a_position_that_is_none(position):
    with pytest.raises(
        ValueError, match=f"^positions {position!r}: this case has positions 1 to 5"
    ):
        ls.search(shipped("fgfbstts/limit_ring"), position)


def test_a_search_takes_a_position_out_of_an_array():
    found = ls.search(shipped("two_path/clocking_error"), np.arange(1, 2)[0])
    assert type(found.answer.index) is int


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"solver": "gurobi"}, "unknown solver 'gurobi'; allowed: auto, clarabel, osqp, cvxpy"),
        ({"solver": None}, "unknown solver None; allowed: auto"),
        ({"method": "secant"}, "unknown method 'secant'; allowed: newton"),
        ({"engine": None}, "unknown engine None; allowed: auto, compiled, vectorised"),
        ({"engine": "fast", "solver": "osqp"}, "unknown engine 'fast'"),
    ],
    ids=str,
)
def test_a_way_that_is_none_is_refused(settings, message):
    with pytest.raises(ValueError, match=message):
        ls.solve(shipped("fgfbstts/base"), **settings)


def test_positions_keep_their_order_and_become_plain_numbers():
    result = ls.solve(shipped("fgfbstts/base"), positions=np.array([3, 1]))
    assert [p.position for p in result.positions] == [3, 1]
    assert all(type(p.position) is int for p in result.positions)
