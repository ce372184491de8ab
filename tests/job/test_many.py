"""Many samples at once: the same answers as one at a time, whatever the blocks and workers.

Tolerances: 1e-12 for a sample solved with other samples, because it takes another number of Newton
passes and differs by round-off times its condition number; 1e-9, as between methods, for a sample
solved alone, because it may start elsewhere.
"""

import inspect
import pickle
import subprocess
import sys
import tracemalloc
from itertools import islice

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from tests.solver.hot.trains import VARIED, varied
from tests.support import CASES, furthest, shipped

import loadshare as ls
from benchmarks import families
from loadshare.case import starter_case
from loadshare.errors import CaseError
from loadshare.job import machine, many
from loadshare.job.block import RUNGS
from loadshare.job.hot import HOT
from loadshare.job.many import solve_blocks
from loadshare.job.table import KEPT
from loadshare.settings import CERTIFY, JOB
from loadshare.train import build_train
from loadshare.train.samples import samples_of

RINGS = {
    "rings.4.float [um]": [0.0, 4.0, 12.0],
    "rings.5.float [um]": [0.0, 4.0, 12.0],
}
LIMIT_RING = "fgfbstts/limit_ring"


def small_blocks(monkeypatch, samples: int) -> None:
    """Solve blocks of `samples` samples, and one position after another."""
    for module in (many, machine):
        monkeypatch.setattr(module, "JOB", JOB._replace(block=samples, together=samples))


def named(rung) -> np.ndarray:
    """Return the rungs by the names that the data set itself gives."""
    assert rung.dtype == np.int8
    assert rung.flag_values.tolist() == list(range(len(RUNGS)))
    names = [name.replace("_", " ") for name in rung.flag_meanings.split()]
    return np.array(names)[rung.values]


def apart(one, other, name: str) -> float:
    """Return the largest difference of a variable over its largest figure."""
    a, b = one[name].values, other[name].values
    assert (np.isnan(a) == np.isnan(b)).all()
    size = np.nanmax(np.abs(a), initial=0.0) or 1.0
    return float(np.nanmax(np.abs(a - b), initial=0.0)) / size


# --- What comes back ---


def test_shapes_labels_and_units():
    case = shipped(LIMIT_RING)
    found = ls.solve_many(case, RINGS, keep=KEPT)
    assert dict(found.sizes) == {
        "sample": 3,
        "position": 5,
        "mesh": 10,
        "gear": 3,
        "component": 2,
        "contact": 8,
    }
    assert found.torque.dims == ("sample", "position", "mesh")
    assert found.displacement.dims == ("sample", "position", "gear", "component")
    assert found.contact_force.dims == ("sample", "position", "contact")
    assert found.mesh.values.tolist() == list(case.meshes)
    assert found.gear.values.tolist() == ["1", "4", "5"]
    assert found.component.values.tolist() == ["x", "y"]
    assert found.position.values.tolist() == [1, 2, 3, 4, 5]
    assert found.sample.values.tolist() == [0, 1, 2]
    assert set(found.contact.values) == {
        f"ring {g}: {c}"
        for g, pair in (("4", "76"), ("5", "98"))
        for c in ("upper stop", "lower stop", *(f"arc {n}" for n in pair))
    }
    units = {name: found[name].attrs["units"] for name in KEPT}
    assert units == {
        "torque": "N·m",
        "share": "1",
        "pair_share": "1",
        "displacement": "m",
        "contact_force": "N",
    }
    assert found.attrs["case"] == "limit_ring"
    assert found.attrs["case_hash"] == case.hash
    assert found.attrs["tolerance"] == CERTIFY.tolerance
    assert found.attrs["refused"] == ""
    assert (named(found.rung) == HOT).all()
    assert found.certified.all()
    assert (found.residual <= CERTIFY.tolerance).all()


def test_what_is_noted_on_the_labels_of_one_table_stays_there():
    one, other = (ls.solve_many(shipped(LIMIT_RING), RINGS, positions=[1]) for _ in range(2))
    one.mesh.attrs["seen"] = one.sample.attrs["seen"] = "yes"
    assert not other.mesh.attrs
    assert not other.sample.attrs
    again = ls.solve_many(shipped(LIMIT_RING), RINGS, positions=[1])
    assert again.identical(other)


