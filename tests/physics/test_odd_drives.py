"""Drives with circulating power and other unusual ones, against rigid bodies in contact."""

from __future__ import annotations

import tomllib
from collections.abc import Callable

import numpy as np
import pytest
from tests.physics.drives import MODULE, Drive

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.train import build_train

Built = tuple[Drive, str, str]
"""A drive, its input, its output."""


def simple_set(drive: Drive, tag: str, sun: int, planet: int, planets: int = 3) -> None:
    """Add a sun, planets and a ring."""
    drive.gear(f"s{tag}", sun)
    drive.gear(f"r{tag}", -(sun + 2 * planet))
    drive.carrier(f"c{tag}")
    distance = 0.5 * MODULE * (sun + planet)
    for (name,) in drive.planets(f"c{tag}", {f"p{tag}": planet}, distance, planets):
        drive.mesh(f"s{tag}", name)
        drive.mesh(name, f"r{tag}", 6e8)


def double_set(drive: Drive, tag: str) -> None:
    """Add a set with two planets in series on every path from sun to ring."""
    drive.gear(f"s{tag}", 30)
    drive.carrier(f"c{tag}")
    inner = 0.5 * MODULE * 50
    reach = 0.0
    for k in range(3):
        turn = 2.0 * np.pi * k / 3.0
        near = inner * np.array([np.cos(turn), np.sin(turn)])
        way = np.array([np.cos(turn + 0.9), np.sin(turn + 0.9)])
        far = near + 0.5 * MODULE * 40 * way
        reach = float(np.hypot(*far))
        drive.gear(f"p{tag}{k}", 20, tuple(near), carrier=f"c{tag}")
        drive.gear(f"q{tag}{k}", 20, tuple(far), carrier=f"c{tag}")
    drive.gear(f"r{tag}", -round(2.0 * reach / MODULE) - 20)
    # Any radius that fits: tooth numbers do not matter here.
    for k in range(3):
        way = drive.places[f"q{tag}{k}"] / reach
        where = 0.5 * MODULE * (-drive.teeth[f"r{tag}"] - 20) * way
        drive.places[f"q{tag}{k}"] = where
        drive.gears[f"q{tag}{k}"]["centre"] = [f"{v:.17g} m" for v in where]
        # The inner planet is where it meshes with both.
        out = float(np.hypot(*where))
        a, b = inner, 0.5 * MODULE * 40
        along = (out**2 + a**2 - b**2) / (2.0 * out)
        aside = -np.sqrt(a**2 - along**2)
        near = along * way + aside * np.array([-way[1], way[0]])
        drive.places[f"p{tag}{k}"] = near
        drive.gears[f"p{tag}{k}"]["centre"] = [f"{v:.17g} m" for v in near]
        drive.mesh(f"s{tag}", f"p{tag}{k}")
        drive.mesh(f"p{tag}{k}", f"q{tag}{k}")
        drive.mesh(f"q{tag}{k}", f"r{tag}", 6e8)


def simple_beside_double(backlash: float | None) -> Built:
    """Return suns on one shaft, rings on another: seen from the carriers, they turn oppositely."""
    drive = Drive(backlash)
    simple_set(drive, "1", 24, 24)
    double_set(drive, "2")
    drive.gears["c2"]["held"] = True
    drive.shaft("s1", "s2")
    drive.shaft("r1", "r2", 5e6)
    drive.support("s1", 3e8)
    return drive, "s1", "c1"


def layshaft(backlash: float | None) -> Built:
    """Return a power split: a layshaft drives the ring in the sense of the sun's shaft."""
    drive = Drive(backlash)
    simple_set(drive, "1", 24, 24)
    drive.gear("in", 30)
    drive.gear("outer", 80)
    # Both gears of the layshaft are on one axis, so their distances from the centre are equal.
    drive.gear("lay2", 30, (0.5 * MODULE * 110, 0.0))
    drive.gear("lay1", 80, (0.5 * MODULE * 110, 0.0))
    drive.mesh("in", "lay1")
    drive.mesh("lay2", "outer")
    drive.shaft("in", "s1")
    drive.shaft("lay1", "lay2")
    drive.shaft("outer", "r1")
    drive.support("s1", 2e8)
    drive.support("c1", 5e8)
    return drive, "in", "c1"


