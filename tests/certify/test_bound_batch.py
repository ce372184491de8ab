"""The bound of large batches: it holds, and its compiled and its uncompiled source give the same.

Its source is run twice, compiled and as written; both sum up the same products in another order.
Claims that are wrong by a known amount show that the bound holds: the right claim is off the exact
equilibrium by at most its own bound.
"""

import importlib
import sys
from dataclasses import replace
from itertools import islice
from pathlib import Path

import mpmath
import numpy as np
import pytest
from tests.certify import test_many
from tests.certify.test_many import CLAIMS, claims, positions, rolling, scales_of, taken
from tests.support import mostly_slow, shipped

from benchmarks.reference import reference
from benchmarks.workloads import workloads
from loadshare import compilation, numbering
from loadshare.certify import Judge
from loadshare.certify.bound import Columns, bounds, kernel
from loadshare.certify.bound.batch import is_covered, judged
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.settings import BOUND
from loadshare.train import Train, build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations

# In a bearing without clearance, round-off decides the place of a planet that carries nothing.
WAYS = test_many.WAYS | {"idle ball bearing": lambda: rolling(idle=True)}
NAMES = (
    "fgfbstts/limit_ring",
    "fgfbstts/spline_clearance",
    "fgfbstts/full_float",
    "fgfbstts/all_elements",
    "fgfbstts/both_errors",
    "branches/split_torque_6",
    "two_path/clocking_error",
    "round ring",
    "elastic round ring",
    "coast flanks",
    "spline that never slips",
    "tables",
    "ball bearings",
    "idle ball bearing",
    "idler on a spline",
    "pushed planets",
    "squeezed ring",
)
LIKE_OTHERS = {
    "fgfbstts/full_float",
    "fgfbstts/both_errors",
    "two_path/clocking_error",
    "round ring",
}
"""Those of these names that show nothing that the others do not."""
COUNT = 400
SAME = 1e-6
"""Tolerance between two sums of the same misfits that are rounding themselves, relative to the
bound."""


def relative_bounds(columns: Columns, here: Situations, claim: Equilibria) -> np.ndarray:
    """Return the bounds of compiled code."""
    return judged(columns, here, claim)[1]


def disturbed(found: Equilibria, scales: dict[str, float], seed: int) -> Equilibria:
    """Return claims that are off by 1e-14 to 1e-5 of the case, in all figures or some."""
    rng = np.random.default_rng(seed)
    rows = np.arange(COUNT) % len(found.rotation)
    wrong = taken(found, rows)
    size = 10.0 ** rng.uniform(-14.0, -5.0, COUNT)
    for name in CLAIMS:
        figures = getattr(wrong, name)
        shape = (COUNT,) + (1,) * (figures.ndim - 1)
        some = rng.random(COUNT) < 0.6
        figures += (
            (some * size).reshape(shape)
            * scales[name]
            * rng.normal(size=figures.shape)
            * (figures != 0.0)
        )
    return wrong


def errors(columns: Columns, here: Situations, one: Equilibria, other: Equilibria) -> np.ndarray:
    """Return the largest difference of a torque, over the largest torque of the first."""
    apart = np.abs(one.flank_force - other.flank_force) * columns.arms
    largest = (np.abs(one.flank_force) * columns.arms).max(axis=1)
    return apart.max(axis=1) / np.maximum(largest, np.abs(here.torque).max(axis=1))


@pytest.fixture(scope="module")
def plain():
    """Use the kernel as uncompiled Python."""
    with pytest.MonkeyPatch.context() as patch:
        rooms = kernel.__name__, numbering.__name__
        for name in [m for m in sys.modules if m.startswith(rooms)]:
            patch.delitem(sys.modules, name)
        patch.setattr(sys.modules[kernel.__package__.rpartition(".")[0]], "kernel", kernel)
        for way in ("jit", "within"):
            patch.setattr(compilation, way, lambda **_: lambda function: function)
        return importlib.import_module(kernel.__name__)


