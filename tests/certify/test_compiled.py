"""The compiled certificate gives the verdicts of NumPy's, for errors of any kind and size.

Source: formulation, sections 8 and 16. It adds up forces along coordinates, NumPy's body by body;
both use the same scales. The tests of `test_many` also compare it with the single one.
"""

from dataclasses import fields, replace

import numpy as np
import pytest
from tests.certify.test_independence import modules_after
from tests.certify.test_many import (
    ABSOLUTE,
    CLAIMS,
    QUICK,
    WAYS,
    alike,
    claims,
    positions,
    residuals,
    scales_of,
    taken,
)
from tests.support import mostly_slow, shipped

import loadshare as ls
from loadshare.certify import RESIDUALS, Judge
from loadshare.certify.bound.kernel import find_all
from loadshare.job import hot
from loadshare.settings import CERTIFY
from loadshare.solver.hot import compiled
from loadshare.train import build_train
from loadshare.train.situations import Situations

SIZES = (1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3)
"""Sizes of what is added to every figure of a claim, over load and deflection of the case."""


@pytest.mark.parametrize("name", mostly_slow(WAYS, QUICK))
@pytest.mark.quick(1)
def test_one_wrong_claim(name):
    train = build_train(WAYS[name]())
    situations, found = claims(train, positions(train)[:1])
    right = Judge(train).judge(situations, found)
    scales = scales_of(train, float(right.load[0]), float(right.deflection[0]))
    wrong = [claim for claim in CLAIMS if getattr(found, claim)[0].size]
    rows = np.zeros(len(wrong) * len(SIZES), dtype=int)
    altered = taken(found, rows)
    rng = np.random.default_rng(len(name))
    for k, claim in enumerate(wrong):
        for m, size in enumerate(SIZES):
            figures = getattr(altered, claim)[k * len(SIZES) + m]
            figures += size * scales[claim] * rng.normal(size=figures.shape)
    many = alike(train, situations, altered)
    refused = dict(zip(wrong, ~many.passed.reshape(-1, len(SIZES)), strict=True))
    # Rigid shafts and bearings carry what balance requires: claims about them are not read.
    for claim in set(wrong) - {"shaft_torque", "support_force"}:
        assert refused[claim][-1], claim


@pytest.mark.parametrize("name", ["fgfbstts/all_elements", "elastic round ring", "tables"])
def test_one_row_holds_for_all_answers(name):
    """Situations that do not vary give the same as when they are written out."""
    train = build_train(WAYS[name]())
    situations, found = claims(train, [1])
    answers = taken(found, np.zeros(5, dtype=int))
    answers.flank_force[:] *= 1.0 + 1e-4 * np.arange(5)[:, None]
    written = {
        f.name: np.repeat(getattr(situations, f.name), 5, axis=0)
        for f in fields(Situations)
        if f.name not in ("train", "count")
    }
    once = alike(train, situations, answers)
    each = alike(train, replace(situations, count=5, **written), answers)
    np.testing.assert_array_equal(once.worst, each.worst)


def test_a_set_of_several_parts():
    """NumPy judges it in parts."""
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    answers = taken(found, np.zeros(5000, dtype=int))
    answers.rotation[:] *= 1.0 + 1e-6 * np.linspace(0.0, 1.0, 5000)[:, None]
    assert 0 < alike(train, situations, answers).passed.sum() < 5000


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", ["fgfbstts/all_elements", "clocked rigid shaft", "round ring"])
def test_no_claim_with_any_figure_that_is_none_passes(name, bad):
    train = build_train(WAYS[name]())
    situations, found = claims(train, [1])
    places = [(claim, k) for claim in CLAIMS for k in range(getattr(found, claim)[0].size)]
    altered = taken(found, np.zeros(len(places), dtype=int))
    for row, (claim, k) in enumerate(places):
        getattr(altered, claim)[row].reshape(-1)[k] = bad
    assert np.isinf(alike(train, situations, altered).worst).all()
    assert np.isinf(Judge(train).judge(situations, altered, compiled=True).worst).all()


