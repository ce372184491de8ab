"""From a case to a train: senses and conflicts, float ranges, arcs, marches.

Sources: formulation, sections 1, 2 and 6; the seed's reconstruction, point 6.
"""

import math
from decimal import Decimal, localcontext
from itertools import pairwise

import numpy as np
import pytest
from tests.support import shipped, with_backlash

import loadshare as ls
from benchmarks import families
from loadshare.contact.arc import Arc
from loadshare.train import build_train
from loadshare.train.situations import situation_of

# --- Senses and ratios ---


def test_the_senses_of_the_seeds_train():
    """Face gears turn in the same sense although they are on opposite sides of the shaft, pinions
    counter-clockwise, idlers clockwise.
    """
    gears = build_train(shipped("fgfbstts/base")).gears
    assert {n: g.sense for n, g in gears.items()} == {
        "1": 1, "2": 1, "3": 1, "4": 1, "5": 1, "6": -1, "7": -1, "8": -1, "9": -1, "10": 1,
    }  # fmt: skip
    assert 1.0 / gears["4"].ratio == pytest.approx(222.7792 / 40.0)
    assert 1.0 / gears["10"].ratio == pytest.approx(222.7792 / 40.0 * 382.9862 / 45.9)


def test_clockwise_reverses_every_sense():
    case = shipped("fgfbstts/base")
    ahead, back = build_train(case), build_train(case.replace({"operating.running": "clockwise"}))
    assert all(back.gears[n].sense == -g.sense for n, g in ahead.gears.items())


def triangle(third: str = "45 mm") -> dict[str, object]:
    """Return three gears around which a chain of external meshes closes."""
    centre = {"a": ["0 mm", "0 mm"], "b": ["100 mm", "0 mm"], "c": ["50 mm", "86.6025403784 mm"]}
    radius = f"{50 * math.cos(math.radians(20))!r} mm"
    return {
        "gears": {n: {"centre": at, "base_radius": radius} for n, at in centre.items()},
        "meshes": {
            m: {"pressure_angle": "20 deg", "stiffness": "1e6 N*m/rad"}
            for m in ("a-b", "b-c", "a-c")
        },
        "operating": {"input": "a", "output": "c", "torque": "1 N*m"},
    }


def test_a_ring_of_three_gears_locks():
    with pytest.raises(ls.CaseError, match=r"against the sense .* would lock") as refused:
        build_train(ls.Case(triangle()))
    assert all(p.key.startswith("meshes.") for p in refused.value.problems)


def test_paths_of_different_ratio_lock():
    """One wheel is 1 % larger, so its path would turn the output at another speed."""
    case = families.two_path("0 rad")
    grown = {
        "gears.wheelA.base_radius": "94.149683 mm",
        "gears.wheelA.centre": ["67.97679 mm", "106.0 mm"],
    }
    changed = case.replace(
        {**grown, "gears.pinionA.centre": ["67.21679 mm", "105.152 mm", "100 mm"]}
    )
    with pytest.raises(ls.CaseError, match=r"of the input speed, another path at .* would lock"):
        build_train(changed)


# --- Float ranges from backlashes ---


@pytest.mark.parametrize("backlash", [10.0, 25.0])
def test_the_float_range_takes_up_the_backlashes_of_a_chain(backlash):
    """h = Σ j_n divided by the difference of the two flanks' slopes along the float.

    In the reconstruction, the pinion's two lines of action are Δχ apart and their mean is m off its
    centre line; here the pinion is on the line of its idlers, so both slopes are ∓cos α and h = Σ
    j_n/(2 cos α).
    """
    case = with_backlash(shipped("fgfbstts/limit_ring"), f"{backlash} um")
    chains = {"upward": ["4-6", "6-10"], "downward": ["4-7", "7-10"]}
    train = build_train(case.replace({"rings.4.float": chains}))
    angle = math.radians(18.75)
    normal = 2 * backlash * 1e-6 * math.cos(angle)
    # The idlers' angles are given to hundredths of a degree, so the slopes are cos α to 1e-6.
    assert train.rings["4"].up == pytest.approx(normal / (2 * math.cos(angle)), rel=1e-5)
    assert train.rings["4"].down == pytest.approx(train.rings["4"].up, rel=1e-5)