@pytest.mark.parametrize("name", mostly_slow(NAMES, {*NAMES} - LIKE_OTHERS))
@pytest.mark.quick(3)
def test_bounds_hold_and_are_those_of_the_source(name, plain, monkeypatch):
    train = build_train(WAYS[name]())
    columns = Columns(train)
    assert is_covered(columns)
    situations, found = claims(train, positions(train)[:4])
    verdicts = Judge(train).judge(situations, found)
    scales = scales_of(train, float(verdicts.load[0]), float(verdicts.deflection[0]))
    wrong = disturbed(found, scales, len(name))
    rows = np.arange(COUNT) % len(found.rotation)
    here = situations.take(rows) if situations.count > 1 else situations
    right = taken(found, rows)
    with np.errstate(all="ignore"):
        exact, off = (relative_bounds(columns, here, claim) for claim in (right, wrong))
    assert (exact <= 1e-11).all()
    assert (errors(columns, here, wrong, right) <= off + 2.0 * exact).all()
    assert (off <= 1e-9).any()
    # One full row of claims and one that is not: only a few, because uncompiled code is slow.
    few = np.arange(BOUND.side_by_side + 6)
    some = here.take(few) if here.count > 1 else here
    with np.errstate(all="ignore"):
        off = relative_bounds(columns, some, taken(wrong, few))
        monkeypatch.setattr(kernel, "find_all", plain.find_all)
        monkeypatch.setattr(kernel, "bound_all", plain.bound_all)
        again = relative_bounds(columns, some, taken(wrong, few))
    close = np.isfinite(off) & np.isfinite(again)
    assert (np.isfinite(off) == np.isfinite(again)).mean() > 0.99
    np.testing.assert_allclose(again[close], off[close], rtol=SAME, atol=1e-15)


def test_a_slip_off_its_place_is_not_proved_right():
    """A spline is claimed to slip with almost no force."""
    train = build_train(shipped("fgfbstts/spline_clearance"))
    columns = Columns(train)
    situations, found = claims(train, [1])
    wrong = taken(found, np.zeros(3, dtype=int))
    wrong.radial_reaction[1] *= 1.0 - 1e-3
    wrong.radial_reaction[2] *= 0.0
    given = relative_bounds(columns, situations, wrong)
    assert given[0] <= 1e-11
    assert (given[1:] > 1e-9).all()


@pytest.mark.parametrize("array", CLAIMS)
def test_not_a_number_is_bounded_by_nothing(array):
    train = build_train(shipped("fgfbstts/all_elements"))
    columns = Columns(train)
    situations, found = claims(train, [1])
    figures = getattr(found, array)[0]
    read = np.flatnonzero(figures)
    wrong = taken(found, np.zeros(len(read), dtype=int))
    for row, k in enumerate(read):
        getattr(wrong, array)[row].reshape(-1)[k] = np.nan
    given = relative_bounds(columns, situations, wrong)
    assert np.isinf(given).all()


@pytest.mark.parametrize(
    "field", ["torque", "gap", "bending", "hertz", "wall", "spline", "stop", "arc_clearance"]
)
def test_nothing_is_proved_where_a_situation_is_not_a_number(field):
    train = build_train(shipped("fgfbstts/all_elements"))
    columns = Columns(train)
    situations, found = claims(train, [1])
    for k in range(getattr(situations, field).size):
        values = getattr(situations, field).copy()
        if field == "spline" and k % values.shape[-1] in (1, 3, 4):
            continue
        if field in ("bending", "hertz", "wall", "torque") and values.reshape(-1)[k] == 0.0:
            continue
        if field == "torque" and k == columns.order[train.output]:
            continue  # the output is held: its torque is a reaction
        if field in ("bending", "hertz") and found.flank_force.reshape(-1)[k] == 0.0:
            continue  # of a flank that is open, only the gap matters
        values.reshape(-1)[k] = np.nan
        given = relative_bounds(columns, replace(situations, **{field: values}), found)
        assert np.isinf(given).all(), (field, k)


def test_large_batches_are_bounded_as_small_ones():
    """Of more than a thousand claims, some cannot be right: the others are bounded alike."""
    train = build_train(shipped("fgfbstts/all_elements"))
    columns = Columns(train)
    situations, found = claims(train, [1])
    many = taken(found, np.zeros(1200, dtype=int))
    many.flank_force[::100] *= 1.0 + 1e-3
    given = Judge(train).judge(situations, many, compiled=True).bounds
    single = bounds(columns, situations, taken(many, np.arange(2)))
    assert given.force is None
    assert (given.relative[::100] > 1e-9).all()
    assert single.relative[0] > 1e-9
    assert 0.0 < single.relative[1] <= given.relative[1] <= 1e-11


IDLING = (212, 278, 555, 721)
"""Samples of the workload `law` with a Hertz flank that carries about 1e-12 of the load."""


def idling(number: int) -> tuple[Train, Situations, Equilibria, int]:
    """Return one of them as the fast method answers it, and the flank."""
    (law,) = (w for w in workloads(Path("cases"), False) if w.name == "law")
    train = build_train(next(islice(law.cases(number + 1), number, None)))
    machine = Machine(train)
    situations = machine.situations([1])
    found = machine.answer(situations, 1e-9, engine_named("compiled", 1)).equilibria
    force = found.flank_force[0]
    (flank,) = np.flatnonzero((force > 0.0) & (force < 1e-11 * force.max()))
    return train, situations, found, int(flank)


