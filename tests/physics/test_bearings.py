"""Bearings with radial clearance: closed forms, the limit of no clearance, 50 digits.

Source: formulation, section 14.
"""

import math
from typing import Any

import numpy as np
import pytest
from tests.physics.test_metamorphic import FRAMES, placed
from tests.support import shipped

import loadshare as ls
from benchmarks import families
from benchmarks.reference.solve import reference
from loadshare.job.engines import engine_named
from loadshare.job.machine import Machine
from loadshare.train import build_train

FORCE = 100.0 / 0.05
"""Torque of the pair divided by the base radius of its driver [N]."""
ALONG = np.array([-math.sqrt(1.0 - (150 / 160) ** 2), -150 / 160])
"""Line of action, in the direction in which the driven gear pushes the driver."""


def pair(**bearing: object) -> ls.Case:
    """Return two gears, the first in a bearing with clearance."""
    angle = f"{math.degrees(math.acos(150 / 160))!r} deg"
    return ls.Case(
        {
            "operating": {"input": "a", "output": "b", "torque": "100 N*m"},
            "gears": {
                "a": {"centre": ["0 mm", "0 mm"], "base_radius": "50 mm"},
                "b": {"centre": ["160 mm", "0 mm"], "base_radius": "100 mm"},
            },
            "meshes": {"a-b": {"pressure_angle": angle, "stiffness": "1e6 N*m/rad"}},
            "bearings": {"a": {"clearance": "20 um", "stiffness": "1e8 N/m", **bearing}},
        }
    )


LAWS = [
    ("stiffness", "5e8 N/m", 1.0),
    ("ball_stiffness", "6e10 N/m^1.5", 1.5),
    ("roller_stiffness", "2e9 N/m^(10/9)", 10.0 / 9.0),
]
"""Keys, values, and exponents of the distance beyond the clearance."""


def planets_in_bearings(
    clearance: str, stiffness: str = "5e8 N/m", key: str = "stiffness"
) -> ls.Case:
    """Return a star of four with planets in bearings and a floating sun."""
    case = families.star(4)
    planets = [g for g in case.gears if g.startswith("planet")]
    bearing = {"clearance": clearance, key: stiffness}
    return case.replace(
        {
            "bearings": dict.fromkeys(planets, bearing),
            "errors": {
                planets[0]: {"installation": {"amount": "15 um", "direction": "40 deg"}},
                planets[2]: {"installation": {"amount": "8 um", "direction": "200 deg"}},
            },
        }
    )


@pytest.mark.parametrize("stiffness", [1e7, 1e8, math.inf])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (3.0, -4.0)])
def test_a_loaded_gear_in_a_round_gap(stiffness, offset):
    """It moves along its force to the end of the gap, and by F / K further."""
    text = "rigid" if math.isinf(stiffness) else f"{stiffness!r} N/m"
    found = ls.solve(pair(stiffness=text, offset=[f"{v} um" for v in offset])).positions[0]
    expected = np.array(offset) * 1e-6 + (20e-6 + FORCE / stiffness) * ALONG
    assert found.displacement["a"] == pytest.approx(tuple(expected), rel=1e-12)
    rest = found.floats["a"]
    assert rest.state == "on boundary"
    assert rest.boundary == "outer race"
    assert rest.reaction == pytest.approx(tuple(-FORCE * ALONG), rel=1e-12)


@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
@pytest.mark.parametrize("solver", ["auto", "clarabel"])
@pytest.mark.parametrize(("key", "power"), [("ball_stiffness", 1.5), ("roller_stiffness", 10 / 9)])
@pytest.mark.parametrize("clearance", [0.0, 20e-6])
def test_a_loaded_gear_in_a_rolling_bearing(key, power, solver, engine, clearance):
    """It moves by (F / K)^(1/power) beyond the end of the gap."""
    unit = {1.5: "N/m^1.5"}.get(power, "N/m^(10/9)")
    bearing = {key: f"3e9 {unit}", "clearance": f"{clearance!r} m", "stiffness": None}
    case = pair().replace({f"bearings.a.{k}": v for k, v in bearing.items()})
    found = ls.solve(case, solver=solver, engine=engine).positions[0]
    expected = (clearance + (FORCE / 3e9) ** (1.0 / power)) * ALONG
    assert found.displacement["a"] == pytest.approx(tuple(expected), rel=1e-12)
    assert found.certificate.proved < 1e-12


