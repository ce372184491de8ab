"""The outer loop: it converges as theory predicts, also at light load, or refuses.

Source: formulation, sections 3 and 7.
"""

from itertools import pairwise

import pytest
from tests.support import answer, driver_torques, furthest, loaded, shipped

import loadshare as ls
from benchmarks import families
from loadshare.certify import certify
from loadshare.solver import Options
from loadshare.train import build_train


def hertzian(torque: str = "1000 N*m", gap: str = "0.4 mrad") -> ls.Case:
    """Return a star of four whose meshes all have b + c laws."""
    law = {"b": "5e-7 rad/(N*m)", "c": "6e-6 rad/(N*m)^(2/3)"}
    case = families.star(4)
    changes = {f'meshes."{m}".stiffness': None for m in case.meshes}
    changes |= {f'meshes."{m}".law': law for m in case.meshes}
    changes |= {"meshes.sun-planet1.gap": None, "operating.torque": torque}
    return case.replace({**changes, "meshes.sun-planet1.law": {**law, "a": gap}})


def test_newton_is_quadratic_and_picard_linear():
    """Near the answer, every Newton pass doubles the digits; Picard gains a constant factor."""
    train = build_train(hertzian())
    newton = [i.law for i in answer(train)[1].iterations]
    assert len(newton) <= 8
    squares = [b / a**2 for a, b in pairwise(newton[:-1]) if a < 0.1]
    assert squares
    assert max(squares) < 10.0
    picard = [i.law for i in answer(train, method="picard")[1].iterations]
    factors = [b / a for a, b in pairwise(picard[2:-1])]
    assert max(factors) < 0.6
    assert len(picard) > 2 * len(newton)


@pytest.mark.parametrize("method", ["newton", "picard"])
@pytest.mark.parametrize("torque", [1e-6, 1e-3, 1.0, 1000.0])
def test_light_load_converges(torque, method):
    """Without gaps, the tangent compliance grows without bound as the load vanishes; equal meshes
    still share equally.
    """
    case = hertzian(f"{torque!r} N*m", gap="0 rad")
    train = build_train(case)
    found, _ = answer(train, method=method)
    assert certify(train, found).passed
    torques = driver_torques(case, method=method)
    for mesh in case.stages["I"].meshes:
        assert torques[mesh] == pytest.approx(torque / 4, rel=1e-9)


@pytest.mark.parametrize(("shaft", "stage"), [("5e5 N*m/rad", "slip"), ("rigid", "stick")])
@pytest.mark.parametrize("method", ["newton", "picard", "power"])
def test_friction_that_follows_the_torque_settles(method, shaft, stage):
    """F_m = τ T/radius holds at the torque of the answer, whatever shaft transmits it."""
    spline = {
        "bending_stiffness": "1.78e7 N/m",
        "clearance": "100 um",
        "friction": 0.1,
        "radius": "5 m",
    }
    changes = {"splines": {"4": spline}, "shafts.2-4.stiffness": shaft}
    train = build_train(shipped("fgfbstts/both_errors").replace(changes))
    found, _ = answer(train, method=method)
    certificate = certify(train, found)
    assert certificate.passed
    torque = 0.0459 * (found.flank_force["4-6"] + found.flank_force["4-7"])
    assert certificate.floats["4"].friction == pytest.approx(0.1 * torque / 5.0, rel=1e-9)
    assert certificate.floats["4"].spline == stage


def test_a_spline_that_would_drop_under_its_torque_is_refused():
    """K_w S1 exceeds F_m at the torque carried, which no check of the case can know."""
    spline = {
        "bending_stiffness": "1.78e7 N/m", "clearance": "100 um", "stick_limit": "50 um",
        "friction": 0.1, "radius": "5 m",
    }  # fmt: skip
    case = shipped("fgfbstts/both_errors").replace({"splines": {"4": spline}})
    with pytest.raises(ls.Refused, match="would drop from K_w S1 = 890 N to F_m = "):
        ls.solve(case, positions=[1])


def test_a_train_that_nothing_holds_is_refused_by_name():
    """Idlers that all float freely between pinions and output are pushed out sideways."""
    case = shipped("fgfbstts/base").replace({f"gears.{g}.support": "free" for g in "6789"})
    with pytest.raises(ls.Refused, match=r"position 1: .*limits the float of gear 6, 7, 8, 9"):
        ls.solve(case, positions=[1])


def test_positions_that_fail_do_not_take_the_others_with_them():
    """Only the force of the spline at the large torque of position 2 would drop."""
    spline = {
        "bending_stiffness": "1.78e7 N/m", "clearance": "100 um", "stick_limit": "5 um",
        "friction": 0.1, "radius": "5 m",
    }  # fmt: skip
    case = loaded(shipped("fgfbstts/base"), "2000 N*m").replace(
        {
            "operating.torque": ["1000 N*m", "2000 N*m"],
            "operating.positions": 2,
            "splines": {"4": spline},
        }
    )
    with pytest.raises(ls.Refused) as refused:
        ls.solve(case)
    assert [p.position for p in refused.value.partial.positions] == [2]
    assert "would drop" in str(refused.value)


def test_no_load_at_all_is_an_equilibrium():
    torques = driver_torques(loaded(shipped("fgfbstts/base"), "0 N*m"))
    assert set(torques.values()) == {0.0}


def test_unknown_solvers_methods_and_positions_are_reported():
    with pytest.raises(ValueError, match="unknown method 'secant'; allowed: newton, picard, power"):
        Options(method="secant")
    with pytest.raises(ValueError, match="unknown solver 'gurobi'; allowed: clarabel, osqp, cvxpy"):
        answer(build_train(shipped("fgfbstts/base")), solver="gurobi")
    with pytest.raises(ValueError, match="positions 9: this case has positions 1 to 5"):
        ls.solve(shipped("fgfbstts/base"), positions=[1, 9])


def test_methods_agree_where_every_mesh_is_nonlinear_and_contact_is_lost():
    case = hertzian("50 N*m")
    one = driver_torques(case)
    assert min(one.values()) == 0.0
    for options in ({"method": "picard"}, {"method": "power"}, {"reduce": False}):
        assert furthest(one, driver_torques(case, **options)) < 1e-9