@pytest.mark.parametrize(
    ("field", "place"),
    [
        ("offset", (5, 0)),
        ("torque", (0,)),
        ("gap", (0,)),
        ("bending", (0,)),
        ("hertz", (0,)),
        ("clocking", (0,)),
        ("torsion", (0,)),
        ("support", (3, 0)),
        ("arc_clearance", (0, 1)),
        ("arc_shift", (0, 0, 0)),
        ("stop", (0, 0)),
        ("wall", (0,)),
        ("spline", (0, 0)),
        ("spline", (0, 2)),
    ],
)
@pytest.mark.quick(4)
def test_no_answer_passes_where_a_situation_is_not_a_number(field, place):
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    assert alike(train, situations, found).passed.all()
    values = getattr(situations, field).copy()
    values[(0, *place)] = np.nan
    compiled = Judge(train).judge(replace(situations, **{field: values}), found, compiled=True)
    assert not compiled.passed.any()


def test_arrays_of_any_kind_are_judged_by_the_same_code():
    """Strided, transposed, read-only or single precision arrays cause no new compilation."""
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    answers = taken(found, np.zeros(4, dtype=int))
    expected = Judge(train).judge(situations, answers, compiled=True)
    compiled = len(find_all.signatures)

    def strided(array: np.ndarray) -> np.ndarray:
        return np.repeat(array, 2, axis=-1)[..., ::2]

    def read_only(array: np.ndarray) -> np.ndarray:
        copy = array.copy()
        copy.flags.writeable = False
        return copy

    for lay in (strided, np.asfortranarray, read_only):
        other = Judge(train).judge(situations, answers.mapped(lay), compiled=True)
        np.testing.assert_array_equal(other.worst, expected.worst)
    single = answers.mapped(lambda array: array.astype(np.float32))
    assert not Judge(train).judge(situations, single, compiled=True).passed.any()
    assert len(find_all.signatures) == compiled


def test_no_answer_at_all():
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    none = taken(found, np.zeros(0, dtype=int))
    verdicts = Judge(train).judge(situations, none, tolerance=CERTIFY.tolerance, compiled=True)
    assert verdicts.worst.shape == verdicts.bounds.relative.shape == (0,)


def test_numba_is_imported_only_on_request():
    assert "numba" not in modules_after("import loadshare.certify")


def test_a_contact_that_pulls():
    """Half the tolerance passes its residual, twice the tolerance does not."""
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    load = float(Judge(train).judge(situations, found).load[0])
    altered = taken(found, np.zeros(2, dtype=int))
    idle = int(np.argmin(found.flank_force[0]))
    altered.flank_force[:, idle] = (
        -0.5 * CERTIFY.tolerance * load,
        -2.0 * CERTIFY.tolerance * load,
    )
    alike(train, situations, altered)
    expected = (0.5 * CERTIFY.tolerance, 2.0 * CERTIFY.tolerance)
    figures = residuals(train, situations, altered)[:, RESIDUALS.index("cone_membership")]
    compiled = Judge(train).judge(situations, altered, compiled=True).worst
    for found in (figures, compiled):
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=ABSOLUTE)


@pytest.mark.parametrize("stiffness", ["200 N*m/rad", "2 N*m/rad", "0.2 N*m/rad", "0.02 N*m/rad"])
def test_what_turns_by_a_thousand_turns_passes_once_more_by_itself(stiffness, monkeypatch):
    """Round-off of rotations is no misfit of a law: answers that pass in a batch are judged again
    alone.
    """
    monkeypatch.setattr(hot, "available_engine", lambda name, count: compiled.settle)
    shafts = {f'shafts."wheel{k}-pinion{k}".stiffness': stiffness for k in (1, 2)}
    case = shipped("two_path/from_teeth").replace(shafts)
    for torque in np.linspace(300.0, 400.0, 8):
        found = ls.solve(case.replace({"operating.torque": f"{torque} N*m"}), positions=[1])
        assert found.positions[0].certificate.passed
