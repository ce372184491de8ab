"""The common period of several stages: closed forms, and a march written explicitly.

Source: formulation, section 13.
"""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from tests.cli.conftest import on_a_screen_of
from tests.support import shipped
from tests.train.test_phases import planetary

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.report.words import period_text
from loadshare.train import build_train
from loadshare.train.period import period_of

PINION, WHEEL, SMALL, BULL = 23, 60, 19, 90
"""Teeth of a split path: 23 to 60, and on the same shafts 19 to 90, module 2 mm."""


def split_path(positions: int = 4, **changes: object) -> ls.Case:
    """Return two branches of two stages with mesh stiffnesses that vary over their cycles."""
    first, second, between = PINION + WHEEL, SMALL + BULL, 150.0
    angle = math.acos((first**2 + between**2 - second**2) / (2.0 * first * between))
    gears: dict[str, dict] = {
        "p": {"teeth": PINION, "centre": ["0 mm", "0 mm"]},
        "bull": {"teeth": BULL, "centre": [f"{between} mm", "0 mm", "80 mm"]},
    }
    for k, way in ((1, 1.0), (2, -1.0)):
        centre = [f"{v:.17g} mm" for v in (first * math.cos(angle), way * first * math.sin(angle))]
        # The wheels are side by side, because their tip circles overlap.
        gears[f"a{k}"] = {"teeth": WHEEL, "centre": [*centre, f"{20 * k} mm"]}
        gears[f"b{k}"] = {"teeth": SMALL, "centre": [*centre, "80 mm"]}
    swing = [1.0 + 0.2 * math.sin(2.0 * math.pi * k / positions) for k in range(positions)]
    laws = [[f"{k * s:.17g} N*m/rad" for s in swing] for k in (1e6, 8e5)]
    meshes = {}
    for k, phase in ((1, 0.0), (2, 0.3)):
        meshes[f"p-a{k}"] = {"stiffness": laws[0], "phase": phase}
        meshes[f"b{k}-bull"] = {"stiffness": laws[1], "phase": 0.7 * phase}
    return ls.Case(
        {
            "operating": {
                "input": "p",
                "output": "bull",
                "torque": "100 N*m",
                "positions": positions,
                "cycle": "common",
            },
            "gears": {name: {"module": "2 mm", **gear} for name, gear in gears.items()},
            "meshes": meshes,
            "shafts": {f"a{k}-b{k}": {"stiffness": "4e5 N*m/rad"} for k in (1, 2)},
            "stages": {"I": {"meshes": ["p-a1", "p-a2"]}},
        }
    ).replace(changes)


def chain(*teeth: int, **operating: object) -> ls.Case:
    """Return stages in series, module 2 mm, from the teeth of driver and driven gear of each."""
    gears, meshes, shafts, place = {}, {}, {}, 0.0
    for k, (driver, driven) in enumerate(zip(teeth[::2], teeth[1::2], strict=True)):
        names = f"{2 * k + 1}", f"{2 * k + 2}"
        for name, count in zip(names, (driver, driven), strict=True):
            centre = [f"{place} mm", "0 mm", f"{60 * k} mm"]
            gears[name] = {"teeth": count, "module": "2 mm", "centre": centre}
            place += driver + driven if name == names[0] else 0.0
        meshes["-".join(names)] = {"stiffness": "1e6 N*m/rad"}
        if k:
            shafts[f"{2 * k}-{names[0]}"] = {"stiffness": "1e5 N*m/rad"}
    given = {"input": "1", "output": f"{len(teeth)}", "torque": "10 N*m", "cycle": "common"}
    return ls.Case(operating=given | operating, gears=gears, meshes=meshes, shafts=shafts)