def true_errors(train: Train, found: Equilibria, largest: float) -> np.ndarray:
    """Return the largest error of a mesh's torque in 50 digits, over the largest torque."""
    truth = reference(train, 1, found.one(0, 1))
    worst = []
    for row in range(len(found.rotation)):
        forces = found.one(row, 1).flank_force
        with mpmath.workdps(50):
            off = [
                abs(
                    sum(
                        (1 if drive else -1) * mpmath.mpf(forces[mesh.flank_name(drive)])
                        for drive in mesh.flanks
                    )
                    * mpmath.mpf(mesh.radii[0])
                    - mpmath.mpf(truth.exact[name])
                )
                for name, mesh in train.meshes.items()
            ]
            # Both flanks of a mesh may be off.
            worst.append(float(max(off)) / largest / 2.0)
    return np.array(worst)


@pytest.mark.parametrize("number", mostly_slow(IDLING, (278,)))
def test_an_idling_hertz_flank_is_bounded(number):
    """It is infinitely soft, however small its claimed force; other flanks still show the error.

    Its tangent, and the secant to zero force, are many times those of its neighbours.
    """
    train, situations, found, flank = idling(number)
    columns = Columns(train)
    wrong = taken(found, np.zeros(COUNT, dtype=int))
    rng = np.random.default_rng(number)
    load = wrong.flank_force.max()
    wrong.flank_force[1::4, flank] = load * 10.0 ** rng.uniform(-16.0, -8.0, COUNT // 4)
    spread = 10.0 ** rng.uniform(-15.0, -9.0, (COUNT // 4, 1)) * load
    wrong.flank_force[2::4] += spread * rng.normal(size=wrong.flank_force[2::4].shape)
    np.maximum(wrong.flank_force, 0.0, out=wrong.flank_force)
    wrong.displacement[3::4] *= 1.0 + 1e-12 * rng.normal(size=wrong.displacement[3::4].shape)
    with np.errstate(all="ignore"):
        given, alone = (relative_bounds(columns, situations, c) for c in (wrong, found))
    largest = max((found.flank_force * columns.arms).max(), np.abs(situations.torque).max())
    assert (true_errors(train, wrong, largest) <= given * (1.0 + 1e-6)).all()
    assert alone[0] <= 1e-11
    assert np.isfinite(given[1::4]).mean() > 0.25


def test_a_stop_that_is_touched_carries_nothing():
    """A gear is out of balance by a force that its stop would have to pull: the flanks carry it.

    A contact that opens may move by any length, so a stop without force cannot support the rest.
    """
    train, situations, found, _ = idling(34)
    columns = Columns(train)
    largest = max((found.flank_force * columns.arms).max(), np.abs(situations.torque).max())
    (error,) = true_errors(train, found, largest)
    assert error > 1e-13
    for bound in (
        bounds(columns, situations, found).relative,
        relative_bounds(columns, situations, found),
    ):
        assert error <= bound[0]


@pytest.mark.parametrize("name", ["tables", "fgfbstts/all_elements"])
def test_compiled_bounds_of_right_claims_are_those_of_single_ones(name):
    """Both hold, and neither is a large multiple of the true bound of the claim."""
    train = build_train(WAYS[name]())
    columns = Columns(train)
    situations, found = claims(train, positions(train)[:2])
    given = relative_bounds(columns, situations, found)
    single = bounds(columns, situations, found).relative
    assert (given <= 1e-11).all()
    assert (single <= 1e-11).all()
    largest = max((found.flank_force * columns.arms).max(), np.abs(situations.torque).max())
    for bound in (given, single):
        assert true_errors(train, taken(found, np.array([0])), largest)[0] <= bound[0]


@pytest.mark.parametrize("where", [-1e-7, 0.0, 1e-7])
def test_a_corner_of_a_table_within_reach(where):
    """The laws on both sides of the corner are allowed for."""
    train = build_train(WAYS["tables"]())
    columns = Columns(train)
    situations, found = claims(train, [1])
    flank = int(columns.tabled[0])
    force = found.flank_force[0, flank]
    table = situations.table.copy()
    mesh = columns.meshes[flank]
    forces = table[0, mesh, 0]
    corner = int(np.argmin(np.abs(forces[1:-1] - force))) + 1
    law = np.interp(force, forces, table[0, mesh, 1])
    forces[corner] = force * (1.0 + where * 1e-3)
    table[0, mesh, 1, corner] = law * (1.0 + where * 1e-3)
    assert (np.diff(forces[~np.isnan(forces)]) > 0.0).all()
    given = relative_bounds(columns, replace(situations, table=table), found)
    assert given[0] <= 1e-9