def test_a_bearing_without_clearance_is_an_elastic_or_a_rigid_one():
    without = {k: v for k, v in planets_in_bearings("0 um").to_dict().items() if k != "bearings"}
    gears = without["gears"]
    for stiffness, support in (("5e8 N/m", "5e8 N/m"), ("rigid", "rigid")):
        for name in gears:
            if name.startswith("planet"):
                gears[name]["support"] = support
        plain, held = (
            ls.solve(c) for c in (ls.Case(without), planets_in_bearings("0 um", stiffness))
        )
        for one, other in zip(plain.positions, held.positions, strict=True):
            assert other.torque == pytest.approx(one.torque, rel=1e-11)


@pytest.mark.parametrize("clearance", ["0 um", "0.3 um", "5 um", "40 um"])
@pytest.mark.parametrize(("key", "stiffness"), [*(law[:2] for law in LAWS), ("stiffness", "rigid")])
@pytest.mark.quick(4)
def test_shares_of_planets_in_bearings_agree_with_50_digits(clearance, key, stiffness):
    case = planets_in_bearings(clearance, stiffness, key)
    found, exact = ls.solve(case).positions[0], reference(build_train(case))
    assert found.torque == pytest.approx(dict(exact.torque), rel=1e-11)
    assert found.certificate.proved < 1e-11


@pytest.mark.parametrize("law", LAWS, ids=[law[0] for law in LAWS])
@pytest.mark.parametrize("clearance", [0, 10, 20, 40, 80])
@pytest.mark.quick(8)
def test_a_clearance_shifts_a_split_as_50_digits_say(law, clearance):
    """The bearing with more clearance reduces the torque of its path; equal ones share equally."""
    key, stiffness, _ = law
    case = shipped("two_path/clocking_error")
    case = case.replace({'shafts."wheelA-pinionA".clocking': None})
    plays = {"pinionA": clearance, "pinionB": 10}
    bearings = {g: {"clearance": f"{c} um", key: stiffness} for g, c in plays.items()}
    case = case.replace({"bearings": bearings})
    found, exact = ls.solve(case).positions[0], reference(build_train(case))
    for mesh, expected in exact.torque.items():
        assert found.torque[mesh] == pytest.approx(float(expected), abs=1e-9)
    share = found.torque["in-wheelA"] / 367.0
    assert (share - 0.5) * (10 - clearance) > 0.0 or share == pytest.approx(0.5, abs=1e-12)


def test_a_bearing_inside_a_limit_ring_agrees_with_50_digits():
    """Both limit the pinion; the bearing holds it before its ring does, or after."""
    for clearance in ("1 um", "200 um"):
        bearing = {"clearance": clearance, "stiffness": "2e8 N/m"}
        case = shipped("fgfbstts/limit_ring").replace({"bearings": {"4": bearing}})
        found, exact = ls.solve(case, positions=[1]).positions[0], reference(build_train(case))
        assert found.torque == pytest.approx(dict(exact.torque), rel=1e-11)
        names = [touch.name for touch in found.floats["4"].boundaries if touch.touching]
        assert ("bearing 4: outer race" in names) == (clearance == "1 um")


def test_clearances_of_bearings_are_samples_of_one_machine():
    case = planets_in_bearings("5 um")
    planet = next(iter(case.bearings))
    clearances, stiffnesses = np.array([0.0, 2.0, 7.0, 30.0]), np.array([5e8, 2e8, 1e9, 5e8])
    batch = ls.solve_many(
        case,
        {
            f"bearings.{planet}.clearance [um]": clearances,
            f"bearings.{planet}.stiffness [N/m]": stiffnesses,
        },
    )
    assert batch.certified.all()
    for sample, (clearance, stiffness) in enumerate(zip(clearances, stiffnesses, strict=True)):
        alone = case.replace(
            {
                f"bearings.{planet}.clearance": f"{clearance} um",
                f"bearings.{planet}.stiffness": f"{stiffness} N/m",
            }
        )
        torque = ls.solve(alone).positions[0].torque
        for mesh, expected in torque.items():
            here = float(batch.torque.sel(sample=sample, mesh=mesh).values[0])
            assert here == pytest.approx(expected, rel=1e-10, abs=1e-9)