def test_a_chain_must_begin_at_the_limited_gear():
    case = with_backlash(shipped("fgfbstts/limit_ring"), "25 um")
    chains = {"upward": ["6-10", "4-6"], "downward": ["4-7", "7-10"]}
    with pytest.raises(ls.CaseError, match="mesh 6-10 is not a mesh of gear 4") as refused:
        build_train(case.replace({"rings.4.float": chains}))
    assert refused.value.problems[0].key == "rings.4.float"


# --- Arcs ---


def exact_margin(arc: Arc, relative: np.ndarray) -> Decimal:
    """Return |d₀ + Δ| − a + c in decimal arithmetic of fifty digits."""
    with localcontext() as context:
        context.prec = 50
        d = [
            Decimal(float(s)) + Decimal(float(r)) for s, r in zip(arc.start, relative, strict=True)
        ]
        size = sum(x * x for x in d).sqrt()
        nominal = sum(Decimal(float(s)) ** 2 for s in arc.nominal).sqrt()
        return size - nominal + Decimal(arc.clearance)


@pytest.mark.parametrize("size", [1e-3, 1e-5, 1e-8, 1e-12])
@pytest.mark.parametrize("clearance", [0.0, 5e-6])
def test_the_margin_of_an_arc_is_free_of_cancellation(size, clearance):
    """Against fifty digits: the error is round-off of the movement, not of the centre distance."""
    rng = np.random.default_rng(7)
    plain = []
    for _ in range(50):
        start = np.append(rng.normal(size=2), 0.0)
        start *= 0.1605 / np.linalg.norm(start)
        arc = Arc(start, np.zeros(3), clearance)
        relative = np.append(size * rng.normal(size=2), 0.0)
        exact = float(exact_margin(arc, relative))
        assert abs(arc.margin(relative) - exact) <= 8e-16 * (size + clearance) + 1e-30
        plain.append(abs(np.linalg.norm(start + relative) - arc.distance + clearance - exact))
    assert max(plain) > 2e-17


def test_the_sagitta_of_an_arc():
    """y²/2a at a = 0.16 m is 0.3 nm for y = 10 µm, 0.4 µm for 0.35 mm (formulation, section 6)."""
    arc = Arc(np.array([0.16, 0.0, 0.0]), np.zeros(3), 0.0)
    for y, sagitta in ((1e-5, 0.3e-9), (3.5e-4, 0.4e-6)):
        relative = np.array([0.0, y, 0.0])
        assert arc.margin(relative) == pytest.approx(y**2 / 0.32, rel=1e-5)
        assert arc.margin(relative) == pytest.approx(sagitta, rel=0.06)


def test_the_face_of_an_arc_touches_it_and_leaves_it_quadratically():
    arc = Arc(np.array([0.12, 0.1, 0.0]), 0.156, 1e-5)
    at, way = np.array([2e-5, -1e-5, 0.0]), np.array([0.6, 0.8, 0.0])
    normal, bound = arc.face(at)
    assert normal @ at + bound == pytest.approx(arc.margin(at), abs=1e-19)
    misfits = [
        arc.margin(at + h * way) - normal @ (at + h * way) - bound for h in (4e-4, 2e-4, 1e-4)
    ]
    assert [a / b for a, b in pairwise(misfits)] == pytest.approx([4, 4], rel=0.01)


# --- Positions ---


def test_a_mesh_cycle_turns_the_input_by_one_pitch():
    train = build_train(shipped("fgfbstts/base").replace({"gears.1.teeth": 25}))
    assert [train.mesh_positions(k)["6-10"] for k in (1, 2, 5)] == [0, 1, 4]
    turned = train.rotations(3)["1"]
    assert turned == pytest.approx(2 * math.pi / 25 * 2 / 5)


@pytest.mark.parametrize("gear", ["1", "2", "3"])
def test_the_teeth_of_any_gear_of_the_first_stage_tell_the_cycle_of_the_input(gear):
    """The cycle is one tooth of the input; 25 times the ratio of the radii need not be whole."""
    case = shipped("fgfbstts/base")
    radii = {n: g.acting_radius for n, g in case.gears.items()}
    teeth = {"1": 25, "2": 139, "3": 139}[gear]
    train = build_train(case.replace({f"gears.{gear}.teeth": teeth}))
    assert train.cycle == "1"
    pitch = 2 * math.pi / teeth * radii[gear] / radii["1"]
    turned = {n: 0.4 * pitch * train.gears[n].ratio for n in radii}
    assert train.rotations(3) == pytest.approx(turned, rel=1e-14)


