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
