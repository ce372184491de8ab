"""A scene: which quantities become coordinates or rows, which do not, and why; and its programme.

Source: formulation, sections 4 and 11.
"""

import numpy as np
import pytest
from tests.certify.oracle import approach
from tests.support import (
    answer,
    driver_torques,
    furthest,
    round_ring,
    shipped,
    with_backlash,
)

from benchmarks import families
from loadshare.contact.plan import Linearisation, Role, programme
from loadshare.scene import Plan, assemble
from loadshare.scene.scene import Scene
from loadshare.train import build_train
from loadshare.train.situations import situation_of


def scene_of(name: str, index: int = 1) -> Scene:
    return assemble(build_train(shipped(name)), index)


def at_rest(scene: Scene) -> Linearisation:
    rows = [r.name for r in scene.rows] + [a.name for a in scene.arcs]
    laws = {r.name: r.law(1000.0) for r in scene.radials}
    return Linearisation(np.zeros(scene.size), dict.fromkeys(rows, (1e-9, 0.0)), laws)


def test_a_rigid_train_has_one_coordinate_per_gear_but_the_output():
    scene = scene_of("fgfbstts/base")
    assert scene.coordinates == tuple(f"gear {g} rotation" for g in "123456789")
    assert len(scene.rows) == 10
    reasons = dict(scene.removed)
    assert reasons["gear 10 rotation"] == "the output gear is held"
    assert reasons["gear 4 x, y"] == "its bearing is rigid"
    assert "no backlash given" in reasons["4-6 coast"]


def test_floats_bring_two_coordinates_each():
    scene = scene_of("fgfbstts/limit_ring")
    assert {"gear 1 x", "gear 1 y", "gear 4 x", "gear 5 y"} <= set(scene.coordinates)
    assert scene.size == 9 + 6
    assert [a.name for a in scene.arcs] == [
        "ring 4: arc 7", "ring 4: arc 6", "ring 5: arc 9", "ring 5: arc 8",
    ]  # fmt: skip
    assert {r.name for r in scene.rows if r.kind == "stop"} == {
        f"ring {g}: {side} stop" for g in "45" for side in ("upper", "lower")
    }


def test_splines_and_round_rings_are_radial():
    assert [r.name for r in scene_of("fgfbstts/full_float").radials] == ["spline 4", "spline 5"]
    assert [r.name for r in assemble(build_train(round_ring()), 1).radials] == ["ring sun"]


def test_a_rigid_shaft_joins_two_rotations():
    case = shipped("fgfbstts/base").replace({'shafts."2-4".stiffness': "rigid"})
    scene = assemble(build_train(case), 1)
    assert "gear 4 rotation" not in scene.coordinates or "gear 2 rotation" not in scene.coordinates
    assert ("rigid shaft 2-4") in dict(scene.removed).values()


@pytest.mark.parametrize("clocking", ["0 rad", "0.3 mrad"])
def test_a_stiff_shaft_becomes_rigid_to_first_order(clocking):
    """Clocking included: a shaft of 1e9 yields its torque over its stiffness, 1e-3 of meshes."""

    def torques(stiffness: str) -> dict[str, float]:
        changes = {f"shafts.wheel{p}-pinion{p}.stiffness": stiffness for p in "AB"}
        uneven = {"meshes.in-wheelA.gap": "0.1 mrad"}
        return driver_torques(families.two_path(clocking).replace(changes | uneven))

    rigid = torques("rigid")
    assert rigid["in-wheelA"] < rigid["in-wheelB"]
    errors = [furthest(rigid, torques(f"{k!r} N*m/rad")) for k in (1e8, 1e9)]
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.01)


@pytest.mark.parametrize(
    "name", ["fgfbstts/limit_ring", "fgfbstts/all_elements", "star/floating_sun_4"]
)
def test_a_programme_is_dimensionless_with_rows_of_unit_norm(name):
    """Numbers are near 1 for any solver: rows have norm 1, and the median compliance of a drive
    flank is of order 1.
    """
    scene = scene_of(name)
    written, units = programme(scene, Plan.full(scene), at_rest(scene))
    assert np.linalg.norm(written.rows, axis=1) == pytest.approx(np.ones(len(written.names)))
    assert written.names == tuple(r.name for r in scene.rows) + tuple(a.name for a in scene.arcs)
    assert np.abs(written.load).max() == pytest.approx(1.0)
    assert written.stiffness == pytest.approx(written.stiffness.T)
    assert np.linalg.eigvalsh(written.stiffness).min() >= -1e-12 * np.abs(written.stiffness).max()
    assert units.row_norms.min() > 0.0