def recirculating(backlash: float | None) -> Built:
    """Return a layshaft driving the carrier against the ring: more power circulates than enters."""
    drive = Drive(backlash)
    simple_set(drive, "1", 24, 24, 4)
    drive.gear("in", 30)
    drive.gear("outer", 34)
    drive.gear("lay1", 80, (0.5 * MODULE * 110, 0.0))
    drive.gear("lay2", 76, (0.5 * MODULE * 110, 0.0))
    drive.mesh("in", "lay1")
    drive.mesh("lay2", "outer")
    drive.shaft("in", "s1")
    drive.shaft("lay1", "lay2")
    drive.shaft("outer", "c1")
    drive.support("s1", 2e8)
    return drive, "in", "r1"


def simpson(backlash: float | None) -> Built:
    """Return a Simpson set in low gear: both suns on one shaft, first carrier with second ring."""
    drive = Drive(backlash)
    simple_set(drive, "1", 30, 21)
    simple_set(drive, "2", 30, 21)
    drive.shaft("s1", "s2")
    drive.shaft("c1", "r2")
    drive.gears["c2"]["held"] = True
    drive.support("s2", 1e8)
    return drive, "r1", "c1"


def behind_double(backlash: float | None) -> Built:
    """Return two branches behind a set whose ring turns oppositely as seen from the carrier."""
    drive = Drive(backlash)
    double_set(drive, "1")
    drive.gears["s1"]["held"] = True
    drive.gear("out", 30)
    apart = -drive.teeth["r1"] - 30
    for name, way in (("a", 1.0), ("b", -1.0)):
        at = (0.0, way * 0.5 * MODULE * apart)
        drive.gear(f"{name}1", 30, at)
        drive.gear(f"{name}2", apart - 30, at)
        drive.mesh("r1", f"{name}1")
        drive.mesh(f"{name}2", "out")
        drive.shaft(f"{name}1", f"{name}2")
    return drive, "c1", "out"


def sun_with_layshaft(backlash: float | None) -> Built:
    """Return a sun that meshes with its planets and, in the housing, with the ring's layshaft."""
    drive = Drive(backlash)
    simple_set(drive, "1", 24, 24)
    drive.gear("lay1", 80, (0.5 * MODULE * 104, 0.0))
    drive.gear("lay2", 30, (0.5 * MODULE * 104, 0.0))
    drive.gear("outer", 74)
    drive.mesh("s1", "lay1")
    drive.mesh("lay2", "outer")
    drive.shaft("lay1", "lay2")
    drive.shaft("outer", "r1")
    return drive, "s1", "c1"


LOOPS: dict[str, Callable[[float | None], Built]] = {
    f.__name__: f
    for f in (
        simple_beside_double,
        layshaft,
        recirculating,
        simpson,
        behind_double,
        sun_with_layshaft,
    )
}


@pytest.mark.parametrize("backlash", [None, 8e-5])
@pytest.mark.parametrize("torque", [700.0, -700.0])
@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.quick(4)
def test_a_loop_over_sets_is_that_of_rigid_bodies(
    name: str, torque: float, backlash: float | None
) -> None:
    drive, driving, output = LOOPS[name](backlash)
    case = drive.case(driving, output, torque)
    train = build_train(case)
    held = {n for n, g in drive.gears.items() if g.get("held")}
    speeds = drive.machine().speeds(driving, held)
    mine = {n: g.sense * g.ratio for n, g in train.gears.items()}
    assert mine == pytest.approx(speeds, abs=1e-11 * max(map(abs, speeds.values())))

    found = ls.solve(case).positions[0]
    forces = found.equilibrium.flank_force
    ways: dict[str, int] = {}
    for mesh in train.meshes.values():
        first, _, _ = drive.meshes[mesh.name]
        carrier = drive.gears[drive.meshes[mesh.name][0]].get("carrier")
        carrier = carrier or drive.gears[drive.meshes[mesh.name][1]].get("carrier")
        relative = speeds[first] - (speeds[carrier] if carrier else 0.0)
        ways[mesh.name] = 1 if relative > 0.0 else -1
        if mesh.named_backwards:
            ways[mesh.name] *= -1
    x, expected = drive.machine(ways).solve({driving: torque}, held | {output})
    most = max(expected.values())
    for mesh in train.meshes.values():
        ccw = ways[mesh.name] > 0
        for flank, drives in ((f"{mesh.name} {'ccw' if ccw else 'cw'}", True),) + (
            ((f"{mesh.name} {'cw' if ccw else 'ccw'}", False),) if backlash else ()
        ):
            assert forces[mesh.flank_name(drives)] == pytest.approx(
                expected[flank], abs=1e-9 * most
            ), flank
    moved = found.equilibrium.displacement
    for body in drive.floats:
        at = 3 * list(drive.places).index(body)
        assert moved[body][:2] == pytest.approx(x[at + 1 : at + 3], abs=1e-12)
    # The power that enters leaves again; the housing takes the difference of the torques.
    outside = found.loads.gears
    assert outside[driving] == pytest.approx(torque)
    power = sum(outside[n] * speeds[n] for n in outside if n not in held)
    assert power == pytest.approx(0.0, abs=1e-8 * abs(torque))


