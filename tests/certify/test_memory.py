"""The certificate of marches, whose splines remember their slip, against the oracle.

Source: formulation, sections 5 and 8.
"""

from functools import cache

import numpy as np
import pytest
from tests.certify.test_many import agree, alike, damaged, residuals, scales_of, taken
from tests.support import mostly_slow, shipped

from loadshare.certify import RESIDUALS, certify
from loadshare.errors import Refused
from loadshare.settings import CERTIFY
from loadshare.study.memory.step import stepped
from loadshare.train import Train, build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.memory import slip_of
from loadshare.train.situations import situation_of

TURN = {"march": {"gear": "4", "revolutions": 1.0, "steps": 8}}
MARCHES = {
    "slips": ("fgfbstts/full_float", TURN),
    "ends of clearances": ("fgfbstts/spline_clearance", TURN),
    "rings and shafts": ("fgfbstts/all_elements", {"march.steps": 3}),
}


@cache
def second_step(name: str) -> tuple[Train, Equilibrium]:
    """Return the second step of a march, which starts from a slip, and its train."""
    case, changes = MARCHES[name]
    train = build_train(shipped(case).replace(changes))
    first = train.remembering({g: np.zeros(3) for g in train.splines})
    found = stepped(first, 1).equilibrium
    train = train.remembering({g: slip_of(s, found) for g, s in train.splines.items()})
    return train, stepped(train, 2).equilibrium


@pytest.mark.parametrize("name", mostly_slow(MARCHES, ("slips",)))
def test_steps_of_a_march(name):
    """The right answer, and sixteen with one to three damaged figures."""
    train, found = second_step(name)
    situations, claimed = situation_of(train, 2), Equilibria.of(train, found)
    agree(train, [2], situations, claimed)
    certificate = certify(train, found)
    assert certificate.passed
    rows = np.zeros(16, dtype=int)
    scales = scales_of(train, certificate.load, certificate.deflection)
    wrong = damaged(taken(claimed, rows), scales, seed=len(name))
    agree(train, [2] * len(rows), situations, wrong)
    many = alike(train, situations, wrong)
    assert not many.passed.all()
    figures = residuals(train, situations, wrong)
    for residual in ("force_balance", "penetration", "cone_membership", "energy_gap"):
        assert (figures[:, RESIDUALS.index(residual)] > CERTIFY.tolerance).any(), residual


def test_a_law_that_jumps_is_refused():
    """Friction with memory has no step at the onset of slip."""
    train, found = second_step("slips")
    jumping = build_train(
        shipped("fgfbstts/full_float").replace({**TURN, "splines.4.stick_limit": "1 um"})
    ).remembering(train.slip)
    with pytest.raises(Refused, match="leave stick_limit out"):
        stepped(jumping, 2)
    certificate = certify(jumping, found)
    assert {"leave stick_limit out" in r.where for r in certificate.residuals.values()} == {True}
    assert not certificate.passed