@pytest.mark.parametrize("teeth", [(17, 31, 19, 43), (20, 40, 20, 60), (18, 32, 64, 30)])
def test_two_stages_come_round_after_the_common_multiple_of_their_teeth(teeth) -> None:
    """The middle shaft relates z₂ teeth to z₃: after z₂ z₃/gcd of them both are whole."""
    period = build_train(chain(*teeth)).period
    common = math.lcm(teeth[1], teeth[2])
    assert period.cycles == {"1-2": common // teeth[2], "3-4": common // teeth[1]}
    assert period.revolutions == Fraction(common // teeth[2], teeth[0])


def test_three_stages_come_round_at_the_first_time_at_which_all_do() -> None:
    teeth = (17, 31, 19, 43, 23, 29)
    period = build_train(chain(*teeth)).period
    speeds = [Fraction(1), Fraction(17, 31), Fraction(17 * 19, 31 * 43)]
    per_turn = [z * speed for z, speed in zip(teeth[::2], speeds, strict=True)]
    assert list(period.cycles.values()) == [q * period.revolutions for q in per_turn]
    assert math.gcd(*period.cycles.values()) == 1


def test_all_meshes_of_a_planetary_set_keep_step() -> None:
    """While the sun turns once inside a held ring, every mesh has z_s z_r/(z_s + z_r) cycles."""
    angles = ["0 deg", "120 deg", "240 deg"]
    case = planetary(18, 36, 90, angles, **{"operating.cycle": "common", "operating.positions": 7})
    train = build_train(case)
    assert set(train.period.cycles.values()) == {1}
    assert train.period.revolutions == Fraction(18 + 90, 18 * 90)
    # The common cycle is then the cycle of one pitch.
    other = build_train(case.replace({"operating.cycle": None}))
    assert train.count == other.count == 7
    for k in range(1, 8):
        assert train.mesh_positions(k) == other.mesh_positions(k)


def test_a_gearbox_of_planetary_stages_has_a_common_period() -> None:
    """By Willis: the mesh frequencies are z_r (carrier), multiplied from stage to stage."""
    case = shipped("nrel_5mw/gearbox")
    counts = {name: gear.teeth for name, gear in case.gears.items() if gear.teeth}
    speed, expected = Fraction(1), {}
    for k in (1, 2):
        expected[k] = counts[f"ring_{k}"] * speed
        speed *= 1 + Fraction(counts[f"ring_{k}"], counts[f"sun_{k}"])
    expected[3] = counts["wheel"] * speed
    period = period_of(
        build_train(case).gears,
        {name: mesh.ends for name, mesh in case.meshes.items()},
        {name: shaft.ends for name, shaft in case.shafts.items()},
        counts,
        case.operating.input,
    )
    for name, cycles in period.cycles.items():
        stage = 3 if name == "wheel-pinion" else int(name.split("_")[1][0])
        assert cycles == expected[stage] * period.revolutions
    assert math.gcd(*period.cycles.values()) == 1
    # The teeth have no common factor: the period is too long to be stored, and is reported.
    message = rf"after {period.cycles[period.fastest]} cycles of mesh wheel-pinion"
    with pytest.raises(CaseError, match=message):
        build_train(case.replace({"operating.cycle": "common"}))


def test_load_is_shared_as_in_a_march_over_the_same_way() -> None:
    """Bit for bit: each mesh is at the position of the march, and the machine is the same."""
    case = split_path()
    period = build_train(case).period
    assert period.cycles == {"p-a1": WHEEL, "p-a2": WHEEL, "b1-bull": SMALL, "b2-bull": SMALL}
    steps = 4 * WHEEL
    found = ls.solve(case)
    assert len(found.positions) == steps
    march = {"gear": "p", "revolutions": WHEEL / PINION, "steps": steps}
    marched = ls.solve(case.replace({"operating.cycle": None, "march": march}))
    for one, other in zip(found.positions, marched.positions, strict=True):
        assert one.mesh_position == other.mesh_position
        assert one.torque == pytest.approx(other.torque, rel=1e-12)
    assert found.omega["I"] == pytest.approx(marched.omega["I"], rel=1e-12)
    # If all meshes go through their positions together, the worst combination of the stages is
    # missed.
    together = ls.solve(case.replace({"operating.cycle": None}))
    assert found.omega["I"] > together.omega["I"] + 1e-3


def test_places_are_those_of_fractions() -> None:
    """Round-off misses no step over thousands of cycles."""
    train = build_train(chain(17, 31, 19, 43, positions=5))
    cycles = train.period.cycles
    for step in range(0, train.count, 7):
        expected = {m: int(Fraction(5 * step * c, train.count)) % 5 for m, c in cycles.items()}
        assert train.mesh_positions(step + 1) == expected
    turned = train.rotations(train.count)["1"] * train.count / (train.count - 1)
    assert turned == pytest.approx(2.0 * math.pi * 31 / 17)


@pytest.mark.parametrize(
    ("positions", "change", "message"),
    [
        (
            1000,
            {},
            'operating.cycle = "common": all meshes complete whole cycles after 60 cycles of mesh '
            "p-a1 (2.6087 revolutions of gear p); with 1000 positions in each cycle, these are "
            "60000 positions. "
            "Allowed: up to 20000 positions. Give a march over part of it or "
            "operating.positions = 333.",
        ),
        (
            4,
            {"measured": {"gauge": {"position": 300, "omega": {"I": 1.1}, "uncertainty": 0.01}}},
            "measured.gauge.position = 300: the case has positions 1 to 240. Allowed: 1 to 240.",
        ),
    ],
)
def test_what_cannot_be_is_reported(positions, change, message) -> None:
    with pytest.raises(CaseError) as caught:
        build_train(split_path(positions).replace(change))
    assert message in str(caught.value)


def test_stiffness_lists_fit_the_positions_of_a_cycle_still() -> None:
    with pytest.raises(CaseError, match=r"operating\.positions is 1000"):
        split_path(4, **{"operating.positions": 1000})


def test_gears_without_teeth_have_no_common_period() -> None:
    case = shipped("branches/split_torque_2")
    with pytest.raises(CaseError, match=r"gears\.in\.teeth: does not follow"):
        build_train(case.replace({"operating.cycle": "common"}))


def test_a_march_goes_its_own_way() -> None:
    case = split_path(march={"gear": "p", "revolutions": 1.0, "steps": 5})
    train = build_train(case)
    assert train.count == 5
    assert train.period is None


def test_the_command_tells_the_period(tmp_path) -> None:
    path = tmp_path / "box.toml"
    path.write_text(chain(20, 40, 20, 60).to_toml(), encoding="utf-8")
    done = on_a_screen_of(200)("run", path)
    assert "2 cycles of mesh 1-2, 0.1 revolutions of gear 1" in done.stdout


def test_a_period_of_one_cycle_is_told_in_the_singular() -> None:
    case = shipped("planetary/four_planets").replace({"operating.cycle": "common"})
    period = build_train(case).period
    assert period is not None
    assert ": 1 cycle of mesh" in period_text(period, "sun")