def test_gears_outside_a_set_count_as_they_turn_in_the_housing() -> None:
    drive, driving, output = behind_double(None)
    case = drive.case(driving, output, 500.0)
    even = ls.solve(case).positions[0]
    assert all(even.rotation[gear] > 0.0 for gear in ("c1", "r1", "a1", "a2"))
    assert all(even.torque[mesh] > 0.0 for mesh in ("r1-a1", "a2-out", "r1-b1"))
    # The end of a shaft that lags has to catch up: the other branch carries more meanwhile.
    late = ls.solve(case.replace({"shafts.a1-a2.clocking": "10 urad"})).positions[0]
    change = late.torque["r1-b1"] - even.torque["r1-b1"]
    assert change > 0.02 * even.torque["r1-b1"]
    assert late.torque["r1-a1"] == pytest.approx(even.torque["r1-a1"] - change)


def test_what_cannot_turn_is_refused_with_what_holds_it() -> None:
    drive, _, _ = simple_beside_double(None)
    drive.gears["c1"]["held"] = True
    with pytest.raises(CaseError, match=r"cannot turn.* s1-s2, r1-r2, .*c1 \(held\)") as refused:
        build_train(drive.case("s1", "r1", 100.0))
    assert 'operating.input = "s1"' in str(refused.value)
    drive, driving, _ = layshaft(None)
    drive.gears["c1"]["held"] = True
    with pytest.raises(CaseError, match=r"in-lay1, lay2-outer, .* c1 \(held\) hold one another"):
        build_train(drive.case(driving, "r1", 100.0))


