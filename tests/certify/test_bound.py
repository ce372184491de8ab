"""The bound on torques: it holds, it is tight, and balanced but wrong answers do not pass."""

from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import bound_of

import loadshare as ls
from benchmarks.random_trains.judge import NO_TORQUE, judged
from benchmarks.reference import NoReference, reference
from benchmarks.stress.families import FAMILIES
from loadshare.certify import certify
from loadshare.certify.bound import Columns, bounds
from loadshare.certify.bound.statics import Statics, force_at_end
from loadshare.certify.bound.twofold import power_two_thirds, product, two_product, two_sum
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.train import build_train
from loadshare.train.equilibrium import Equilibrium

numbers = st.floats(-1e50, 1e50, allow_subnormal=False).filter(lambda v: abs(v) > 1e-50 or v == 0.0)


@given(numbers, numbers)
def test_sums_and_products_lose_nothing(a: float, b: float) -> None:
    total, part = two_sum(np.array(a), np.array(b)), two_product(np.array(a), np.array(b))
    assert Fraction(float(total.high)) + Fraction(float(total.low)) == Fraction(a) + Fraction(b)
    assert Fraction(float(part.high)) + Fraction(float(part.low)) == Fraction(a) * Fraction(b)


def test_matrix_product_in_twice_the_precision() -> None:
    rng = np.random.default_rng(3)
    a = rng.standard_normal((4, 9)) * 10.0 ** rng.integers(-8, 8, (4, 9))
    b = rng.standard_normal((9, 3))
    b[2] = 0.0
    found, sizes = product(a, b)
    for i in range(4):
        for j in range(3):
            true = sum(
                (
                    Fraction(float(x)) * Fraction(float(y))
                    for x, y in zip(a[i], b[:, j], strict=True)
                ),
                Fraction(0),
            )
            computed = Fraction(float(found.high[i, j])) + Fraction(float(found.low[i, j]))
            assert abs(computed - true) <= Fraction(float(sizes[i, j])) / 2**95


@given(st.floats(1e-30, 1e30))
def test_power_two_thirds(force: float) -> None:
    found = power_two_thirds(np.array([force]))
    with mpmath.workdps(50):
        true = mpmath.cbrt(mpmath.mpf(force)) ** 2
        computed = mpmath.mpf(float(found.high[0])) + mpmath.mpf(float(found.low[0]))
        assert abs(computed / true - 1) < mpmath.mpf(2) ** -95


def problems() -> list[tuple[str, int]]:
    """Return some problems of every family of the stability map that have a unique answer."""
    return [(name, k) for name in FAMILIES if name not in ("impossible", "no-load") for k in (0, 1)]


@pytest.mark.parametrize(("family", "number"), problems())
@pytest.mark.quick(6)
def test_bound_holds_against_fifty_digits(family: str, number: int) -> None:
    problem = list(FAMILIES[family].problems(100))[number]
    train = build_train(problem.case)
    machine = Machine(train)
    found = machine.answer(machine.situations([1]), 1e-9, engine_named("vectorised", 1))
    answer = found.equilibria.one(0, 1)
    if not found.passed[0]:
        pytest.skip("left by the fast method")
    try:
        truth = reference(train, 1, answer)
    except NoReference:
        pytest.skip("no reference")
    if truth.imbalance > 0.0:
        pytest.skip("what balances the load hangs on the rounding of the train's figures")
    for rigorous in (False, True):
        bound = bound_of(train, answer, rigorous)
        assert bound.relative <= 1e-9
        largest = max(abs(t) for t in truth.torque.values())
        with mpmath.workdps(50):
            for name, mesh in train.meshes.items():
                net = sum(
                    (1 if d else -1) * mpmath.mpf(answer.flank_force[mesh.flank_name(d)])
                    for d in mesh.flanks
                )
                error = abs(net * mpmath.mpf(mesh.radii[0]) - mpmath.mpf(truth.exact[name]))
                assert error <= bound.torque[name] + 1e-40 * largest


@pytest.mark.parametrize(
    ("family", "number"),
    [
        # Lines of action that are parallel except for rounding leave the balance of a float to idle
        # flanks.
        ("free-pinion", 33),
        ("light-load", 40),
        # A friction of 1e-9 N is negligible, but not zero.
        ("friction", 93),
        ("friction", 97),
        # Opposed contacts without clearance: either may carry the forces that rounding leaves.
        ("zero-clearance", 12),
        # Supports of 5e-4 N/m press idle planets by 4e-9 N against both gears, which is rounding of
        # loads.
        ("soft-supports", 187),
        ("soft-supports", 188),
    ],
)
@pytest.mark.quick(1)
def test_bounds_hold_of_what_all_but_idles(family: str, number: int) -> None:
    (found,) = judged(FAMILIES[family].problem(number).case)["positions"]
    assert found["outcome"] == "agrees"
    assert [(b, e) for b, e in found["bound"] if e > b and e > NO_TORQUE] == []
    assert found["below"] == {}
    assert max(b for b, _ in found["bound"]) < 1e-8


