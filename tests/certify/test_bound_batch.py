"""The bound of large batches: what it says holds, and compiled it says what its source says.

Its source is run twice, compiled and as it is written; both sum up the same products in another
order. That it holds is seen from claims that are wrong by a known amount: the right claim lies as
far from the exact equilibrium as its own bound says, at most.
"""

import importlib.util
from dataclasses import replace

import numpy as np
import pytest
from tests.certify.test_many import CLAIMS, WAYS, claims, positions, scales_of, taken
from tests.support import shipped

from loadshare import compilation
from loadshare.certify import Judge
from loadshare.certify.bound import Columns, bounds
from loadshare.certify.bound import compiled as kernel
from loadshare.certify.bound.batch import is_covered, relative_bounds
from loadshare.train import build_train
from loadshare.train.equilibria import Equilibria

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
)
COUNT = 400
SAME = 1e-6
"""Two sums of the same misfits, where these are rounding themselves: relative to the bound."""


def spoilt(found: Equilibria, scales: dict[str, float], seed: int) -> Equilibria:
    """Claims that are off by 1e-14 to 1e-5 of the case, in all figures or some."""
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


def errors(columns: Columns, one: Equilibria, other: Equilibria) -> np.ndarray:
    """Largest distance of a torque, in torques of the first."""
    apart = np.abs(one.flank_force - other.flank_force) * columns.arms
    return apart.max(axis=1) / (np.abs(one.flank_force) * columns.arms).max(axis=1)


@pytest.fixture(scope="module")
def plain():
    """The kernel as it is written."""
    spec = importlib.util.spec_from_file_location("plain_bound", kernel.__file__)
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        for way in ("jit", "within"):
            patch.setattr(compilation, way, lambda **_: lambda function: function)
        spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", NAMES)
def test_bounds_hold_and_are_those_of_the_source(name, plain, monkeypatch):
    train = build_train(WAYS[name]())
    columns = Columns(train)
    assert is_covered(columns)
    situations, found = claims(train, positions(train)[:4])
    judged = Judge(train).judge(situations, found)
    wrong = spoilt(
        found, scales_of(train, float(judged.load[0]), float(judged.deflection[0])), len(name)
    )
    rows = np.arange(COUNT) % len(found.rotation)
    here = situations.take(rows) if situations.count > 1 else situations
    right = taken(found, rows)
    with np.errstate(all="ignore"):
        exact, off = (relative_bounds(columns, here, claim) for claim in (right, wrong))
    assert (exact <= 1e-11).all()
    assert (errors(columns, wrong, right) <= off + 2.0 * exact).all()
    assert (off <= 1e-9).any()
    monkeypatch.setattr(kernel, "find_all", plain.find_all)
    monkeypatch.setattr(kernel, "bound_all", plain.bound_all)
    with np.errstate(all="ignore"):
        again = relative_bounds(columns, here, wrong)
    close = np.isfinite(off) & np.isfinite(again)
    assert (np.isfinite(off) == np.isfinite(again)).mean() > 0.99
    np.testing.assert_allclose(again[close], off[close], rtol=SAME, atol=1e-15)


def test_a_slip_off_its_place_is_not_proved_right():
    """A spline that is claimed to slip with next to no force."""
    train = build_train(shipped("fgfbstts/spline_clearance"))
    columns = Columns(train)
    situations, found = claims(train, [1])
    wrong = taken(found, np.zeros(3, dtype=int))
    wrong.radial_reaction[1] *= 1.0 - 1e-3
    wrong.radial_reaction[2] *= 0.0
    told = relative_bounds(columns, situations, wrong)
    assert told[0] <= 1e-11
    assert (told[1:] > 1e-9).all()


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
    told = relative_bounds(columns, situations, wrong)
    assert np.isinf(told).all()


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
        values.reshape(-1)[k] = np.nan
        told = relative_bounds(columns, replace(situations, **{field: values}), found)
        assert np.isinf(told).all(), (field, k)


def test_large_batches_are_bounded_as_small_ones():
    """A thousand claims and more, of which some cannot be right: the others are told alike."""
    train = build_train(shipped("fgfbstts/all_elements"))
    columns = Columns(train)
    situations, found = claims(train, [1])
    many = taken(found, np.zeros(1200, dtype=int))
    many.flank_force[::100] *= 1.0 + 1e-3
    told = bounds(columns, situations, many, compiled=True, wanted=np.zeros(1200, dtype=bool))
    single = bounds(columns, situations, taken(many, np.arange(2)))
    assert told.force is None
    assert (told.relative[::100] > 1e-9).all()
    assert single.relative[0] > 1e-9
    assert 0.0 < single.relative[1] <= told.relative[1] <= 1e-11