@pytest.mark.parametrize("keep", [("torque",), ("share", "pair_share"), ("displacement",), ()])
def test_only_what_is_kept(keep):
    found = ls.solve_many(shipped(LIMIT_RING), RINGS, positions=[1], keep=keep)
    always = {"residual", "torque_bound", "certified", "determined", "displaced", "rung"}
    always |= {"convex", "arc_curvature"}
    assert set(found.data_vars) == {*keep, *always}
    whole = ls.solve_many(shipped(LIMIT_RING), RINGS, positions=[1], keep=KEPT)
    for name in keep:
        np.testing.assert_array_equal(found[name], whole[name])


def test_some_positions():
    whole = ls.solve_many(shipped(LIMIT_RING), RINGS, keep=KEPT)
    some = ls.solve_many(shipped(LIMIT_RING), RINGS, positions=[4, 2], keep=KEPT)
    assert some.position.values.tolist() == [4, 2]
    for name in KEPT:
        chosen = whole.sel(position=[4, 2])
        assert apart(chosen, some, name) < 1e-12


def test_a_case_file_will_do(tmp_path):
    path = tmp_path / "star.toml"
    families.star(4).to_toml(path)
    found = ls.solve_many(path, {"operating.torque [N*m]": [500.0]})
    assert found.certified.all()
    assert found.torque.sizes["mesh"] == len(ls.load_case(path).meshes)


@pytest.mark.parametrize("name", VARIED)
@pytest.mark.quick(3)
def test_each_sample_is_the_case_solved_alone(name):
    """Torques, shares, floats, contact forces and determined gears, sample by sample."""
    case, samples = varied(name, 4, seed=11)
    found = ls.solve_many(case, samples, positions=[1], keep=KEPT)
    ((_, group),) = samples_of(case, samples)
    for sample in range(4):
        alone = ls.solve(group.one(sample), positions=[1])
        here, position = found.isel(sample=sample, position=0), alone.positions[0]
        torque = dict(zip(found.mesh.values, here.torque.values, strict=True))
        expected = {m: position.torque[m] for m in found.mesh.values}
        assert furthest(expected, torque) < 1e-9
        for values, known in ((here.share, position.share), (here.pair_share, position.pair_share)):
            for mesh, value in zip(found.mesh.values, values.values, strict=True):
                if mesh in known and np.isfinite(value):
                    assert value == pytest.approx(known[mesh], rel=1e-9, abs=1e-9)
                else:
                    assert np.isnan(value)
        assert bool(here.determined) == (not position.undetermined)
        floats = {
            g: tuple(v) for g, v in zip(found.gear.values, here.displacement.values, strict=True)
        }
        size = max(
            position.certificate.deflection,
            max(map(abs, np.ravel(list(floats.values()))), default=0.0),
        )
        assert set(floats) <= set(position.displacement)
        for gear, moved in floats.items():
            if not any(f"gear {gear} " in free for free in position.undetermined):
                np.testing.assert_allclose(moved, position.displacement[gear], atol=1e-8 * size)


@pytest.mark.parametrize("name", VARIED)
@pytest.mark.quick(3)
def test_a_sample_alone_is_what_it_is_among_others(name):
    """This holds at all positions, although its situations come from its own train."""
    case, samples = varied(name, 3, seed=12)
    among = ls.solve_many(case, samples, keep=KEPT)
    some = {key: values[1:2] for key, values in samples.items()}
    alone = ls.solve_many(case, some, keep=KEPT).isel(sample=0)
    here = among.isel(sample=1)
    for variable in (*KEPT, "displaced", "arc_curvature"):
        one, other = alone[variable].values, here[variable].values
        size = np.abs(other[np.isfinite(other)]).max(initial=0.0)
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-8 * size)
    for variable in ("certified", "determined", "convex"):
        np.testing.assert_array_equal(alone[variable].values, here[variable].values)


