"""The position of a mesh in its law, whichever of its gears drives and on whichever flank.

Half a turn about the line of centres exchanges coast and drive flanks of a pair and reverses both
senses of rotation. So a machine does not depend on which gear a mesh's name puts first, and braking
is driving with the cycle backwards.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.train import build_train

COUNT = 5
RATIO = 2.0
RADIUS = 0.5 * 0.003 * 25 * math.cos(math.radians(20.0))
"""Radius of the idler at the base circle [m]."""
PLAY = 50e-6
"""Backlash along the line of action [m]."""
BEHIND = np.array([2.0 / RATIO, 1.0, 0.0]) * PLAY / RADIUS
"""Rotation of r, p and w that backlash allows: of both meshes, of the second, none [rad]."""
PLACES = ("together", "layout")
SAMPLED = ("points", "means")

rng = np.random.default_rng(7)
LAWS = {
    name: {
        "a": rng.uniform(0.0, 30e-6, COUNT),
        "b": rng.uniform(1e-6, 3e-6, COUNT),
        "c": rng.uniform(1e-6, 3e-6, COUNT),
    }
    for name in ("first", "second")
}
"""Laws at the gear nearer to the input, in the order of the torque path."""
UNITS = {"a": "rad", "b": "rad/(N*m)", "c": "rad/(N*m)^(2/3)"}
POWERS = {"a": 1.0, "b": 2.0, "c": 5.0 / 3.0}


def written(law: dict[str, np.ndarray], ratio: float, sampling: str) -> dict[str, Any]:
    """Return a law at a gear, or reversed for the other gear, whose radius is smaller by `ratio`.

    Lengths and forces along the line of action are the same: δ = r Δφ, T = r F.
    """
    order = np.arange(COUNT) if ratio == 1.0 else -np.arange(COUNT)
    found: dict[str, Any] = {"sampling": sampling}
    for key, values in law.items():
        found[key] = [
            f"{v!r} {UNITS[key]}" for v in (values[order] * ratio ** POWERS[key]).tolist()
        ]
    return found


def idlers(swapped: bool = False, sampling: str = "points", **operating: Any) -> ls.Case:
    """Return a wheel driving another through an idler; meshes may be named against the torque."""
    wheel = {"module": "3 mm"}
    laws = [
        written(LAWS["first"], RATIO if swapped else 1.0, sampling),
        # The second mesh has 25 on 40 teeth.
        written(LAWS["second"], 25.0 / 40.0 if swapped else 1.0, sampling),
    ]
    names = ("p-r", "w-p") if swapped else ("r-p", "p-w")
    return ls.Case(
        operating={"input": "r", "output": "w", "torque": "600 N*m", "positions": COUNT}
        | operating,
        gears={
            "r": {"teeth": 50, "centre": ["0 mm", "0 mm"], **wheel},
            "p": {"teeth": 25, "centre": {"about": "r", "angle": "0 deg"}, **wheel},
            "w": {"teeth": 40, "centre": {"about": "p", "angle": "50 deg"}, **wheel},
        },
        meshes={n: {"law": law} for n, law in zip(names, laws, strict=True)},
    )


def with_play(case: ls.Case) -> ls.Case:
    play = f"{PLAY!r} m"
    return case.replace({f'meshes."{m}".normal_backlash': play for m in case.meshes})


def turned(case: ls.Case) -> np.ndarray:
    """Return the rotation of every gear at every position [rad]."""
    found = ls.solve(case).positions
    return np.array([[p.rotation[gear] for gear in "rpw"] for p in found])


@pytest.mark.parametrize("sampling", SAMPLED)
@pytest.mark.parametrize("phases", PLACES)
@pytest.mark.parametrize("torque", ["600 N*m", "-600 N*m"])
@pytest.mark.parametrize("play", [False, True])
@pytest.mark.quick(6)
def test_a_machine_does_not_depend_on_the_names_of_its_meshes(sampling, phases, torque, play):
    found = []
    for swapped in (False, True):
        case = idlers(swapped, sampling, phases=phases, torque=torque)
        way = -1.0 if torque.startswith("-") else 1.0
        # Coast flanks touch after their backlash.
        behind = way * BEHIND if play and swapped == (way > 0.0) else 0.0 * BEHIND
        found.append(turned(with_play(case) if play else case) - behind)
    one, other = found
    np.testing.assert_allclose(other, one, rtol=1e-9, atol=1e-15)
    assert np.ptp(one[:, 0]) > 1e-5, "a cycle that changes nothing shows nothing"


@pytest.mark.parametrize("sampling", SAMPLED)
@pytest.mark.parametrize("phases", PLACES)
def test_coast_flanks_have_the_laws_of_the_teeth_behind_their_backlash(sampling, phases):
    """With a backlash, braking turns the gears by it; otherwise the answer is the same."""
    case = idlers(False, sampling, phases=phases, torque="-600 N*m")
    without, behind = turned(case), turned(with_play(case))
    np.testing.assert_allclose(behind, without - BEHIND, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("play", [False, True])
def test_where_torque_is_reversed_contact_passes_through_a_list_backwards(play):
    """Closed form for one mesh: Δφ = −(a + b T + c T^(2/3)) at position −k, less the backlash."""
    wheel = {"module": "3 mm"}
    case = ls.Case(
        operating={"input": "r", "output": "p", "torque": "-80 N*m", "positions": COUNT},
        gears={
            "r": {"teeth": 50, "centre": ["0 mm", "0 mm"], **wheel},
            "p": {"teeth": 25, "centre": {"about": "r", "angle": "0 deg"}, **wheel},
        },
        meshes={"r-p": {"law": written(LAWS["first"], 1.0, "points")}},
    )
    law = LAWS["first"]
    expected = -(law["a"] + law["b"] * 80.0 + law["c"] * 80.0 ** (2.0 / 3.0))[-np.arange(COUNT)]
    if play:
        case = with_play(case)
        expected = expected - PLAY / (RATIO * RADIUS)
    found = [p.rotation["r"] for p in ls.solve(case).positions]
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_a_gap_that_is_none_of_the_teeth_opens_the_drive_flank_only():
    case = idlers(torque="-600 N*m").replace({'meshes."r-p".law.a': None})
    case, gap = with_play(case), {'meshes."r-p".gap': "40 urad"}
    np.testing.assert_array_equal(turned(case.replace(gap)), turned(case))
    ahead = {"operating.torque": "600 N*m"}
    moved = turned(case.replace(gap | ahead)) - turned(case.replace(ahead))
    np.testing.assert_allclose(moved[:, 0], 40e-6, rtol=1e-9)


def two_paths(sampling: str, phases: str) -> ls.Case:
    """Return the same with a mirrored second idler: the load sharing depends on every law."""
    teeth = {"r": 50, "p": 25, "q": 25, "w": 40}
    apart, reach = 112.5, 97.5
    x = 0.5 * (150.0 + (apart**2 - reach**2) / 150.0)
    y = math.sqrt(apart**2 - x**2)
    places = {"r": (0.0, 0.0), "p": (x, y), "q": (x, -y), "w": (150.0, 0.0)}
    names = {"r-p": "first", "p-w": "second", "r-q": "second", "q-w": "first"}
    laws = {n: written(LAWS[law], 1.0, sampling) for n, law in names.items()}
    return ls.Case(
        operating={
            "input": "r",
            "output": "w",
            "torque": "600 N*m",
            "positions": COUNT,
            "phases": phases,
        },
        gears={
            g: {
                "teeth": z,
                "base_radius": f"{RADIUS * z / 25!r} m",
                "centre": [f"{v!r} mm" for v in places[g]],
            }
            for g, z in teeth.items()
        },
        meshes={n: {"law": law} for n, law in laws.items()},
        stages={"I": {"meshes": ["r-p", "r-q"]}},
    )


def carried(case: ls.Case) -> np.ndarray:
    """Return the torque of every mesh at every position [N·m]."""
    return np.array([list(p.torque.values()) for p in ls.solve(case).positions])


@pytest.mark.parametrize("sampling", SAMPLED)
@pytest.mark.parametrize("phases", PLACES)
@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
@pytest.mark.quick(2)
def test_batches_and_marches_over_both_senses_of_torque_are_their_single_solves(
    sampling, phases, engine
):
    case = with_play(two_paths(sampling, phases))
    torques = [600.0, -600.0, 80.0, -3.0]
    found = ls.solve_many(case, {"operating.torque [N*m]": torques}, engine=engine)
    assert bool(found.certified.all())
    for k, torque in enumerate(torques):
        alone = carried(case.replace({"operating.torque": f"{torque} N*m"}))
        np.testing.assert_allclose(found.torque.values[k], alone, rtol=1e-9)
    assert np.abs(found.torque.values[0] + found.torque.values[1]).max() > 10.0
    steps = 13
    swinging = [600.0 * math.cos(k) for k in range(steps)]
    march = {"march": {"gear": "r", "revolutions": 0.07, "steps": steps}}
    case = case.replace(march)
    swung = carried(case.replace({"operating.torque": [f"{t!r} N*m" for t in swinging]}))
    for k, torque in enumerate(swinging):
        alone = carried(case.replace({"operating.torque": f"{torque!r} N*m"}))
        np.testing.assert_allclose(swung[k], alone[k], rtol=1e-9)


def test_means_hold_about_their_position_and_points_from_it_on():
    """At every place of the cycle, counted from the middle of a part or from its beginning."""
    for sampling, early in (("points", 0.0), ("means", 0.5)):
        for step in range(40):
            phase = step / 40
            case = idlers(sampling=sampling, positions=COUNT)
            train = build_train(case.replace({'meshes."p-w".phase': phase}))
            for index in range(1, COUNT + 1):
                place = train.mesh_positions(index)["p-w"]
                # An exact half is the beginning of the next part.
                expected = (index - 1 + (step * COUNT + early * 40) // 40) % COUNT
                assert place == expected, (sampling, phase, index)


@pytest.mark.parametrize("running", ["counter-clockwise", "clockwise"])
@pytest.mark.parametrize("angle", ["20 deg", "-14 deg"])
def test_a_wheel_that_is_moved_along_a_helical_idler_meets_it_in_another_phase(running, angle):
    """The phase changes by Δz sin β over π m_n, the axial distance over the axial pitch.

    A right-hand tooth is further counter-clockwise the higher up: for an idler that runs in that
    sense, it is ahead there.
    """

    def helical(height: float) -> ls.Case:
        opposite = angle[1:] if angle.startswith("-") else f"-{angle}"
        changes: dict[str, Any] = {"operating.running": running, "operating.phases": "layout"}
        for gear, helix in (("r", opposite), ("p", angle), ("w", opposite)):
            changes[f"gears.{gear}.helix_angle"] = helix
            changes[f"gears.{gear}.face_width"] = "60 mm" if gear == "p" else "15 mm"
        changes["gears.w.centre.height"] = f"{height} mm"
        return idlers().replace(changes)

    # The idler runs against the input.
    ahead = -1.0 if running == "counter-clockwise" else 1.0
    before = build_train(helical(0.0)).meshes
    for height in (7.3, -12.0):
        after = build_train(helical(height)).meshes
        beta = math.radians(float(angle.split()[0]))
        shift = ahead * height * math.sin(beta) / (math.pi * 3.0)
        for which in ("phase", "coast_phase"):
            moved = getattr(after["p-w"], which) - getattr(before["p-w"], which)
            assert (moved - shift + 0.5) % 1.0 - 0.5 == pytest.approx(0.0, abs=1e-9)
            assert getattr(after["r-p"], which) == getattr(before["r-p"], which)


def test_coast_flanks_are_a_tooth_thickness_behind():
    """Half a pitch for teeth without profile shift, whatever precedes them."""
    for mesh in build_train(with_play(idlers(phases="layout"))).meshes.values():
        assert (mesh.phase - mesh.coast_phase) % 1.0 == pytest.approx(0.5, abs=1e-9)


def test_a_brake_is_where_its_coast_flanks_put_the_teeth():
    """Thin teeth reach the pitch point later from mesh to mesh; the play is that of any naming."""
    teeth, places = (20, 31, 40, 25), [(0.0, 0.0)]
    for one, other, angle in zip(teeth, teeth[1:], (0.3, -0.5, 0.4), strict=False):
        reach, (x, y) = 1.5 * (one + other), places[-1]
        places.append((x + reach * math.cos(angle), y + reach * math.sin(angle)))
    gears = {
        name: {
            "teeth": count,
            "module": "3 mm",
            "face_width": "20 mm",
            "thickness_allowance": "-0.2 mm",
            "centre": [f"{place!r} mm" for place in centre],
        }
        for name, count, centre in zip("abcd", teeth, places, strict=True)
    }
    law = {"b": [f"{1e-6 * (2.0 + math.sin(0.3 * k))!r} rad/(N*m)" for k in range(21)]}

    def brake(**mesh: Any) -> ls.Case:
        return ls.Case(
            {
                "operating": {
                    "input": "a",
                    "output": "d",
                    "torque": "-100 N*m",
                    "positions": 21,
                    "phases": "layout",
                },
                "gears": gears,
                "meshes": {name: {"law": law, **mesh} for name in ("a-b", "b-c", "c-d")},
            }
        )

    with_play, without = brake(backlash="teeth"), brake()
    turned = build_train(without).meshes
    for name, mesh in build_train(with_play).meshes.items():
        assert mesh.coast_phase == pytest.approx(turned[name].phase, abs=1e-12)
    rotations = [
        np.array([p.rotation["a"] for p in ls.solve(case).positions])
        for case in (with_play, without)
    ]
    np.testing.assert_allclose(*(r - r.mean() for r in rotations), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("first", ["wheel", "sun"])
def test_the_cycle_of_a_carrier_that_drives_is_that_of_its_planets(first):
    """It is a pitch of the held ring, whatever other gear the file names before the set."""
    data = shipped("planetary/four_planets").to_dict()
    data["operating"] |= {"input": "carrier", "output": "wheel", "torque": "100 N*m"}
    wheel = {"base_radius": "50 mm", "teeth": 77, "centre": ["0 mm", "0 mm"]}
    gears = {"wheel": wheel, **data["gears"]}
    data["gears"] = {first: gears[first]} | gears
    data["shafts"] = {"sun-wheel": {"stiffness": "rigid"}}
    train = build_train(ls.Case(data))
    assert train.turning.whole == pytest.approx(2.0 * math.pi / data["gears"]["ring"]["teeth"])


@pytest.mark.parametrize("links", [("input-p", "input-q"), ("input-q", "input-p")])
def test_of_two_gears_as_near_to_the_input_the_first_by_name_gives_the_cycle(links):
    """The order in the file does not matter; here both are on shafts of a toothless input."""
    gears: dict[str, Any] = {"input": {"type": "carrier", "centre": ["0 mm", "0 mm"]}}
    for name, teeth, partner in (("q", 31, "b"), ("p", 20, "a")):
        gears[name] = {"module": "2 mm", "teeth": teeth, "centre": ["0 mm", "0 mm"]}
        angle = {"about": name, "angle": "0 deg"}
        gears[partner] = {"module": "2 mm", "teeth": 71 - teeth, "centre": angle}
    case = ls.Case(
        operating={"input": "input", "output": "a", "torque": "9 N*m", "external": {"b": "1 N*m"}},
        gears=gears,
        meshes={name: {"stiffness": "1e5 N*m/rad"} for name in ("p-a", "q-b")},
        shafts={name: {"stiffness": "rigid"} for name in links},
    )
    assert build_train(case).cycle == "p"
