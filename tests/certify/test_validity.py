"""Displacements against exact involute kinematics of one mesh, and the treatment of large ones.

Exact geometry: the line of action is the tangent of both base circles, of length L' = √(a'² − R²)
with R = r_1 ± r_2. Unwinding the two strings gives the approach δ = r_1 φ_1 − r_2 φ_2 ∓ (R Δχ + L'
− L), exactly linear in both rotations, where Δχ is the angle by which the line turns; − for two
external gears. It uses nothing of the library.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.support import answer, loaded, shipped

import loadshare as ls
from loadshare.certify import Judge, certify
from loadshare.certify.validity import Measuring, Validity, measuring
from loadshare.report.words import advice
from loadshare.settings import CERTIFY
from loadshare.train import build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of, stack

ALPHA = math.radians(20.0)
R1 = 0.05


def pair(kind: str, teeth: int | None = None) -> ls.Case:
    """Return a pinion that drives a gear with external or internal teeth."""
    r2 = {"external": 0.12, "internal": 0.2}[kind]
    base = R1 + r2 if kind == "external" else r2 - R1
    gears = {
        "1": {"base_radius": f"{R1} m", "centre": ["0 m", "0 m"], "support": "1e8 N/m"},
        "2": {
            "base_radius": f"{r2} m",
            "centre": [f"{base / math.cos(ALPHA)!r} m", "0 m"],
            "type": kind,
        },
    }
    if teeth:
        gears["1"]["teeth"] = teeth
    mesh = {"pressure_angle": f"{ALPHA!r} rad", "stiffness": "1e6 N*m/rad"}
    operating = {"input": "1", "output": "2", "running": "counter-clockwise", "torque": "100 N*m"}
    return ls.Case({"gears": gears, "meshes": {"1-2": mesh}, "operating": operating})


def validity(train, answer: Equilibrium, deflection: float) -> Validity:
    """Measure the displacements of an answer to a case of some deflection [m]."""
    here, claimed = situation_of(train, answer.index), Equilibria.of(train, answer)
    return Validity(measuring(train).each(here, claimed, np.array([deflection]))[0])


def claim(train, moved) -> Equilibrium:
    """Return an answer with the pinion displaced by `moved` (2,) [m] and turned into contact."""
    apart = -float(train.meshes["1-2"].drive_normal[:2] @ np.asarray(moved))
    return Equilibrium(
        index=1,
        rotation={"1": max(apart, 0.0) / R1, "2": 0.0},
        displacement={"1": np.array([*moved, 0.0]), "2": np.zeros(3)},
        flank_force={"1-2": 0.0},
        ring_force={},
        radial_reaction={},
        undetermined=(),
    )


def exact(kind: str, r2: float, moved: np.ndarray) -> float:
    """Return the approach [m] of a pinion displaced by `moved`, by strings of the base circles."""
    base = R1 + r2 if kind == "external" else r2 - R1
    start = np.array([base / math.cos(ALPHA), 0.0])
    way = start - moved
    distance = float(np.hypot(*way))
    if distance <= base:
        return math.nan
    angle = math.acos(base / distance)
    grown = math.sqrt(distance**2 - base**2) - base * math.tan(ALPHA)
    turned = math.atan2(way[1], way[0])
    approach = base * (turned - (angle - ALPHA)) + grown
    return -approach if kind == "external" else approach


@pytest.mark.parametrize("kind", ["external", "internal"])
def test_the_neglected_approach_is_that_of_exact_involutes(kind):
    """Its estimate agrees to the first power of the displacement in every direction; up to the
    threshold of a warning it is right to 10 %.
    """
    train = build_train(pair(kind))
    mesh = train.meshes["1-2"]
    r2 = mesh.radii[1]
    for turn in np.linspace(0.0, 2.0 * math.pi, 17)[:-1]:
        way = np.array([math.cos(turn), math.sin(turn)])
        misfits = []
        for size in (1e-2, 1e-3):
            moved = size * R1 * way
            linear = float(mesh.drive_normal[:2] @ moved)
            neglected = abs(exact(kind, r2, moved) - linear)
            measured = validity(train, claim(train, moved), 1.0).measures["approach"].value
            misfits.append(abs(measured - neglected) / (size * R1) ** 2)
        # Third order over second order: it decreases tenfold with the displacement.
        assert misfits[1] < 0.15 * misfits[0] + 1e-6
        across = abs(float(mesh.coast_normal[:2] @ way))
        far = CERTIFY.turned * R1 * math.tan(ALPHA) * way
        found = validity(train, claim(train, far), 1.0).measures["approach"].value
        true = abs(exact(kind, r2, far) - float(mesh.drive_normal[:2] @ far))
        if across > 0.3 and found > 1e-3 * CERTIFY.turned**2 * R1:
            assert found == pytest.approx(true, rel=0.1)


@pytest.mark.parametrize("kind", ["external", "internal"])
def test_an_answer_is_refused_before_the_line_of_action_vanishes(kind):
    """The base circles touch when the gears have come closer by L tan(α/2), and not before."""
    train = build_train(pair(kind))
    mesh = train.meshes["1-2"]
    base = R1 + mesh.radii[1] if kind == "external" else mesh.radii[1] - R1
    limit = base * math.tan(ALPHA) * math.tan(0.5 * ALPHA)
    inward = np.array([1.0, 0.0])
    assert math.isfinite(exact(kind, mesh.radii[1], 0.999 * limit * inward))
    assert math.isnan(exact(kind, mesh.radii[1], 1.001 * limit * inward))
    figure = validity(train, claim(train, limit * inward), 1.0).measures["line_of_action"]
    assert figure.refusal == pytest.approx(math.tan(0.5 * ALPHA))
    # Across the line of action, the whole displacement counts.
    n = mesh.drive_normal[:2]
    across = np.array([-n[1], n[0]])
    refused = validity(train, claim(train, 1.001 * limit * across), 1.0)
    assert "line_of_action" in refused.refused
    assert (
        "line_of_action" not in validity(train, claim(train, 0.999 * limit * across), 1.0).refused
    )


def test_a_common_shift_and_rotations_neglect_nothing():
    train = build_train(pair("external"))
    moved = {g: np.array([0.3, -0.2, 0.0]) for g in train.gears}
    shifted = replace(
        claim(train, (0.0, 0.0)),
        displacement=moved,
        rotation={"1": 2.0, "2": 2.0 * R1 / 0.12},
    )
    found = validity(train, shifted, 1e-5)
    assert found.verdict == "small"
    assert found.measures["rotation"].value == 2.0


@pytest.mark.parametrize("teeth", [None, 40])
def test_compression_by_the_height_of_the_teeth(teeth):
    """The height is 2.25 modules of the given teeth, or of 17 teeth if their number is unknown."""
    train = build_train(pair("external", teeth))
    module = 2.0 * R1 / ((teeth or 17) * math.cos(ALPHA))
    shares = {
        0.99 * CERTIFY.compressed: "small",
        1.01 * CERTIFY.compressed: "large",
        1.01 * CERTIFY.meaningless: "meaningless",
    }
    for share, verdict in shares.items():
        pressed = replace(
            claim(train, (0.0, 0.0)),
            rotation={"1": share * CERTIFY.height * module / R1, "2": 0.0},
        )
        found = validity(train, pressed, 1.0)
        assert found.measures["compression"].value == pytest.approx(share)
        assert found.verdict == verdict


def test_the_bound_of_the_neglected_approach():
    """Above NEGLECTED deflections there is a warning, above MEANINGLESS a refusal."""
    train = build_train(pair("external"))
    n = train.meshes["1-2"].drive_normal[:2]
    moved = 1e-4 * np.array([-n[1], n[0]])
    neglected = 1e-8 / (2.0 * 0.17 * math.tan(ALPHA))
    deflections = {
        1.01 / CERTIFY.neglected: "small",
        0.99 / CERTIFY.neglected: "large",
        0.99 / CERTIFY.meaningless: "meaningless",
    }
    for deflection, verdict in deflections.items():
        found = validity(train, claim(train, moved), deflection * neglected)
        assert found.verdict == verdict, found.measures["approach"]


def test_what_a_gap_takes_up_is_not_neglected():
    """A flank that is open by more than the error of its approach cannot close because of it."""
    train = build_train(pair("external"))
    n = train.meshes["1-2"].drive_normal[:2]
    touching = claim(train, 1e-4 * np.array([-n[1], n[0]]))
    neglected = 1e-8 / (2.0 * 0.17 * math.tan(ALPHA))
    for gap, left in ((0.0, 1.0), (0.25, 0.75), (1.0, 0.0), (3.0, 0.0)):
        turned = {"1": touching.rotation["1"] - gap * neglected / R1, "2": 0.0}
        found = validity(train, replace(touching, rotation=turned), neglected)
        assert found.measures["approach"].value == pytest.approx(left, abs=1e-6)


@pytest.mark.parametrize(
    ("gap", "force", "left"), [(3.0, 0.0, 0.0), (3.0, 1.0, 1.0), (0.5, 0.0, 1.0)]
)
def test_a_gear_that_carries_nothing_turns_in_its_play(gap, force, left):
    """An idler touches its driver and has a gap of `gap` to the gear that it drives."""
    data = pair("external").to_dict()
    far = (R1 + 0.12) / math.cos(ALPHA) + 0.24 / math.cos(ALPHA)
    data["gears"]["3"] = {"base_radius": "0.12 m", "centre": [f"{far!r} m", "0 m"]}
    data["meshes"]["2-3"] = data["meshes"]["1-2"]
    data["operating"]["output"] = "3"
    train = build_train(ls.Case(data))
    n = train.meshes["1-2"].drive_normal[:2]
    neglected = 1e-8 / (2.0 * 0.17 * math.tan(ALPHA))
    touching = claim(train, 1e-4 * np.array([-n[1], n[0]]))
    turn = -gap * neglected / 0.12
    answer = replace(
        touching,
        rotation={"1": turn * 0.12 / R1, "2": turn, "3": 0.0},
        displacement={**touching.displacement, "3": np.zeros(3)},
        flank_force={"1-2": force, "2-3": 0.0},
    )
    found = validity(train, answer, neglected)
    assert found.measures["approach"].value == pytest.approx(left, abs=1e-6)


def test_many_answers_are_measured_as_single_ones():
    """Right answers of a case with everything, and the same displaced far away."""
    train = build_train(shipped("fgfbstts/all_elements"))
    indices = [1, 2, 3, 1, 2, 3]
    found = Equilibria.empty(train, len(indices))
    for row, index in enumerate(indices):
        found.put(row, answer(train, index)[0])
    rng = np.random.default_rng(3)
    found.displacement[3:] += rng.normal(size=found.displacement[3:].shape) * 0.02
    situations = stack([situation_of(train, k) for k in indices])
    deflection = Judge(train).judge(situations, found).deflection
    many = Measuring(train)
    worst = many.worst(situations, found, deflection)
    refused = many.refusals(situations, found, deflection)
    for row, index in enumerate(indices):
        one = validity(train, found.one(row, index), float(deflection[row]))
        share = max(m.value / m.warning for m in one.measures.values() if m.warning)
        assert worst[row] == pytest.approx(share, rel=1e-9)
        assert bool(one.refused) == (row in refused) == (row > 2)
    assert (worst[:3] < 1.0).all()


def test_a_case_that_gives_way_too_much_is_refused_everywhere():
    """`solve` refuses it and names the mesh, `solve_many` sample by sample; the equilibrium itself,
    which `explain` returns, is certified.
    """
    case = loaded(shipped("fgfbstts/base"), "5e5 N*m")
    with pytest.raises(ls.Refused, match="tooth height") as refused:
        ls.solve(case, positions=[1])
    assert refused.value.figures["compression"] > CERTIFY.meaningless
    known = ls.explain(case, 1)
    assert certify(known.train, known.equilibrium).passed
    assert known.validity.verdict == "meaningless"
    torques = ["3000 N*m", "5e5 N*m", "6e4 N*m"]
    base = loaded(shipped("fgfbstts/base"), "3000 N*m")
    found = ls.solve_many(base, {"operating.torque": torques}, positions=[1, 2])
    assert found.certified.values.tolist() == [[True] * 2, [False] * 2, [True] * 2]
    assert np.isnan(found.torque.values[1]).all()
    assert found.displaced.values[0, 0] < 1.0 < found.displaced.values[2, 0]
    assert found.attrs["warned"] == 2
    refused = found.attrs["refused"].splitlines()
    assert len(refused) == 2
    assert refused[0].startswith("sample 1, position 1: ")
    assert "tooth height" in refused[0]


@pytest.mark.parametrize("tolerance", [CERTIFY.tolerance, 1e-18])
def test_too_large_displacements_are_the_reason_whatever_the_certificate_says(tolerance):
    """Their rounding alone may be beyond the tolerance."""
    with pytest.raises(ls.Refused, match="displacements are too large for the geometry"):
        ls.solve(loaded(shipped("fgfbstts/base"), "5e5 N*m"), tolerance=tolerance)


def test_a_warning_stands_in_the_result_and_outlives_a_file(tmp_path):
    case = loaded(shipped("fgfbstts/base"), "6e4 N*m")
    result = ls.solve(case, positions=[1])
    (position,) = result.positions
    assert position.validity.verdict == "large"
    assert set(position.validity.warned) == {"compression"}
    result.to_json(tmp_path / "r.json")
    assert ls.load_result(tmp_path / "r.json") == result
    assert result.dataset.validity.sel(measure="compression").item() > CERTIFY.compressed


def rig(clocking: str, **mesh: str) -> ls.Case:
    """Return two equal pairs back to back, with a torque locked in by clocking a shaft."""
    axis, wheels = ["0 mm", "0 mm"], ["150 mm", "0 mm"]
    teeth = [{"teeth": n, "module": "4 mm"} for n in (25, 50)]
    return ls.Case(
        {
            "operating": {"input": "t1", "output": "s2", "torque": "20 N*m"},
            "gears": {
                "t1": {"centre": axis, **teeth[0]},
                "t2": {"centre": wheels, **teeth[1]},
                "s1": {"centre": [*axis, "300 mm"], **teeth[0]},
                "s2": {"centre": [*wheels, "300 mm"], **teeth[1]},
            },
            "meshes": {n: {"stiffness": "5e5 N*m/rad", **mesh} for n in ("t1-t2", "s1-s2")},
            "shafts": {
                "t1-s1": {"stiffness": "4e4 N*m/rad", "clocking": clocking},
                "t2-s2": {"stiffness": "2e5 N*m/rad"},
            },
        }
    )


def test_a_mesh_without_backlash_that_is_wound_open_is_told() -> None:
    """With backlash the loop is a torsion spring: springs in series, referred to the first shaft.

    An external torque of 20 N·m divides between the two directions according to the compliances.
    """
    mesh, thin, thick = 1 / 5e5, 1 / 4e4, 4 / 2e5
    play = 100e-6 / 50e-3
    found = ls.solve(rig("8 mrad", backlash="100 um"))
    loop = 2 * mesh + thin + thick
    expected = (8e-3 - play + 20 * (thin + mesh)) / loop
    (position,) = found.positions
    assert position.torque["t1-t2"] == pytest.approx(expected, rel=1e-9)
    assert position.torque["s1-s2"] == pytest.approx(20 - expected, rel=1e-9)
    assert "backlash" not in advice(found)
    silent = ls.solve(rig("8 mrad"))
    assert silent.positions[0].torque["s1-s2"] == 0.0
    assert "mesh s1-s2 is open (position 1)" in advice(silent)
    opening = (8e-3 - 20 * (mesh + thick)) * 50e-3 * math.cos(math.radians(20))
    measure = silent.positions[0].validity.measures["apart"]
    assert measure.value == pytest.approx(opening / (2.25 * 4e-3), rel=1e-9)
    assert advice(ls.solve(rig("2 mrad"))) == ""
    assert "apart" not in ls.solve(rig("8 mrad", gap="9 mrad")).positions[0].validity.measures
