"""Every back-end, method and reduction gives the same equilibrium, on every shipped case.

Source: formulation, sections 7 and 11. All forces are compared (over the largest), and all
displacements that the equilibrium determines (over the deflection of the case). The error of the
exact solve on the identified active set is round-off times the condition number of the case, about
1e-12; 1e-9 between back-ends and methods and 1e-10 with and without reduction are required.
"""

from functools import cache

import pytest
from tests.support import EVERY_SHIPPED, answer, disagreement, shipped

from loadshare.certify import certify
from loadshare.errors import Refused
from loadshare.scene import assemble
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium

AGREE = 1e-9
REDUCED = 1e-10
BARE = 1e-5
"""Accuracy of a power-cone solver's own answer (formulation, section 7)."""


@cache
def train_of(case: str) -> Train:
    return build_train(shipped(case))


@cache
def reference(case: str, index: int) -> Equilibrium:
    return answer(train_of(case), index)[0]


def ends(case: str) -> list[int]:
    """Return the first and last position, and every position of a short case."""
    count = train_of(case).count
    return list(range(1, count + 1)) if count <= 5 else [1, count]


def agrees(case: str, index: int, tolerance: float, **options: object) -> None:
    train, expected = train_of(case), reference(case, index)
    found, _ = answer(train, index, **options)
    assert certify(train, found).passed
    assert max(disagreement(train, expected, found)) < tolerance, index


@pytest.mark.parametrize("case", EVERY_SHIPPED)
@pytest.mark.quick(4)
def test_the_reference_itself_is_certified(case):
    for index in ends(case):
        assert certify(train_of(case), reference(case, index)).passed


@pytest.mark.parametrize("reduce", [True, False], ids=["reduced", "whole"])
@pytest.mark.parametrize("method", ["newton", "picard"])
@pytest.mark.parametrize("solver", ["clarabel", "cvxpy"])
@pytest.mark.parametrize("case", EVERY_SHIPPED)
@pytest.mark.quick(12)
def test_back_ends_and_methods_agree(case, solver, method, reduce):
    for index in ends(case):
        agrees(case, index, AGREE, solver=solver, method=method, reduce=reduce)


@pytest.mark.parametrize("reduce", [True, False], ids=["reduced", "whole"])
@pytest.mark.parametrize("case", EVERY_SHIPPED)
@pytest.mark.quick(4)
def test_the_first_order_method_agrees_or_declines(case, reduce):
    """OSQP solves quadratic programmes; if a cone is in play, it must refuse, not answer."""
    for index in ends(case):
        conic = bool(assemble(train_of(case), index).radials)
        if conic:
            with pytest.raises(Refused, match="does not solve programmes of class SOCP"):
                answer(train_of(case), index, solver="osqp", reduce=reduce)
        else:
            agrees(case, index, AGREE, solver="osqp", reduce=reduce)


@pytest.mark.parametrize("case", EVERY_SHIPPED)
@pytest.mark.quick(12)
def test_reduction_does_not_change_the_answer(case):
    for index in ends(case):
        agrees(case, index, REDUCED, reduce=False)


@pytest.mark.parametrize("case", EVERY_SHIPPED)
@pytest.mark.quick(12)
def test_the_polished_power_cone_agrees(case):
    for index in ends(case):
        agrees(case, index, AGREE, method="power")


@pytest.mark.parametrize("case", [p for p in EVERY_SHIPPED if p.values != ("fgfbstts/tolerance",)])
@pytest.mark.quick(12)
def test_the_bare_power_cone_is_near(case):
    """One programme, without loop or exact solve: an independent check of laws and assembly.

    The tolerance study's nominal case has no errors: its rings are on the verge of contact, where
    an interior-point method is known to give only four digits.
    """
    train = train_of(case)
    for index in ends(case):
        bare, record = answer(train, index, method="power", polish=False, reduce=False)
        if any(not law.is_linear for m in train.meshes.values() for law in m.laws):
            assert record.kind == "power cone"
        assert disagreement(train, reference(case, index), bare)[0] < BARE