@pytest.mark.parametrize(
    "name", ["simple_beside_double", "layshaft", "recirculating", "sun_with_layshaft"]
)
def test_meshes_of_a_loop_go_through_their_cycles_as_a_march_does(name: str) -> None:
    drive, driving, output = LOOPS[name](None)
    for gear, teeth in drive.teeth.items():
        drive.gears[gear]["teeth"] = abs(teeth)
    common = build_train(drive.case(driving, output, 100.0, cycle="common", positions=8))
    assert common.period is not None
    turns = float(common.period.revolutions)
    march = {"gear": driving, "revolutions": turns, "steps": common.count}
    marched = build_train(drive.case(driving, output, 100.0, positions=8).replace({"march": march}))
    some = np.arange(1, common.count + 1, max(common.count // 500, 1))
    one, other = common.mesh_positions(some), marched.mesh_positions(some)
    for mesh in one:
        # A step between two positions may round either way.
        assert np.mean(one[mesh] == other[mesh]) > 0.98, mesh


def ravigneaux(backlash: float | None) -> Drive:
    """Return short planets between a sun and long planets, which mesh with a sun and the ring."""
    drive = Drive(backlash)
    drive.gear("s1", 24)
    drive.gear("s2", 30)
    drive.gear("r", -70)
    drive.carrier("c")
    far, near, apart = (0.5 * MODULE * z for z in (50, 40, 36))
    for k in range(4):
        turn = 0.5 * np.pi * k
        bent = turn + np.arccos((far**2 + near**2 - apart**2) / (2.0 * far * near))
        drive.gear(f"q{k}", 20, (far * np.cos(turn), far * np.sin(turn)), carrier="c")
        drive.gear(f"p{k}", 16, (near * np.cos(bent), near * np.sin(bent)), carrier="c")
        for pair in (("s1", f"p{k}"), (f"p{k}", f"q{k}"), ("s2", f"q{k}"), (f"q{k}", "r")):
            drive.mesh(*pair)
    return drive


@pytest.mark.parametrize("backlash", [None, 3e-5])
@pytest.mark.parametrize(
    ("driving", "output", "held", "ratio"),
    [
        ("s1", "r", "c", 70 / 24),
        ("s1", "r", "s2", 0.7 + 0.3 * 70 / 24),
        ("s2", "c", "s1", 1.8),
        ("s2", "r", "c", -70 / 30),
        ("s1", "r", "", 1.0),
    ],
)
def test_a_ravigneaux_set_has_its_gears(
    driving: str, output: str, held: str, ratio: float, backlash: float | None
) -> None:
    """In the last, both suns are on one shaft, so that all turns as one piece."""
    drive = ravigneaux(backlash)
    if held:
        drive.gears[held]["held"] = True
    else:
        drive.shaft("s1", "s2")
    case = drive.case(driving, output, 300.0)
    assert 1.0 / build_train(case).gears[output].ratio == pytest.approx(abs(ratio), rel=1e-12)
    position = ls.solve(case).positions[0]
    assert position.loads.gears[output] == pytest.approx(-300.0 * ratio, rel=1e-9)
    assert sum(position.loads.gears.values()) == pytest.approx(0.0, abs=1e-8)


ENGINES = """
[operating]
input = "e1"
output = "bull"
torque = "900 N*m"
external = { e2 = "-300 N*m" }
[gears]
bull = { base_radius = "260 mm", centre = ["0 mm", "0 mm"] }
e1 = { base_radius = "45 mm", centre = { distance = "327 mm", angle = "30 deg" } }
e2 = { base_radius = "45 mm", centre = { distance = "327 mm", angle = "170 deg" } }
[meshes]
e1-bull.stiffness = "3e5 N*m/rad"
e2-bull.stiffness = "3e5 N*m/rad"
"""
ROTORS = """
[operating]
input = "e1"
output = "r1"
torque = "600 N*m"
external = { e2 = "1000 N*m", r2 = "-2400 N*m" }
[gears]
e1 = { base_radius = "40 mm", centre = ["0 mm", "170 mm"] }
r1 = { base_radius = "120 mm", centre = ["0 mm", "0 mm"] }
i1 = { base_radius = "50 mm", centre = ["181 mm", "0 mm"] }
i2 = { base_radius = "50 mm", centre = ["181 mm", "0 mm", "2 m"] }
r2 = { base_radius = "120 mm", centre = ["0 mm", "0 mm", "2 m"] }
e2 = { base_radius = "40 mm", centre = ["0 mm", "170 mm", "2 m"] }
[meshes]
e1-r1.stiffness = "3e5 N*m/rad"
e2-r2.stiffness = "3e5 N*m/rad"
r1-i1.stiffness = "3e5 N*m/rad"
i2-r2.stiffness = "3e5 N*m/rad"
[shafts]
i1-i2.stiffness = "1e4 N*m/rad"
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (ENGINES, {"e1-bull": 900.0, "e2-bull": -300.0}),
        # The second rotor takes 3000 from its engine and returns 600 through the shaft, 600·50/120
        # at its gears.
        (ROTORS, {"e1-r1": 600.0, "e2-r2": 1000.0, "r1-i1": -600.0, "i2-r2": -250.0}),
    ],
    ids=["an engine that brakes", "power against the names"],
)
def test_torques_from_outside_press_the_flanks_that_statics_tells(text, expected):
    """Without a backlash, each mesh has one flank; with a backlash, it has both."""
    case = ls.Case(tomllib.loads(text))
    assert ls.solve(case).positions[0].torque == pytest.approx(expected, rel=1e-12)
    both = case.replace({f'meshes."{name}".backlash': "20 um" for name in expected})
    assert ls.solve(both).positions[0].torque == pytest.approx(expected, rel=1e-9)
    key = "operating.external.e2"
    torque = case.operating.external["e2"].si
    found = ls.solve_many(case.replace({key: "1 N*m"}), {f"{key} [N*m]": [torque, torque]})
    assert found.torque[1, 0].values == pytest.approx(list(expected.values()), rel=1e-12)