def idle_set_beside_a_floating_sun() -> ls.Case:
    """Return two sets in a row: of one, two planets leave the sun loose; the other only idles."""
    gears: dict[str, dict[str, object]] = {}
    for k in "12":
        gears |= {
            f"s{k}": {"teeth": 30, "module": "2 mm", "centre": ["0 mm", "0 mm"]},
            f"p{k}": {
                "teeth": 24,
                "module": "2 mm",
                "centre": {"angle": "10 deg"},
                "copies": 4,
                "carrier": f"c{k}",
            },
            f"r{k}": {
                "type": "internal",
                "teeth": 78,
                "module": "2 mm",
                "centre": ["0 mm", "0 mm"],
            },
            f"c{k}": {"type": "carrier", "centre": ["0 mm", "0 mm"]},
        }
    gears["s1"] |= {"support": "free", "held": True}
    stiffness = {"stiffness": "2e6 N*m/rad"}
    return ls.Case(
        {
            "operating": {"input": "r1", "output": "c1", "torque": "200 N*m"},
            "gears": gears,
            "meshes": dict.fromkeys(("s1-p1", "p1-r1", "s2-p2", "p2-r2"), stiffness),
            "shafts": dict.fromkeys(("s1-s2", "c1-r2"), stiffness),
            "errors": {"p11": {"pin": {"tangential": "-30 um"}}},
        },
        name="idle set",
    )


def test_sets_that_idle_beside_a_loose_sun_are_bounded() -> None:
    case = idle_set_beside_a_floating_sun()
    # Two planets carry half of the torque of the held sun each.
    torque = ls.solve(case).positions[0].torque
    assert torque["s1-p11"] == pytest.approx(-200.0 * 30.0 / 78.0 / 2.0, rel=1e-12)
    (found,) = judged(case)["positions"]
    assert found["outcome"] == "agrees"
    assert max(b for b, _ in found["bound"]) < 1e-8
    assert [(b, e) for b, e in found["bound"] if e > b and e > NO_TORQUE] == []


def stiff_split() -> tuple[object, Equilibrium]:
    """Return a soft mesh in series with two branches 1e6 times as stiff, and the equilibrium."""
    base = ls.load_case("cases/branches/split_torque_2.toml")
    data = base.to_dict()
    for mesh in data["meshes"].values():
        for key in ("stiffness", "law", "table"):
            mesh.pop(key, None)
        mesh["stiffness"] = "1e12 N*m/rad"
    for shaft in data.get("shafts", {}).values():
        shaft["stiffness"] = "1e12 N*m/rad"
    first = next(iter(data["meshes"].values()))
    first["stiffness"] = "1e6 N*m/rad"
    train = build_train(ls.Case(data, name="stiff"))
    machine = Machine(train)
    found = machine.answer(machine.situations([1]), 1e-9, engine_named("vectorised", 1))
    return train, found.equilibria.one(0, 1)


@pytest.mark.parametrize("part", [1e-12, 1e-9, 1e-7, 1e-5, 1e-3])
@pytest.mark.parametrize("number", range(4))
def test_self_stress_in_balance_does_not_pass(part: float, number: int) -> None:
    train, answer = stiff_split()
    columns = Columns(train)
    flanks = columns.flanks.stop
    acting = [k for k, n in enumerate(columns.names) if answer.flank_force.get(n, 1.0) != 0.0]
    acting = [k for k in acting if k < columns.bearings.start]
    left, sizes, _ = np.linalg.svd(columns.matrix.high[acting])
    rank = int((sizes > 1e-12 * sizes.max()).sum())
    stress = left[:, rank:] @ np.random.default_rng(number).standard_normal(len(acting) - rank)
    if not stress.size:
        pytest.skip("nothing is redundant")
    load = max(answer.flank_force.values())
    change = dict(zip(acting, part * load * stress / np.abs(stress).max(), strict=True))
    force = {
        n: f + change.get(k, 0.0)
        for k, (n, f) in enumerate(
            zip(columns.names[:flanks], answer.flank_force.values(), strict=True)
        )
    }
    torque = dict(answer.shaft_torque)
    for at in range(columns.shafts.start, columns.shafts.stop):
        name = columns.names[at]
        arm = train.gears[train.shafts[name].first].base_radius
        torque[name] += change.get(at, 0.0) * arm
    wrong = replace(answer, flank_force=force, shaft_torque=torque)
    error = max(
        abs(force[m.flank_name(True)] - answer.flank_force[m.flank_name(True)]) * m.radii[0]
        for m in train.meshes.values()
    ) / max(abs(answer.flank_force[m.flank_name(True)]) * m.radii[0] for m in train.meshes.values())
    certificate = certify(train, wrong)
    assert certificate.bound.relative >= error * (1.0 - 2.0 * part - 1e-6)
    assert certificate.passed <= (error <= 1e-9)