@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
def test_rings_that_hold_floats_by_next_to_no_force_need_no_search(tmp_path, engine):
    """Two pinions roll far along lines of action that nearly coincide: the forces of their rings
    are 1e-5 of the load.
    """
    path = tmp_path / "four.toml"
    path.write_text(starter_case("four", "four-branch"))
    radii = {"rings.pinion1.radius [um]": np.linspace(5.0, 60.0, 12)}
    found = ls.solve_many(path, radii, engine=engine)
    assert found.certified.all()
    np.testing.assert_array_equal(named(found.rung), HOT)


def test_a_gear_that_floats_freely_is_not_determined():
    """Nothing holds gear 1 in its place, but a rigid bearing does. Rings of up to 2 µm hold the
    others, because the pinions press on them (Fig. 14).
    """
    case = shipped(LIMIT_RING)
    samples = {key: [0.0, 2.0] for key in RINGS}
    assert not ls.solve_many(case, samples).determined.any()
    assert ls.solve_many(case.replace({"gears.1.support": "rigid"}), samples).determined.all()


# --- Refusals ---


def mixed() -> tuple[ls.Case, dict[str, list[float]]]:
    """Return a ring dimensioned on the drawing whose idler comes too near by up to 30 µm, although
    there is only room for 20.
    """
    case = shipped(LIMIT_RING).replace(
        {
            "rings.4.measured": "nominal",
            "rings.4.clearance": "10 um",
            "errors.6.installation": {"amount": "0 um", "direction": "131.17 deg"},
        }
    )
    return case, {"errors.6.installation.amount [um]": [0.0, 30.0, 5.0]}


def test_a_sample_whose_limits_contradict_is_refused_and_the_others_are_not():
    case, samples = mixed()
    found = ls.solve_many(case, samples, positions=[1, 2], keep=KEPT)
    bad = ~found.certified.values.all(axis=1)
    assert bad.sum() == 1
    (number,) = np.flatnonzero(bad).tolist()
    lines = found.attrs["refused"].splitlines()
    assert len(lines) == 2
    for position, message in enumerate(lines, start=1):
        assert message.startswith(f"sample {number}, position {position}: rigid limits contradict")
        assert "ring 4: arc" in message
    refused, others = found.isel(sample=number), found.isel(sample=~bad)
    for name in (*KEPT, "residual"):
        assert np.isnan(refused[name]).all(), name
    assert (refused.rung == 0).all()
    assert not refused.certified.any()
    assert not refused.determined.any()
    assert np.isfinite(others.torque).all()
    assert others.certified.all()


def test_a_train_without_a_path_for_the_torque_is_refused_with_a_message():
    """The first wheels of both paths float freely, so they give way to any push."""
    case = families.two_path("0 mrad").replace(
        {"gears.wheelA.support": "free", "gears.wheelB.support": "free"}
    )
    found = ls.solve_many(case, {'meshes."in-wheelA".stiffness [N*m/rad]': [1e6, 2e6]})
    assert not found.certified.any()
    assert np.isnan(found.torque).all()
    assert (found.rung == 0).all()
    messages = found.attrs["refused"].splitlines()
    assert len(messages) == 2
    for sample, message in enumerate(messages):
        assert message.startswith(f"sample {sample}, position 1: ")
        assert "nothing balances the load on gear" in message


def test_a_law_that_drops_is_refused_sample_by_sample():
    """S1 is fixed and the friction varies: if K_w S1 exceeds F_m, the equilibrium is not unique."""
    case = shipped("fgfbstts/all_elements").replace({"splines.5.stick_limit": "0.5 um"})
    samples = {"splines.5.friction": [0.002, 1e-5, 0.01]}
    found = ls.solve_many(case, samples, positions=[1], keep=KEPT)
    assert found.certified.values[:, 0].tolist() == [True, False, True]
    (message,) = found.attrs["refused"].splitlines()
    assert "drop" in message