@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
@pytest.mark.parametrize(("key", "stiffness", "power"), LAWS[1:])
@pytest.mark.quick(2)
def test_laws_of_rolling_bearings_are_samples_of_one_machine(key, stiffness, power, engine):
    """Loads range from almost zero, where a bearing is soft, to ten times as much."""
    case = planets_in_bearings("5 um", stiffness, key)
    torque = np.array([1e-3, 1.0, 30.0, 300.0, 3000.0])
    samples = {
        "operating.torque [N*m]": torque,
        f"bearings.{next(iter(case.bearings))}.clearance [um]": np.array([0, 1, 7, 3, 30.0]),
    }
    batch = ls.solve_many(case, samples, engine=engine)
    assert batch.certified.all()
    for sample, key_values in enumerate(zip(*samples.values(), strict=True)):
        texts = zip(samples, key_values, strict=True)
        alone = case.replace(
            {k.split(" [")[0]: f"{v} {k[k.index('[') + 1 : -1]}" for k, v in texts}
        )
        exact = reference(build_train(alone)).torque
        for mesh, expected in exact.items():
            here = float(batch.torque.sel(sample=sample, mesh=mesh).values[0])
            assert here == pytest.approx(float(expected), rel=1e-9, abs=1e-11 * torque[sample])


def test_a_bearing_of_balls_yields_as_palmgren_has_it():
    """Nine balls of 7.9 mm: δ = 4.36e-4 (Q²/D)^(1/3) mm with Q = 4.37 F/Z, Harris' form."""
    rolling = {"balls": 9, "diameter": "7.938 mm"}
    case = pair().replace({"bearings.a.stiffness": None, "bearings.a.rolling": rolling})
    found = ls.solve(case).positions[0]
    most = 4.37 * FORCE / 9
    further = 4.36e-7 * (most**2 / 7.938) ** (1 / 3)
    assert np.hypot(*found.displacement["a"]) == pytest.approx(20e-6 + further, rel=1e-12)


def test_a_bearing_of_rollers_yields_as_palmgren_has_it():
    rolling = {"rollers": 14, "length": "12 mm", "contact_angle": "12 deg"}
    case = pair().replace({"bearings.a.stiffness": None, "bearings.a.rolling": rolling})
    found = ls.solve(case).positions[0]
    inclined = math.cos(math.radians(12.0))
    most = 4.08 * FORCE / 14 / inclined
    further = 7.68e-8 * most**0.9 / 12.0**0.8 / inclined
    assert np.hypot(*found.displacement["a"]) == pytest.approx(20e-6 + further, rel=1e-12)


@pytest.mark.parametrize(("key", "stiffness", "power"), LAWS[1:])
def test_a_rolling_bearing_yields_by_its_tangent(key, stiffness, power):
    """The tangent of δ = (F/K)^(1/power) by torque and by K; a set of elements keeps its rates."""
    bearing = {"bearings.a.stiffness": None, f"bearings.a.{key}": stiffness}
    case = pair().replace(bearing)
    coefficient = case.bearings["a"].wall[0]
    further = (FORCE / coefficient) ** (1.0 / power)
    found = ls.sensitivity(case, ["operating.torque", f"bearings.a.{key}"])
    for what, rate in (
        ("operating.torque", further / power / 100.0),
        (f"bearings.a.{key}", -further / power / coefficient),
    ):
        rates = found.rates[1, what, "rising"]
        assert rates.displacement["a"] == pytest.approx(tuple(rate * ALONG), rel=1e-6)


def test_a_gear_moves_with_its_clearance():
    """By the closed form, a micrometre of clearance is a micrometre of displacement."""
    found = ls.sensitivity(pair(), "bearings.a.clearance")
    for side in ("rising", "falling"):
        rates = found.rates[1, "bearings.a.clearance", side]
        assert rates.displacement["a"] == pytest.approx(tuple(ALONG), rel=1e-9)