def test_many_claims_and_single_ones_are_bounded_alike() -> None:
    case = ls.load_case("cases/fgfbstts/all_elements.toml")
    train = build_train(case)
    machine = Machine(train)
    indices = list(range(1, train.count + 1))[:5]
    here = machine.situations(indices)
    found = machine.answer(here, 1e-9, engine_named("vectorised", len(indices)))
    many = bounds(Columns(train), here, found.equilibria)
    assert (many.relative <= 1e-11).all()
    for row, index in enumerate(indices):
        single = bound_of(train, found.equilibria.one(row, index))
        assert single.relative <= 1e-11


def test_not_a_number_is_bounded_by_nothing() -> None:
    train, answer = stiff_split()
    wrong = replace(answer, flank_force=dict.fromkeys(answer.flank_force, float("nan")))
    assert bound_of(train, wrong).relative == float("inf")


def test_statics_are_those_of_singular_values() -> None:
    """For rows of any rank, for no rows, and for rows that are all zero."""
    rng = np.random.default_rng(4)
    for count, n, rank in ((9, 6, 6), (9, 6, 4), (5, 8, 5), (5, 8, 2), (4, 4, 0), (0, 3, 0)):
        directions = rng.normal(size=(count, rank)) @ rng.normal(size=(rank, n))
        found = Statics.of(directions)
        left, _, right = np.linalg.svd(directions, full_matrices=True)
        inverse = np.linalg.pinv(directions.T, rcond=1e-11)
        np.testing.assert_allclose(found.particular, inverse, atol=1e-12)
        for computed, true in ((found.redundant, left[:, rank:]), (found.moves, right[rank:].T)):
            assert computed.shape == true.shape
            np.testing.assert_allclose(computed @ computed.T, true @ true.T, atol=1e-12)


def test_what_ends_a_free_move_takes_more_than_the_load_along_it() -> None:
    """With a stop at one end of a lever that turns freely, the forces balance about its pivot."""
    long, short = 0.96, 0.28
    move = np.array([[long], [short]])
    at_end, at_start = np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]])
    nothing = np.empty((0, 2, 2))
    assert force_at_end(move, at_end, nothing) == pytest.approx(1.0 / long)
    assert force_at_end(move, np.concatenate([at_end, at_start]), nothing) == pytest.approx(
        1.0 / short
    )
    # A ring may take its force in any direction; one that the move does not close takes none.
    assert force_at_end(move, np.empty((0, 2)), np.eye(2)[None]) == pytest.approx(1.0)
    assert force_at_end(np.array([[1.0], [0.0]]), at_start, nothing) == 1.0
    assert force_at_end(move[:, :0], at_start, nothing) == 1.0


@pytest.mark.parametrize("torque", [1e-5, 1e-6, 1e-8])
def test_a_force_beside_a_light_torque_leaves_it_proved(torque: float) -> None:
    """A bearing takes 500 N from a planet that carries nothing; the other takes all of the torque.

    That planet may turn freely, and the rounding of its bearing force does no work on this
    rotation.
    """
    case = ls.Case(
        {
            "operating": {
                "input": "s",
                "output": "r",
                "torque": f"{torque} N*m",
                "forces": {"p1": ["500 N", "100 N", "0 N"]},
            },
            "gears": {
                "s": {"centre": ["0 mm", "0 mm"], "base_radius": "50 mm"},
                "p0": {"centre": ["110 mm", "0 mm"], "base_radius": "50 mm", "support": "1e8 N/m"},
                "p1": {"centre": ["-110 mm", "0 mm"], "base_radius": "50 mm", "support": "1e7 N/m"},
                "r": {"type": "internal", "centre": ["0 mm", "0 mm"], "base_radius": "150 mm"},
            },
            "meshes": {
                **{mesh: {"stiffness": "1e6 N*m/rad"} for mesh in ("s-p0", "p0-r", "p1-r")},
                "s-p1": {"stiffness": "1e6 N*m/rad", "gap": "1 mrad"},
            },
        }
    )
    found = ls.solve(case).positions[0]
    expected = {"s-p0": torque, "p0-r": torque, "s-p1": 0.0, "p1-r": 0.0}
    assert found.torque == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert found.certificate.proved < 1e-9
