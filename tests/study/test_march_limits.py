"""Marches at the limits: no room beyond friction, almost none, and almost no friction.

Source: formulation, section 5. A clearance of F_m/K_w leaves no room for slip, so the spline is the
spring K_w; without friction it is the holonomic one.
"""

import numpy as np
import pytest
from tests.study.test_march import both, floating
from tests.support import mostly_slow

import loadshare as ls

KW = 1.78e7


def spline(friction: float, clearance: float, **more: object) -> ls.Case:
    """Return the seed's full float with fixed friction [N] and clearance [m] of both splines."""
    gone = both("normal_force", None) | both("friction", None)
    given = both("friction_force", f"{friction!r} N") | both("clearance", f"{clearance!r} m")
    return floating(assumed=["errors.*"], **gone, **given, **more)


@pytest.mark.parametrize("friction", [1e-6, 1.0, 50.0, 500.0])
def test_a_clearance_that_friction_needs_leaves_a_spring(friction):
    found = ls.march(spline(friction, friction / KW))
    springs = {f"gears.{g}.support": f"{KW!r} N/m" for g in "45"}
    alone = ls.solve(floating(splines=None, assumed=["errors.*"], **springs))
    assert found.result.passed
    assert found.dissipated == 0.0
    for here, there in zip(found.result.positions, alone.positions, strict=True):
        assert here.torque == pytest.approx(there.torque, rel=1e-9)


ROOMS = [(f, r) for f in (1e-6, 1.0, 500.0) for r in (1e-13, 1e-11, 1e-10, 1e-9)]


@pytest.mark.parametrize(("friction", "room"), mostly_slow(ROOMS, ((1.0, 1e-13),)))
def test_next_to_no_room_is_next_to_a_spring(friction, room):
    """A slip with so little room changes a displacement by no more than that."""
    found = ls.march(spline(friction, friction / KW + room))
    without = ls.march(spline(friction, friction / KW))
    assert found.result.passed
    for here, there in zip(found.result.positions, without.result.positions, strict=True):
        for gear in "45":
            apart = np.subtract(here.displacement[gear], there.displacement[gear])
            assert np.abs(apart).max() <= 2.0 * room + 1e-15


@pytest.mark.parametrize(
    ("clearance", "steps"),
    mostly_slow([(1e-5, 2), (1e-5, 8), (1.19e-4, 8), (4e-4, 8)], ((1e-5, 2),)),
)
def test_friction_of_a_millionth_of_a_newton(clearance, steps):
    few = {"march.steps": steps}
    found = ls.march(spline(1e-6, clearance, **few))
    without = ls.march(spline(0.0, clearance, **few))
    assert found.result.passed
    for here, there in zip(found.result.positions, without.result.positions, strict=True):
        assert here.torque == pytest.approx(there.torque, rel=1e-9)
    path = sum(
        float(np.linalg.norm(after[g].slip - before[g].slip))
        for before, after in zip(found.slips, found.slips[1:], strict=False)
        for g in after
    )
    first = sum(float(np.linalg.norm(s.slip)) for s in found.slips[0].values())
    assert found.dissipated == pytest.approx(1e-6 * (first + path), rel=1e-6)