@pytest.mark.parametrize("frame", FRAMES)
def test_a_turned_train_shares_alike(frame):
    case = planets_in_bearings("5 um")
    turned = placed(case, FRAMES[frame])
    one, other = (ls.solve(c).positions[0].torque for c in (case, turned))
    assert other == pytest.approx(one, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bearings.a.clearance": "-1 um"}, "bearings.a.clearance"),
        ({"bearings.a.stiffness": None}, "bearings.a.stiffness"),
        ({"bearings.a.ball_stiffness": "1e9 N/m^1.5"}, "bearings.a.ball_stiffness"),
        (
            {"bearings.a.stiffness": None, "bearings.a.rolling": {"balls": 9}},
            "diameter: is missing",
        ),
        (
            {"bearings.a.stiffness": None, "bearings.a.rolling": {"rollers": 9, "balls": 9}},
            "either balls or rollers",
        ),
        ({"bearings.c": {"clearance": "1 um", "stiffness": "rigid"}}, "bearings.c"),
        ({"gears.a.support": "rigid"}, "gears.a.support"),
    ],
)
def test_what_does_not_hold_is_reported(changes, message):
    with pytest.raises(ls.CaseError, match=message):
        pair().replace(changes)


TILT = math.radians(25.0)
TURN = np.array([[math.cos(TILT), -math.sin(TILT)], [math.sin(TILT), math.cos(TILT)]])
FULL = TURN @ np.diag([5e7, 3e8]) @ TURN.T
"""A stiffness whose smallest and largest values are at 25 deg to x and y [N/m]."""


def on_a_full_matrix(matrix: np.ndarray) -> ls.Case:
    entries = [[f"{v!r} N/m" for v in row] for row in matrix.tolist()]
    entries[1][0] = entries[0][1]
    return pair().replace({"bearings": {}, "gears.a.support": entries})


@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
@pytest.mark.parametrize("solver", ["auto", "clarabel"])
def test_a_gear_on_a_bearing_stiffest_aslant(solver, engine):
    """It moves by the inverse of the matrix times the force, given along x and y."""
    case = on_a_full_matrix(FULL)
    found = ls.solve(case, solver=solver, engine=engine).positions[0]
    expected = np.linalg.solve(FULL, FORCE * ALONG)
    assert found.displacement["a"] == pytest.approx(tuple(expected), rel=1e-10)
    assert found.loads.bearings["a"] == pytest.approx(tuple(FORCE * ALONG), rel=1e-10)
    assert found.certificate.proved < 1e-12
    torque = {"operating.torque [N*m]": np.array([100.0])}
    batch = ls.solve_many(case, torque, keep="displacement", engine=engine)
    moved = batch.displacement.sel(gear="a").values[0, 0]
    assert moved == pytest.approx(expected, rel=1e-10)


def test_a_full_matrix_of_two_directions_is_two_directions():
    both = pair().replace({"bearings": {}, "gears.a.support": ["1e8 N/m", "2e8 N/m"]})
    one, other = (ls.solve(c) for c in (both, on_a_full_matrix(np.diag([1e8, 2e8]))))
    assert one.positions[0].displacement["a"] == pytest.approx(
        other.positions[0].displacement["a"], rel=1e-12
    )