def test_values_that_do_not_go_together_are_refused_sample_by_sample():
    """Each value is valid in a case; the pair of the second sample is not: S2 < S1."""
    case = shipped("fgfbstts/spline_clearance").replace(
        {
            "splines.4.friction": None,
            "splines.4.normal_force": None,
            "splines.4.friction_force": "100 N",
            "splines.4.stick_limit": "1 um",
        }
    )
    samples = {
        "splines.4.stick_limit [um]": [1.0, 4.0, 4.0],
        "splines.4.clearance [um]": [8.0, 3.0, 8.0],
    }
    with pytest.raises(CaseError, match="stick limit"):
        # The checks look at the smallest clearance with the largest stick limit.
        ls.solve(case.replace({"splines.4.stick_limit": "4 um", "splines.4.clearance": "3 um"}))
    found = ls.solve_many(case, samples, positions=[1], keep=KEPT)
    assert found.certified.values[:, 0].tolist() == [True, False, True]
    (message,) = found.attrs["refused"].splitlines()
    assert "stick limit" in message


def test_a_data_set_is_written_and_read(tmp_path):
    """With nothing refused, with one sample refused, and with several."""
    case, samples = mixed()
    for positions, amounts in (([1], [0.0]), ([1], [0.0, 30.0]), ([2, 1], samples.popitem()[1])):
        key = "errors.6.installation.amount [um]"
        found = ls.solve_many(case, {key: amounts}, positions=positions)
        found.to_netcdf(tmp_path / "many.nc")
        assert xr.load_dataset(tmp_path / "many.nc").identical(found)


def test_a_data_frame_will_do():
    case, one = shipped(LIMIT_RING), {key: values[1:] for key, values in RINGS.items()}
    given = (pd.DataFrame(one), {key: iter(values) for key, values in one.items()})
    expected = ls.solve_many(case, one, positions=[1])
    for samples in given:
        assert ls.solve_many(case, samples, positions=[1]).identical(expected)


def test_what_the_hot_path_leaves_climbs_and_says_so(monkeypatch):
    """The engine declines the second of three samples; another rung gives the same answer."""
    from loadshare.solver.hot import contact_states, vectorised

    settle, declined = vectorised.settle, []

    def moody(structure, loading, sets, parts, state, one_only):
        verdict, proposal = settle(structure, loading, sets, parts, state, one_only)
        if loading.count == 3 and not declined:
            declined.append(loading.gap[1])
        gap = loading.gap[np.concatenate(parts)]
        is_declined = (gap == declined[0]).all(axis=1) if declined else False
        return np.where(is_declined, contact_states.FAILED, verdict), proposal

    expected = ls.solve_many(shipped(LIMIT_RING), RINGS, positions=[1])
    monkeypatch.setattr(vectorised, "settle", moody)
    found = ls.solve_many(shipped(LIMIT_RING), RINGS, positions=[1])
    assert (named(found.rung)[:, 0] == HOT).tolist() == [True, False, True]
    assert found.certified.all()
    for name in ("torque", "share", "pair_share"):
        assert apart(expected, found, name) < 1e-9


def test_what_is_not_there_is_reported():
    case = shipped(LIMIT_RING)
    with pytest.raises(ValueError, match=r"no variable torques; allowed: torque, share"):
        ls.solve_many(case, RINGS, keep=["torques"])
    with pytest.raises(ValueError, match=r"no variable 1; allowed: torque, share"):
        ls.solve_many(case, RINGS, keep=[1])
    with pytest.raises(ValueError, match="positions 9: this case has positions 1 to 5"):
        ls.solve_many(case, RINGS, positions=[9])
    with pytest.raises(ValueError, match="unknown engine 'fast'"):
        ls.solve_many(case, RINGS, engine="fast")
    for workers in (0, -1, 1.5, True, None):
        with pytest.raises(ValueError, match=f"workers {workers}; allowed: a whole number from 1"):
            ls.solve_many(case, RINGS, workers=workers)
    with pytest.raises(CaseError, match="there is no key"):
        ls.solve_many(case, {})


# --- Blocks, workers, engines ---


