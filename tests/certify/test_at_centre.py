"""Claims that leave a gear at the centre of what holds it, though a small force would move it.

A claim that is off by more than rounding must have a bound that says so, also where an element
carries nothing at all, and so has no direction. The claim is the equilibrium with the sun held
rigidly; the true one differs from it because one gap is slightly wider. Source: formulation,
section 16.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import loadshare as ls
from benchmarks import families
from loadshare.certify import Judge
from loadshare.certify.bound import Columns, bounds
from loadshare.certify.bound.batch import judged
from loadshare.job.machine import Machine
from loadshare.settings import CERTIFY
from loadshare.solver.hot import vectorised
from loadshare.train import Train, build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations

SOFT = "2e5 N/m"
HOLDS: dict[str, dict[str, Any]] = {
    "spline that sticks": {
        "splines": {
            "bending_stiffness": SOFT,
            "clearance": "100 um",
            "stick_limit": "50 um",
            "friction_force": "10 N",
        }
    },
    "spline that never slips": {
        "splines": {
            "bending_stiffness": SOFT,
            "clearance": "0 um",
            "friction": 0.1,
            "normal_force": "66 N",
        }
    },
    "spline without clearance": {
        "splines": {"bending_stiffness": SOFT, "clearance": "0 um", "friction_force": "0 N"}
    },
    "ring": {"rings": {"radius": "0 um", "stiffness": SOFT}},
    "bearing": {"bearings": {"clearance": "0 um", "stiffness": SOFT}},
    "ball bearing": {"bearings": {"clearance": "0 um", "ball_stiffness": "2e9 N/m^1.5"}},
    "roller bearing": {"bearings": {"clearance": "0 um", "roller_stiffness": "1e7 N/m^(10/9)"}},
}
ROUNDING = 1e-15


def star(gap: float, held_by: dict[str, Any] | None, floating: bool) -> ls.Case:
    """Return a star of three; its planets may float on stiff splines, too."""
    data = families.star(3).to_dict()
    del data["meshes"]["sun-planet1"]["gap"]
    data["meshes"]["sun-planet2"]["gap"] = f"{gap!r} rad"
    data["gears"]["sun"]["support"] = "rigid" if held_by is None else "free"
    for section, element in (held_by or {}).items():
        data[section] = {"sun": element}
    if floating:
        stiff = {"bending_stiffness": "1e9 N/m", "clearance": "0 um", "friction_force": "0 N"}
        planets = {f"planet{k}": stiff for k in (1, 2, 3)}
        data["splines"] = planets | data.get("splines", {})
        for planet in planets:
            data["gears"][planet]["support"] = "free"
    return ls.Case(data | {"assumed": []})


def solved(case: ls.Case) -> tuple[Train, Situations, Equilibria]:
    train = build_train(case)
    machine = Machine(train)
    situations = machine.situations([1])
    found = machine.answer(situations, CERTIFY.tolerance, vectorised.settle)
    assert found.passed.all()
    return train, situations, found.equilibria


@pytest.mark.parametrize("floating", [False, True])
@pytest.mark.parametrize("gap", [1e-13, 1e-12])
@pytest.mark.parametrize("held_by", HOLDS)
def test_the_bound_contains_the_error(held_by, gap, floating):
    train, situations, exact = solved(star(gap, HOLDS[held_by], floating))
    _, _, rigid = solved(star(gap, None, floating))
    order = list(train.gears).index("sun")
    assert exact.displacement[0, order].any()
    assert not rigid.displacement[0, order].any()
    reaction = np.zeros_like(exact.radial_reaction)
    others = rigid.radial_reaction.shape[1]
    if others:
        # Rings and bearings come before splines, and the planets' splines before the sun's.
        first = 0 if "splines" in HOLDS[held_by] else 1
        reaction[:, first : first + others] = rigid.radial_reaction
    claim = replace(
        exact,
        radial_reaction=reaction,
        **{
            name: getattr(rigid, name)
            for name in ("flank_force", "rotation", "displacement", "shaft_torque")
        },
    )
    assert (Judge(train).judge(situations, claim).worst < CERTIFY.tolerance).all()
    columns = Columns(train)
    wrong = np.abs(claim.flank_force - exact.flank_force) * columns.arms
    error = wrong.max() / np.abs(situations.torque).max()
    assert error > 1e3 * ROUNDING
    least = error - ROUNDING
    for rigorous in (False, True):
        assert bounds(columns, situations, claim, rigorous=rigorous).relative[0] >= least
    assert judged(columns, situations, claim)[1][0] >= least


def planetary(count: int, torque: str) -> ls.Case:
    """Return a set that is alike all round, with sun and ring in roller bearings without play."""
    planets = {f"p{k + 1}": f"{360.0 * k / count} deg" for k in range(count)}
    fixed = {"centre": ["0 mm", "0 mm"], "support": "free"}
    gears = {
        "sun": {"base_radius": "50.743402 mm", **fixed},
        "ring": {"base_radius": "118.40127 mm", "type": "internal", "held": True, **fixed},
        "carrier": {"type": "carrier", **fixed, "support": ["4e6 N/m", "1e8 N/m"]},
    }
    for planet, angle in planets.items():
        gears[planet] = {
            "base_radius": "33.828934 mm",
            "centre": {"distance": "90 mm", "angle": angle},
            "carrier": "carrier",
            "support": "free",
        }
    law = {"b": "9e-7 rad/(N*m)", "c": "8e-7 rad/(N*m)^(2/3)"}
    inner = {f"sun-{planet}": {"stiffness": "7e6 N*m/rad"} for planet in planets}
    outer = {f"{planet}-ring": {"law": law} for planet in planets}
    meshes = {name: {"pressure_angle": "20 deg", **mesh} for name, mesh in (inner | outer).items()}
    bearings = {planet: {"clearance": "10 um", "stiffness": "8e8 N/m"} for planet in planets}
    for gear, stiffness in (("sun", "4e9 N/m^(10/9)"), ("ring", "3e10 N/m^(10/9)")):
        bearings[gear] = {"clearance": "0 um", "roller_stiffness": stiffness}
    operating = {"input": "sun", "output": "carrier", "torque": torque}
    return ls.Case(
        {"operating": operating, "gears": gears, "meshes": meshes, "bearings": bearings}
        | {"assumed": []}
    )


@pytest.mark.parametrize("torque", ["600 N*m", "3000 N*m"])
@pytest.mark.parametrize("count", [3, 4, 5])
def test_sets_that_are_alike_all_round_are_proved(count, torque):
    """Rounding alone decides where their members rest."""
    position = ls.solve(planetary(count, torque)).positions[0]
    assert position.certificate.proved < 1e-12
    shares = [position.torque[f"sun-p{k + 1}"] for k in range(count)]
    np.testing.assert_allclose(shares, float(torque.split()[0]) / count, rtol=1e-12)