def test_plans_say_what_is_in_play():
    scene = scene_of("fgfbstts/all_elements")
    lean, full = Plan.lean(scene), Plan.full(scene)
    assert lean.rows["4-6"] is Role.CLOSED
    assert lean.rows["4-6 coast"] is lean.rows["ring 4: upper stop"] is Role.OPEN
    assert set(full.rows.values()) | set(full.radials.values()) == {Role.IN_PLAY}
    wider = lean.with_in_play({"4-6 coast", "spline 4"})
    assert wider.rows["4-6 coast"] is wider.radials["spline 4"] is Role.IN_PLAY
    assert lean.rows["4-6 coast"] is Role.OPEN


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("fgfbstts/base", "linear"),
        ("fgfbstts/both_errors", "linear"),
        ("fgfbstts/limit_ring", "QP"),
        ("fgfbstts/full_float", "SOCP"),
        ("star/floating_sun_6", "linear"),
    ],
)
def test_no_more_model_than_the_scene_needs(name, kind):
    train = build_train(shipped(name))
    assert answer(train)[1].kind == kind


def test_what_was_removed_is_reported_with_its_margin():
    """Every coast flank that stays open is left out and reported with its gap."""
    train = build_train(with_backlash(shipped("fgfbstts/both_errors"), "1 mm"))
    found, record = answer(train)
    removed = dict(record.removed)
    for mesh in train.meshes.values():
        assert removed[f"{mesh.name} coast"].startswith("open by ")
        carried = found.flank_force[mesh.name]
        assert removed[mesh.name] == f"closed under {carried:.6g} N: a spring, not an inequality"
    assert record.kind == "linear"
    assert record.rounds == 1
    assert {n for n, r in record.plan.rows.items() if r is Role.IN_PLAY} == set()


def test_a_round_that_was_too_lean_is_repeated():
    train = build_train(round_ring())
    _, record = answer(train)
    assert record.rounds > 1
    assert record.plan.radials["ring sun"] is Role.IN_PLAY
    assert "ring sun" not in dict(record.removed)


@pytest.mark.parametrize("name", ["fgfbstts/all_elements", "two_path/clocking_error"])
def test_a_scene_is_what_the_train_says(name):
    """Approaches follow from the mesh's expression, forces from shafts and supports one by one."""
    train = build_train(shipped(name))
    rng = np.random.default_rng(5)
    for index in (1, train.count):
        scene, here = assemble(train, index), situation_of(train, index)
        positions, rows = train.flank_positions(index), {r.name: r for r in scene.rows}
        x = rng.normal(size=scene.size) * 1e-5
        turned = {gear: scene.angle(gear, x) for gear in train.gears}
        moved = {gear: scene.moved(gear, x) for gear in train.gears}
        for mesh in train.meshes.values():
            apart = moved[mesh.driver] - moved[mesh.driven]
            apart = apart + here.offset_of(mesh.driver) - here.offset_of(mesh.driven)
            ends = turned[mesh.driver], turned[mesh.driven]
            for drive in mesh.flanks:
                row = rows[mesh.flank_name(drive)]
                position = positions[row.name]
                expected = approach(mesh, drive, position, ends, apart)
                assert row.vector @ x - row.gap == pytest.approx(expected, abs=1e-17)
                assert row.law.compression(700.0) == pytest.approx(
                    mesh.law(position).compression(700.0), rel=1e-14
                )
        force = scene.stiffness @ x - scene.load
        for gear, end in scene.rotation.items():
            if end.index is not None:
                force[end.index] += here.torques[gear] * end.rate
        for shaft in train.shafts.values():
            if np.isfinite(shaft.stiffness):
                wind = turned[shaft.first] - turned[shaft.second] - shaft.clocking
                for gear, sign in ((shaft.first, 1.0), (shaft.second, -1.0)):
                    end = scene.rotation[gear]
                    if end.index is not None:
                        force[end.index] -= sign * shaft.stiffness * wind * end.rate
        for gear, where in scene.displacement.items():
            force[where] -= train.gears[gear].support * x[where]
        size = np.abs(scene.stiffness).max() * np.abs(x).max()
        assert force == pytest.approx(np.zeros(scene.size), abs=1e-13 * size)