def test_a_full_matrix_turns_with_the_train():
    """Errors, sensitivities and shares of a train rotated by 25 deg together with its matrix."""
    aligned = pair().replace(
        {
            "bearings": {},
            "gears.a.support": ["5e7 N/m", "3e8 N/m"],
            "errors": {
                "a": {
                    "installation": {"amount": "9 um", "direction": "40 deg"},
                    "eccentricity": {"amount": "5 um", "direction": "10 deg"},
                }
            },
        }
    )
    data = aligned.to_dict()
    place = TURN @ [0.16, 0.0]
    data["gears"]["b"]["centre"] = [f"{v!r} m" for v in place.tolist()]
    data["gears"]["a"]["support"] = [[f"{v!r} N/m" for v in row] for row in FULL.tolist()]
    data["gears"]["a"]["support"][1][0] = data["gears"]["a"]["support"][0][1]
    data["errors"]["a"]["installation"]["direction"] = "65 deg"
    data["errors"]["a"]["eccentricity"]["direction"] = "35 deg"
    keys = ["errors.a.installation.amount", "operating.torque"]
    one, other = aligned, ls.Case(data)
    straight, turned = (ls.solve(c).positions[0].displacement["a"] for c in (one, other))
    assert turned == pytest.approx(tuple(TURN @ straight), rel=1e-9)
    straight, turned = (ls.sensitivity(c, keys) for c in (one, other))
    for key in keys:
        rates = [s.rates[1, key, "rising"].displacement["a"] for s in (straight, turned)]
        assert rates[1] == pytest.approx(tuple(TURN @ rates[0]), rel=1e-7, abs=1e-12)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        ([["1e8 N/m", "1e7 N/m"], ["2e7 N/m", "1e8 N/m"]], "is not symmetric"),
        ([["1e8 N/m", "2e8 N/m"], ["2e8 N/m", "1e8 N/m"]], "not positive in all directions"),
        ([["1e8 N/m"], ["2e8 N/m"]], "gears.a.support"),
    ],
)
def test_what_is_no_stiffness_is_reported(matrix, message):
    with pytest.raises(ls.CaseError, match=message):
        pair().replace({"bearings": {}, "gears.a.support": matrix})


PLANETS = np.array([0, 21, 42, 63, 84]) * 2.0 * math.pi / 104.0 + 0.3


def rounded_set(digits: int, torque: float) -> ls.Case:
    """Return a set with floating sun, carrier in a bearing with clearance, and rounded centres.

    The carrier may move with the sun: only the rounding of the centres presses it.
    """
    case: dict[str, Any] = {
        "operating": {"input": "s", "output": "c", "torque": f"{torque} N*m"},
        "gears": {
            "s": {"teeth": 28, "module": "4 mm", "centre": ["0 mm", "0 mm"], "support": "free"},
            "r": {
                "type": "internal",
                "teeth": 76,
                "module": "4 mm",
                "centre": ["0 mm", "0 mm"],
                "held": True,
            },
            "c": {"type": "carrier", "centre": ["0 mm", "0 mm"]},
        },
        "meshes": {},
        "bearings": {"c": {"clearance": "14 um", "stiffness": "6e8 N/m"}},
    }
    for i, angle in enumerate(PLANETS):
        centre = [f"{104.0 * f(angle):.{digits}f} mm" for f in (math.cos, math.sin)]
        case["gears"][f"p{i}"] = {
            "teeth": 24,
            "module": "4 mm",
            "carrier": "c",
            "centre": centre,
            "support": "5e8 N/m",
        }
        for name in (f"s-p{i}", f"p{i}-r"):
            case["meshes"][name] = {"stiffness": "3e5 N*m/rad"}
    return ls.Case(case)


@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
@pytest.mark.parametrize("digits", [4, 6, 7, 8, 9, 12])
@pytest.mark.quick(6)
def test_what_only_rounding_presses_rests_at_the_end_of_its_clearance(digits, engine):
    torques = np.geomspace(50.0, 2000.0, 12)
    found = ls.solve_many(
        rounded_set(digits, 100.0), {"operating.torque [N*m]": torques}, engine=engine
    )
    assert found.certified.all()
    # The same set with exact centres; rounding moves these by half of the last digit.
    exact = ls.solve(rounded_set(14, 100.0)).positions[0].torque
    for i in range(5):
        part = found.torque.sel(mesh=f"s-p{i}").values[:, 0] / torques
        assert part == pytest.approx(exact[f"s-p{i}"] / 100.0, abs=10.0**-digits)


CLEARANCE, OFF = 12e-6, np.array([-3e-6, 14e-6])
"""Clearance of the bearing of a sun between two planets, and its offset [m]."""