def test_teeth_of_a_later_stage_alone_make_its_tooth_the_cycle():
    """Nothing gives the teeth of stage I: gear 4 is the first on the path whose teeth are known."""
    case = shipped("fgfbstts/base")
    train = build_train(case.replace({"gears.10.teeth": 227}))
    assert train.cycle == "4"
    assert train.gears["1"].teeth is None
    assert train.gears["6"].teeth == pytest.approx(227 * 114.75 / 382.9862)
    assert train.rotations(3)["10"] == pytest.approx(2 * math.pi / 227 * 0.4)


@pytest.mark.parametrize("gear", ["1", "2", "4", "6", "10"])
def test_eccentricities_turn_whichever_gear_has_the_teeth(gear):
    eccentric = {"errors": {"6": {"eccentricity": {"amount": "50 um"}}}}
    case = shipped("fgfbstts/base").replace(eccentric | {f"gears.{gear}.teeth": 30})
    train = build_train(case)
    angle = [math.atan2(*situation_of(train, k).offset_of("6")[1::-1]) for k in range(1, 6)]
    steps = np.diff(angle) / train.gears["6"].sense
    assert steps == pytest.approx(np.full(4, train.rotations(2)["6"]))
    assert steps[0] > 1e-3


def test_samples_of_an_eccentricity_that_nothing_turns_are_refused():
    """Even an eccentricity of 0 must not be ignored, because its later samples are not zero."""
    still = {"errors": {"6": {"eccentricity": {"amount": "0 um"}}}}
    case = shipped("fgfbstts/base").replace(still)
    with pytest.raises(ls.CaseError, match=r"gears\.1\.teeth is missing"):
        ls.solve_many(case, {"errors.6.eccentricity.amount [um]": [0.0, 10.0]})


def test_a_neglected_rotation_leaves_eccentricities_where_they_are():
    case = shipped("fgfbstts/both_errors").replace({"gears.1.teeth": 25})
    train = build_train(case)
    assert train.cycle is None
    for gear in train.gears:
        np.testing.assert_array_equal(
            situation_of(train, 4).offset_of(gear), situation_of(train, 1).offset_of(gear)
        )
    turning = build_train(case.replace({"operating.rotation": "teeth"}))
    assert situation_of(turning, 4).offset_of("1") != pytest.approx(
        situation_of(turning, 1).offset_of("1")
    )


def test_a_march_turns_its_gear_through_whole_revolutions():
    """Gear 8 turns in 24 steps of 15°; its eccentricity turns with it, clockwise."""
    train = build_train(shipped("fgfbstts/eccentricity"))
    assert train.count == 24
    assert train.gears["8"].sense == -1
    for index in (1, 7, 24):
        angle = -math.radians(15.0) * (index - 1)
        expected = 50e-6 * np.array([math.cos(angle), math.sin(angle), 0.0])
        assert situation_of(train, index).offset_of("8") == pytest.approx(expected, abs=1e-19)


def test_a_mesh_with_teeth_stands_where_its_driver_has_turned():
    """Pinion 4 with 27 teeth turns through a revolution of gear 10 in 20 steps: the position
    follows from the rotation.
    """
    train = build_train(shipped("fgfbstts/all_elements"))
    for index in range(1, train.count + 1):
        cycles = train.rotations(index)["4"] * 27 / (2 * math.pi)
        assert train.mesh_positions(index)["4-6"] == math.floor((cycles % 1.0) * 5 + 1e-9) % 5


@pytest.mark.parametrize("index", [0, 6, -1])
def test_there_is_no_such_position(index):
    with pytest.raises(IndexError, match="positions 1 to 5"):
        situation_of(build_train(shipped("fgfbstts/base")), index)


def test_installation_errors_and_eccentricities_are_offsets():
    """Both kinds add up; the pinion of a face gear has its own transverse frame."""
    errors = {
        "installation": ["3 um", "4 um"],
        "eccentricity": {"amount": "2 um", "phase": "90 deg"},
    }
    case = shipped("fgfbstts/base").replace({"errors": {"6": errors}, "gears.1.teeth": 25})
    train = build_train(case)
    assert situation_of(train, 1).offset_of("6") == pytest.approx([3e-6, 6e-6, 0.0])