def floats(count: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(5)
    return {key: rng.uniform(0.0, 12.0, count) for key in RINGS}


def test_the_number_of_workers_does_not_matter(monkeypatch):
    """They agree bit for bit: the blocks are the same, whoever solves them."""
    small_blocks(monkeypatch, 7)
    one, two, five = (
        ls.solve_many(shipped(LIMIT_RING), floats(40), positions=[1, 3], workers=w)
        for w in (1, 2, 5)
    )
    for other in (two, five):
        assert one.identical(other)


@pytest.mark.parametrize("block", [3, 23])
@pytest.mark.parametrize("name", ["drums", "every element"])
@pytest.mark.quick(1)
def test_the_size_of_blocks_does_not_matter(name, block, monkeypatch):
    case, samples = varied(name, 24, seed=2)
    whole = ls.solve_many(case, samples, positions=[1], keep=KEPT)
    small_blocks(monkeypatch, block)
    parts = ls.solve_many(case, samples, positions=[1], keep=KEPT)
    for name in ("torque", "contact_force", "displacement"):
        assert apart(whole, parts, name) < 1e-12
    for name in ("certified", "determined", "rung"):
        np.testing.assert_array_equal(whole[name], parts[name])


def test_sets_in_uneven_surroundings_are_learned_of_at_one_position_too(monkeypatch):
    """More samples than one block holds, all at one position, used to end in a traceback."""
    small_blocks(monkeypatch, 400)
    case = shipped("planetary/four_planets").replace({"gears.ring.support": ["1e9 N/m", "2e9 N/m"]})
    torques = {"operating.torque [N*m]": np.linspace(500.0, 1500.0, 1000)}
    assert ls.solve_many(case, torques, engine="vectorised").certified.all()


def test_the_company_does_not_matter():
    """The first ten of forty samples equal the ten alone."""
    many_, few = floats(40), {key: v[:10] for key, v in floats(40).items()}
    one = ls.solve_many(shipped(LIMIT_RING), many_, positions=[1], keep=KEPT).isel(sample=slice(10))
    other = ls.solve_many(shipped(LIMIT_RING), few, positions=[1], keep=KEPT)
    for name in ("torque", "contact_force", "displacement"):
        assert apart(one, other, name) < 1e-12


def test_samples_of_different_machines_come_back_in_their_places():
    """If a key changes the machine, samples are solved in groups and keep their numbers."""
    case = shipped(LIMIT_RING)
    samples = {
        "rings.4.stiffness": ["rigid", "1e8 N/m", "rigid", "1e8 N/m"],
        "rings.4.float [um]": [2.0, 2.0, 5.0, 5.0],
    }
    found = ls.solve_many(case, samples, positions=[1], keep=KEPT)
    for sample in range(4):
        alone = ls.solve(
            case.replace(
                {
                    "rings.4.stiffness": samples["rings.4.stiffness"][sample],
                    "rings.4.float": f"{samples['rings.4.float [um]'][sample]} um",
                }
            ),
            positions=[1],
        )
        torque = dict(zip(found.mesh.values, found.torque.values[sample, 0], strict=True))
        assert furthest(alone.positions[0].torque, torque) < 1e-9


def test_a_backlash_that_follows_from_teeth_stands_beside_lengths():
    case, key = shipped("two_path/from_teeth"), 'meshes."in-wheel1".backlash'
    values = ["teeth", "100 um"]
    found = ls.solve_many(case, {key: values})
    for sample, value in enumerate(values):
        alone = ls.solve(case.replace({key: value})).positions[0]
        torque = dict(zip(found.mesh.values, found.torque.values[sample, 0], strict=True))
        assert furthest(alone.torque, torque) < 1e-9


def test_gears_that_float_in_some_samples_only_are_all_reported():
    """This holds whichever sample comes first."""
    case = shipped("fgfbstts/both_errors")
    for order in (["rigid", "free"], ["free", "rigid"]):
        found = ls.solve_many(
            case, {"gears.4.support": order}, positions=[1], keep=["displacement"]
        )
        assert "4" in found.gear.values
        moved = np.abs(found.displacement.sel(gear="4").values[:, 0]).max(axis=1)
        assert moved[order.index("free")] > 1e-7
        assert moved[order.index("rigid")] == 0.0


def test_blocks_come_one_by_one(monkeypatch):
    """In order and only on demand."""
    small_blocks(monkeypatch, 4)
    solved = []
    real = many.solve_block
    monkeypatch.setattr(many, "solve_block", lambda *args: solved.append(1) or real(*args))
    blocks = solve_blocks(shipped(LIMIT_RING), floats(40), positions=[1], workers=1)
    assert inspect.isgenerator(blocks)
    first = list(islice(blocks, 2))
    assert [b.rows.tolist() for b in first] == [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert len(solved) == 2
    blocks.close()


def test_workers_run_ahead_by_a_block_each_and_no_more(monkeypatch):
    small_blocks(monkeypatch, 2)
    solved = []
    real = many.solve_block
    monkeypatch.setattr(many, "solve_block", lambda *args: solved.append(1) or real(*args))
    blocks = solve_blocks(shipped(LIMIT_RING), floats(40), positions=[1], workers=2)
    next(blocks)
    assert len(solved) <= 4
    assert sum(1 for _ in blocks) == 19


def test_memory_does_not_grow_with_the_blocks(monkeypatch):
    """Twenty-four blocks take no more memory at once than four, except for the input's columns."""
    small_blocks(monkeypatch, 100)
    case = shipped(LIMIT_RING)

    def peak(count: int) -> int:
        samples = floats(count)
        tracemalloc.start()
        try:
            for _ in solve_blocks(case, samples, positions=[1], workers=1, engine="compiled"):
                pass
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    # Data of up to `STATICS.sets` active sets are kept.
    peak(2400)
    # A sample's answer is some 70 numbers; its columns, in and out of SI, are 4 and their copies.
    few, more = peak(400), peak(2400)
    assert more - few < 2000 * 16 * 8


def test_progress_is_reported_after_every_block(monkeypatch):
    small_blocks(monkeypatch, 4)
    reported = []
    ls.solve_many(
        shipped(LIMIT_RING),
        floats(10),
        positions=[1],
        progress=lambda done, total: reported.append((done, total)),
    )
    assert reported == [(4, 10), (8, 10), (10, 10)]


def test_samples_with_other_numbers_of_positions_are_solved_at_their_own():
    case = shipped("fgfbstts/all_elements")
    found = ls.solve_many(case, {"march.steps": [5, 20]})
    assert found.sizes["position"] == 20
    assert found.certified.sum("position").values.tolist() == [5, 20]
    for row, steps in enumerate((5, 20)):
        alone = ls.solve(case.replace({"march.steps": steps}))
        torque = found.torque.isel(sample=row, position=slice(steps))
        np.testing.assert_allclose(torque, alone.dataset.torque, rtol=1e-9)
    assert "sample 0, position 6: the sample has no such position" in found.refused
    only = ls.solve_many(case, {"march.steps": [5, 20]}, positions=[10])
    assert only.certified.values.tolist() == [[False], [True]]
    swept = ls.sweep(case, {"march.steps": [5, 20]})
    assert [len(point.result.positions) for point in swept.points] == [5, 20]
    assert swept.points[1].result.omega == pytest.approx(alone.omega)
    late = ls.sweep(case, {"march.steps": [5, 20]}, positions=[10])
    assert [point.status for point in late.points] == ["refused", "certified"]


def test_gears_keep_their_names_whichever_end_drives():
    case = shipped("planetary/four_planets")
    samples = {
        "operating.input": ["sun", "carrier"],
        "operating.output": ["carrier", "sun"],
        "operating.torque": ["1000 N*m", "6000 N*m"],
    }
    found = ls.solve_many(case, samples, least_norm=True, keep=KEPT)
    for row in range(2):
        alone = ls.solve(case.replace({key: values[row] for key, values in samples.items()}))
        for gear in found.gear.values:
            moved = found.displacement.isel(sample=row).sel(gear=gear)
            np.testing.assert_allclose(moved, alone.dataset.displacement.sel(gear=gear), atol=1e-15)


def test_extremes_need_not_go_together():
    """No sample is rigid, although b or c of some are zero."""
    case = shipped("star/floating_sun_3")
    mesh = next(iter(case.meshes))
    case = case.replace(
        {f'meshes."{mesh}".stiffness': None, f'meshes."{mesh}".law': {"b": "1e-6 rad/(N*m)"}}
    )
    b, c = f'meshes."{mesh}".law.b [rad/(N*m)]', f'meshes."{mesh}".law.c [rad/(N*m)^(2/3)]'
    found = ls.solve_many(case, {b: [9e-7, 0.0, 1e-7], c: [0.0, 2e-6, 0.0]})
    assert found.certified.all()
    with pytest.raises(ls.CaseError, match=r"both 0.* In sample 2, counted from 0\."):
        ls.solve_many(case, {b: [9e-7, 0.0, 0.0], c: [0.0, 2e-6, 0.0]})


def test_what_is_wrong_with_a_sample_is_told_with_its_number():
    """Of each of its problems: which meshes lack a backlash hangs on the torque of the sample."""
    case = shipped(LIMIT_RING).replace({'meshes."1-2".backlash': "100 um"})
    with pytest.raises(ls.CaseError, match=r"1-3\S*backlash: is missing") as caught:
        ls.solve_many(case, {"operating.power [kW]": [2000.0, 1500.0, -500.0]})
    assert {p.hint.rpartition(" In ")[2] for p in caught.value.problems} == {
        "sample 2, counted from 0."
    }


def test_shares_are_computed_when_they_are_read(tmp_path):
    case, samples = shipped(LIMIT_RING), floats(40)
    meshes = [*case.meshes]
    found = ls.solve_many(case, samples)
    alone = ls.solve(case.replace({key.split(" [")[0]: f"{v[7]} um" for key, v in samples.items()}))
    for name in ("share", "pair_share"):
        one = found[name].isel(sample=7)
        for p, position in enumerate(alone.positions):
            expected = getattr(position, name)
            assert one.isel(position=p).values == pytest.approx(
                [np.nan if expected.get(m) is None else expected[m] for m in meshes],
                rel=1e-9,
                nan_ok=True,
            )
        part = found[name].isel(sample=[3, 1], mesh=slice(2, None, 3)).sel(position=4)
        whole = found[name].values
        np.testing.assert_array_equal(part, whole[[3, 1], 3, 2::3])
    again = ls.solve_many(case, samples)
    assert pickle.loads(pickle.dumps(again)).identical(found)
    again.to_netcdf(tmp_path / "found.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "found.nc", engine="h5netcdf") as read:
        np.testing.assert_array_equal(read.share, found.share)


def test_wide_trains_are_solved_in_smaller_blocks():
    """Larger arrays than glibc reuses would be allocated anew, page by page."""
    few, wide = (machine.Machine(build_train(families.split_torque(n))) for n in (8, 64))
    assert few.together == JOB.together
    places = 8 * 3 * len(wide.train.gears)
    assert places * wide.together <= JOB.allocated < places * (wide.together + 1)


def test_the_clocking_of_a_rigid_shaft_varies_within_a_batch():
    """It shifts the flanks of one gear, and where that gear is at zero coordinates."""
    rigid = {f"shafts.wheel{p}-pinion{p}.stiffness": "rigid" for p in "AB"}
    case = shipped("two_path/clocking_error").replace(rigid)
    key, clockings = "shafts.wheelA-pinionA.clocking", [-5.0, -1.0, 0.0, 0.7, 5.0]
    assert len(samples_of(case, {f"{key} [mrad]": clockings})) == 1
    found = ls.solve_many(case, {f"{key} [mrad]": clockings}, positions=[1])
    torques = found.torque.sel(position=1, mesh="in-wheelA").values
    for torque, clocking in zip(torques, clockings, strict=True):
        (alone,) = ls.solve(case.replace({key: f"{clocking} mrad"}), positions=[1]).positions
        assert torque == pytest.approx(alone.torque["in-wheelA"], rel=1e-12, abs=1e-9)
    # Clocked by more than the meshes yield, one path carries all or nothing.
    assert torques[0] == pytest.approx(367.0, rel=1e-12)
    assert abs(torques[-1]) < 1e-9


def test_the_first_batch_of_a_process_does_not_import_dask():
    code = (
        f"import sys, loadshare as ls; case = {str(CASES / 'fgfbstts/base.toml')!r}; "
        "ls.solve_many(case, {'operating.power [kW]': [1900.0]}); "
        "sys.exit('dask.array' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