def between_planets(key: str, stiffness: str, torque: float) -> ls.Case:
    """Return a sun between two planets, in a bearing that excludes zero displacement."""
    planet = {"base_radius": "50 mm", "support": "rigid"}
    offset = [f"{v!r} m" for v in OFF.tolist()]
    return ls.Case(
        {
            "operating": {"input": "s", "output": "r", "torque": f"{torque} N*m"},
            "gears": {
                "s": {"centre": ["0 mm", "0 mm"], "base_radius": "50 mm", "support": "free"},
                "p0": {"centre": ["110 mm", "0 mm"], **planet},
                "p1": {"centre": ["-110 mm", "0 mm"], **planet},
                "r": {"type": "internal", "centre": ["0 mm", "0 mm"], "base_radius": "150 mm"},
            },
            "meshes": {
                "s-p0": {"stiffness": "1e7 N*m/rad"},
                "s-p1": {"stiffness": "2.5e6 N*m/rad"},
                "p0-r": {"stiffness": "1e6 N*m/rad"},
                "p1-r": {"stiffness": "4e6 N*m/rad"},
            },
            "bearings": {"s": {"clearance": f"{CLEARANCE!r} m", key: stiffness, "offset": offset}},
        }
    )


@pytest.mark.parametrize("law", LAWS, ids=[law[0] for law in LAWS])
@pytest.mark.parametrize("torque", [3.0, 100.0])
def test_what_nothing_presses_rests_at_the_end_of_its_clearance(law, torque):
    """A sun between two planets is where both flanks share equally; across that line it is free.

    Its least place is at the wall of its bearing, without force; a wall with a power law has no
    stiffness there.
    """
    found = ls.solve(between_planets(*law[:2], torque)).positions[0]
    assert found.torque["s-p0"] == pytest.approx(torque / 2.0, rel=1e-12)
    assert found.torque["s-p1"] == pytest.approx(torque / 2.0, rel=1e-12)
    # The wall is taken to begin below 1e-12 of the load.
    assert found.certificate.proved < 1e-11
    cosine = 100.0 / 110.0
    along = np.array([math.sqrt(1.0 - cosine**2), cosine])
    across = np.array([-along[1], along[0]])
    # r φ ± n·p = r² F (1/K + 1/K'), F = T / 2 r.
    compliances = 1.0 / 1e7 + 1.0 / 1e6, 1.0 / 2.5e6 + 1.0 / 4e6
    place = 0.05 * torque / 2.0 * (compliances[0] - compliances[1]) / 2.0
    aside = across @ OFF - math.sqrt(CLEARANCE**2 - (place - along @ OFF) ** 2)
    assert aside > 0.0
    expected = place * along + aside * across
    # Balls yield by 1e-13 m under 1e-12 of the load.
    assert found.displacement["s"] == pytest.approx(tuple(expected), abs=1e-12)


@pytest.mark.parametrize("law", LAWS, ids=[law[0] for law in LAWS])
def test_a_wall_that_nothing_presses_begins_at_the_load_of_its_own_position(law):
    """A force that is faint under another position's load may be 1e-7 of the load here."""
    idler = {"centre": ["160 mm", "160 mm"], "base_radius": "50 mm"}
    wall = {"clearance": "3 um", law[0]: law[1], "offset": ["10 um", "0 um"]}
    case = pair().replace(
        {
            "gears.idler": idler,
            "meshes.b-idler": {"stiffness": "1e6 N*m/rad"},
            "bearings": {"idler": wall},
            "operating.external": {"idler": "0 N*m"},
            "operating.torque": ["1000 N*m", "0.01 N*m"],
            "operating.positions": 2,
        }
    )
    found = ls.solve(case).positions[1]
    assert found.torque == pytest.approx({"a-b": 0.01, "b-idler": 0.0}, abs=1e-12)
    assert found.displacement["idler"] == pytest.approx((7e-6, 0.0), abs=1e-13)


@pytest.mark.parametrize("law", LAWS, ids=[law[0] for law in LAWS])
def test_what_nothing_presses_finds_room_without_a_search(law):
    """Room ends at the clearance, not where the tangent of the wall at a pressed gear begins."""
    machine = Machine(build_train(between_planets(*law[:2], 100.0)))
    found = machine.answer(machine.situations([1]), 1e-9, engine_named("vectorised", 1))
    assert found.passed.all()
    assert not found.searched.any()
    off = found.equilibria.displacement[0, 0, :2] - OFF
    assert np.hypot(*off) == pytest.approx(CLEARANCE, abs=1e-12)
