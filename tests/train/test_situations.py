"""Situations of many samples: stacked, taken apart, and equal to the train's own numbers."""

import math
from dataclasses import fields

import numpy as np
import pytest
from tests.support import EVERY_SHIPPED, round_ring, shipped

import loadshare as ls
from benchmarks import families
from loadshare.contact.law import PowerLaw
from loadshare.train import build_train
from loadshare.train.ring import DrumRing
from loadshare.train.situations import Situations, arcs_from, situation_of, stack

ARRAYS = tuple(f.name for f in fields(Situations) if f.name not in ("train", "count"))


def row(situations: Situations, sample: int) -> dict[str, np.ndarray]:
    """Return the numbers of one sample."""
    found = {name: getattr(situations, name) for name in ARRAYS}
    return {name: v[sample if len(v) > 1 else 0] for name, v in found.items()}


def same(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    for name in ARRAYS:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)


@pytest.mark.parametrize("name", EVERY_SHIPPED)
def test_a_stack_holds_every_position(name):
    train = build_train(shipped(name))
    single = [situation_of(train, k) for k in range(1, train.count + 1)]
    together = stack(single)
    assert together.count == train.count
    for k, alone in enumerate(single):
        same(row(together, k), row(alone, 0))


def test_what_does_not_vary_is_kept_once():
    train = build_train(shipped("fgfbstts/eccentricity"))
    together = stack([situation_of(train, k) for k in range(1, train.count + 1)])
    assert len(together.offset) == train.count
    assert len(together.torque) == len(together.bending) == len(together.spline) == 1


def test_samples_can_be_taken_out():
    train = build_train(shipped("fgfbstts/eccentricity"))
    together = stack([situation_of(train, k) for k in range(1, train.count + 1)])
    for rows in (np.array([5, 2, 2]), slice(3, 7)):
        some = together.take(rows)
        numbers = np.arange(train.count)[rows]
        assert some.count == len(numbers)
        for k, number in enumerate(numbers):
            same(row(some, k), row(together, number))


def test_a_stack_of_stacks_is_the_stack():
    train = build_train(shipped("fgfbstts/all_elements"))
    single = [situation_of(train, k) for k in range(1, 7)]
    once, twice = stack(single), stack([stack(single[:2]), stack(single[2:3]), stack(single[3:])])
    assert once.count == twice.count
    for k in range(6):
        same(row(once, k), row(twice, k))


def test_tables_of_different_length_stand_side_by_side():
    """Shorter ones are padded with NaN, between meshes and between samples."""
    data = families.star(3).to_dict() | {"assumed": []}
    long = {"torque": ["1 N*m", "2 N*m", "4 N*m"], "deflection": ["1 urad", "3 urad", "7 urad"]}
    short = {"torque": ["5 N*m"], "deflection": ["5 urad"]}
    first, second, *_ = data["meshes"].values()
    for mesh, table in ((first, long), (second, short)):
        del mesh["stiffness"]
        mesh["table"] = table
    train = build_train(ls.Case(data))
    meshes = list(train.meshes.values())
    table = situation_of(train, 1).table
    assert table.shape == (1, len(meshes), 2, 4)
    radius = meshes[0].radii[0]
    np.testing.assert_allclose(table[0, 0, 0], np.array([0.0, 1.0, 2.0, 4.0]) / radius, rtol=1e-15)
    np.testing.assert_allclose(table[0, 0, 1], np.array([0, 1e-6, 3e-6, 7e-6]) * radius, rtol=1e-14)
    assert np.isfinite(table[0, 1]).sum() == 4
    assert not table[0, 2].any(), "a mesh without a table"
    assert isinstance(meshes[2].laws[0], PowerLaw)


def test_the_arrays_tell_what_the_train_tells():
    """Every number is recomputed by the train's own methods, for the case with every element."""
    train = build_train(shipped("fgfbstts/all_elements"))
    for index in (1, 4):
        found, here = row(situation_of(train, index), 0), situation_of(train, index)
        turned, places = train.rotations(index), train.flank_positions(index)
        for g, (name, gear) in enumerate(train.gears.items()):
            offset = np.zeros(3)
            if name in train.offsets:
                offset = train.offsets[name].at(gear, turned[name])
            np.testing.assert_array_equal(found["offset"][g], offset)
            np.testing.assert_array_equal(here.offset_of(name), offset)
            driving = train.input_torque[0] if name == train.input else 0.0
            torque = train.external.get(name, 0.0) + driving
            assert found["torque"][g] == here.torques[name] == torque
        flanks = [(m, d) for m in train.meshes.values() for d in m.flanks]
        for e, (mesh, drive) in enumerate(flanks):
            place = places[mesh.flank_name(drive)]
            law = mesh.law(place)
            assert (found["bending"][e], found["hertz"][e]) == (law.b, law.c)
            assert found["gap"][e] == mesh.gap(place, drive)
        for s, shaft in enumerate(train.shafts.values()):
            assert (found["clocking"][s], found["torsion"][s]) == (shaft.clocking, shaft.stiffness)
        drums = [r for r in train.rings.values() if isinstance(r, DrumRing)]
        for d, ring in enumerate(drums):
            assert tuple(found["stop"][d]) == (ring.up, ring.down)
            assert tuple(found["arc_clearance"][d]) == ring.clearances
            assert found["wall"][d] == (
                0.0 if math.isinf(ring.stiffness) else pytest.approx(1.0 / ring.stiffness)
            )
            for side in (0, 1):
                arc = here.arc(ring, side)
                np.testing.assert_array_equal(found["arc_shift"][d, side], arc.shift)
                assert arc.clearance == ring.clearances[side]


def test_arcs_follow_the_errors_where_rings_are_measured_without_them():
    case = shipped("fgfbstts/limit_ring")
    nominal = case.replace({"rings.4.measured": "nominal"})
    train = build_train(nominal)
    base = situation_of(train, 1)
    np.testing.assert_allclose(arcs_from(train, base.offset), base.arc_shift, atol=1e-18)
    assert base.arc_shift[0, 0].any()
    assert not base.arc_shift[0, 1].any(), "ring 5 is set with the errors in place"
    assert not arcs_from(build_train(case), base.offset).any()


def test_round_rings_are_counted_apart():
    found = situation_of(build_train(round_ring("5e8 N/m")), 1)
    assert found.stop.shape == (1, 0, 2)
    np.testing.assert_array_equal(found.round_radius, [[3e-6]])
    np.testing.assert_array_equal(found.round_stiffness, [[5e8]])
