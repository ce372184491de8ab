"""Loads that press other flanks of meshes without a backlash: alone, in samples, one by one."""

from __future__ import annotations

import numpy as np
import pytest

import loadshare as ls

TOOTHED = {"module": "3 mm", "face_width": "20 mm"}


def pair() -> ls.Case:
    """Return a pair named against the flow: its torque at the pinion is −T/2."""
    return ls.Case(
        {
            "operating": {"input": "w", "output": "p", "torque": "100 N*m"},
            "gears": {
                "p": {**TOOTHED, "teeth": 20, "centre": ["0 mm", "0 mm"]},
                "w": {**TOOTHED, "teeth": 40, "centre": ["90 mm", "0 mm"]},
            },
            "meshes": {"p-w": {"stiffness": "1e6 N*m/rad"}},
        }
    )


def two_sets(torque: object = "100 N*m") -> ls.Case:
    """Return two sets in series, 18/36/90: the first carrier applies 6 T to the second sun."""

    def members(stage: int, height: str) -> dict[str, dict[str, object]]:
        centre = ["0 mm", "0 mm", height]
        return {
            f"s{stage}": {**TOOTHED, "teeth": 18, "centre": centre},
            f"p{stage}": {
                **TOOTHED,
                "teeth": 36,
                "copies": 3,
                "carrier": f"c{stage}",
                "centre": {"angle": "0 deg", "height": height},
            },
            f"r{stage}": {
                **TOOTHED,
                "type": "internal",
                "teeth": 90,
                "held": True,
                "centre": centre,
            },
            f"c{stage}": {"type": "carrier", "centre": centre},
        }

    names = (f"{a}{k}-{b}{k}" for k in (1, 2) for a, b in (("s", "p"), ("p", "r")))
    return ls.Case(
        {
            "operating": {
                "input": "s1",
                "output": "c2",
                "torque": torque,
                "external": {"c1": "-50 N*m"},
                **({"positions": 2} if isinstance(torque, list) else {}),
            },
            "gears": {**members(1, "0 mm"), **members(2, "60 mm")},
            "meshes": {name: {"stiffness": "1e6 N*m/rad"} for name in names},
            "shafts": {"c1-s2": {"stiffness": "1e6 N*m/rad"}},
        }
    )


@pytest.mark.parametrize("torques", [[100.0, 50.0], [-100.0, -50.0], [0.0, 100.0, -40.0, 60.0]])
def test_torques_of_any_sign_in_any_order(torques):
    """This holds whatever was solved before for the same case."""
    case, keep = pair(), {}
    for some in (torques, torques[::-1], [-t for t in torques], torques):
        found = ls.solve_many(case, {"operating.torque [N*m]": some})
        assert found.certified.all()
        np.testing.assert_allclose(found.torque.values.ravel(), -0.5 * np.array(some), atol=1e-10)
        for torque in some:
            keep[torque] = ls.solve(case.replace({"operating.torque": f"{torque} N*m"}))
            assert keep[torque].positions[0].torque["p-w"] == pytest.approx(-0.5 * torque)


def test_a_sweep_from_zero_has_the_flanks_of_its_load():
    case = pair()
    found = ls.sweep(case, {"operating.torque": "0 N*m:100 N*m:2"}).dataset.isel({"position": 0})
    alone = ls.solve(case).dataset.isel(position=0)
    last = found.isel({"operating.torque": 1})
    for name in ("torque", "coast_torque", "torsional_stiffness", "bearing_force"):
        np.testing.assert_allclose(last[name], alone[name], rtol=1e-12, atol=1e-9)
    assert float(last["residual"].max()) < 1e-12


def test_torques_from_outside_press_other_flanks_of_sets():
    """The sun of the second set takes 600 N·m and the torque on the carrier, a third per planet."""
    case = two_sets()
    external = [-50.0, -900.0, -475.0]
    found = ls.solve_many(case, {"operating.external.c1 [N*m]": external})
    assert found.certified.all()
    for name in ("s2-p21", "s2-p22", "s2-p23"):
        np.testing.assert_allclose(
            found.torque.sel(mesh=name).values.ravel(), (600.0 + np.array(external)) / 3.0
        )
    for force in external:
        one = ls.solve(case.replace({"operating.external.c1": f"{force} N*m"}))
        assert one.positions[0].torque["s2-p21"] == pytest.approx((600.0 + force) / 3.0)


def test_positions_that_press_both_flanks_need_a_backlash():
    case = two_sets(["100 N*m", "5 N*m"])
    with pytest.raises(ls.CaseError, match=r"s2-p21.*backlash: is missing: .* both flanks in turn"):
        ls.solve(case)


def two_branches(taken: float, soft: float = 1e6, **mesh: str) -> ls.Case:
    """Return idlers 2, 2b between 1 and ring 3; idler 2, its meshes `soft`, gives off `taken`."""
    gears = {"1": ("external", 47, 0), "2": ("external", 47, 100), "2b": ("external", 47, -100)}
    gears["3"] = ("internal", 141, 0)
    stiff = {"1-2": soft, "2-3": soft, "1-2b": 3e6, "2b-3": 3e6}
    return ls.Case(
        {
            "operating": {
                "input": "1",
                "output": "3",
                "torque": "100 N*m",
                "external": {"2": f"{-taken} N*m"},
            },
            "gears": {
                n: {"type": kind, "base_radius": f"{r} mm", "centre": [f"{x} mm", "0 mm"]}
                for n, (kind, r, x) in gears.items()
            },
            "meshes": {n: {"stiffness": f"{k} N*m/rad", **mesh} for n, k in stiff.items()},
            "stages": {"I": {"meshes": ["1-2", "1-2b"]}},
        }
    )


def test_a_mesh_on_neither_flank_is_warned_of():
    """Springs k, k beside 3k, 3k: without play x/k + (x - 60)/k = 2 (100 - x)/3k, so x = 47.5."""
    exact = {"1-2": 47.5, "2-3": -12.5, "1-2b": 52.5, "2b-3": 52.5}
    without = ls.solve(two_branches(60.0, backlash="0 um"))
    assert without.positions[0].torque == pytest.approx(exact, rel=1e-9)
    assert without.positions[0].validity.verdict == "small"
    (unknown,) = ls.solve(two_branches(60.0)).positions
    # With much play, 2 gives off all that is taken: 1-2 carries 60, and 2-3 opens.
    assert unknown.torque == pytest.approx({"1-2": 60, "2-3": 0, "1-2b": 40, "2b-3": 40}, abs=1e-9)
    (measure,) = unknown.validity.warned.values()
    # It opens by (60/k - 2 * 40/3k) r, k = 1e6; the median compression of a drive flank is 60/k r.
    assert (measure.where, measure.refusal) == ("mesh 2-3", None)
    assert measure.value == pytest.approx(5 / 9, rel=1e-9)
    samples = {"operating.external.2": ["-60 N*m", "-20 N*m", "30 N*m"]}
    many = ls.solve_many(two_branches(60.0), samples)
    assert many.attrs["warned"] == 1
    assert (many.displaced.values[:, 0] > 1.0).tolist() == [True, False, False]


def test_a_mesh_whose_flank_carries_is_not_warned_of():
    """The other flank would not touch, whatever the play: the answer is that without play."""
    (found,) = ls.solve(two_branches(20.0)).positions
    (without,) = ls.solve(two_branches(20.0, backlash="0 um")).positions
    assert found.torque == pytest.approx(without.torque, rel=1e-9)
    assert found.validity.verdict == "small"


def test_a_mesh_of_warm_gears_whose_flank_carries_is_not_warned_of():
    """Flanks that have grown towards each other carry although the gears have not turned so far."""
    case = two_branches(20.0)
    case = case.replace({f"gears.{name}.temperature": "40 K" for name in ("2", "2b")})
    (found,) = ls.solve(case).positions
    assert all(abs(torque) > 1.0 for torque in found.torque.values())
    assert found.validity.verdict == "small"


def test_planets_that_errors_unload_are_not_warned_of():
    """Both loads reach the planets of the second set through its sun, so they act as one load."""
    case = two_sets().replace({"errors.p21.pin.tangential": "300 um"})
    (found,) = ls.solve(case).positions
    assert found.torque["s2-p21"] == pytest.approx(0.0, abs=1e-6)
    assert not found.validity.warned


def loop(stiffness: float, **mesh: str) -> ls.Case:
    """Return two sets that turn only as one block: power may circulate through both, either way."""
    shafts = {"r1-s2": 1e6, "c1-c2": 1e6, "s1-r2": 1e6, "s1-c1": stiffness}
    case = two_sets().to_dict()
    for name in ("r1", "r2"):
        case["gears"][name]["held"] = False
    case["operating"] = {"input": "r1", "output": "c1", "torque": "100 N*m"}
    case["shafts"] = {name: {"stiffness": f"{k} N*m/rad"} for name, k in shafts.items()}
    case["meshes"] = {name: {**given, **mesh} for name, given in case["meshes"].items()}
    return ls.Case(case)


@pytest.mark.parametrize(("stiffness", "wrong"), [(2e4, True), (1e9, False)])
def test_power_that_goes_round_may_press_either_flank(stiffness, wrong):
    """X and Y on the suns, -T - 5 X = Y, minimise the energy; 3 planets yield 1 / 6e5 there."""
    # Each part transmits a X + b T.
    sets, shafts = [(1, 0, 6e5), (5, 1, 6e5)], [(5, 1, 1e6), (30, 6, 1e6), (25, 5, 1e6)]
    parts = [*sets, *shafts, (24, 5, stiffness)]
    sun = -100.0 * sum(a * b / k for a, b, k in parts) / sum(a * a / k for a, _, k in parts)
    (exact,) = ls.solve(loop(stiffness, backlash="0 um")).positions
    assert abs(exact.torque["s1-p11"]) == pytest.approx(-sun / 3.0, rel=1e-6)
    assert abs(exact.torque["s2-p21"]) == pytest.approx(abs(100.0 + 5.0 * sun) / 3.0, rel=1e-6)
    (found,) = ls.solve(loop(stiffness)).positions
    assert bool(found.validity.warned) is wrong
    # The first sun, joined to the carriers, turns with them and pushes its planets that way.
    expected = {"s1-p11": 100.0 / 15.0, "s2-p21": 0.0} if wrong else exact.torque
    for name in ("s1-p11", "s2-p21"):
        assert found.torque[name] == pytest.approx(expected[name], rel=1e-6, abs=1e-9)


def one_set(force: str) -> ls.Case:
    """Return a set 18/36/90 on rigid pins with driven carrier and a force on planet 1 along y."""
    case = two_sets().to_dict()
    loads = {"input": "c1", "output": "s1", "torque": "100 N*m", "forces": {"p11": ["0 N", force]}}
    first = {
        part: {name: given for name, given in case[part].items() if name[1] == "1"}
        for part in ("gears", "meshes")
    }
    return ls.Case({"operating": loads, **first})


@pytest.mark.parametrize("force", [4.0, -1.0, -10.0])
def test_a_force_on_a_planet_turns_its_carrier(force):
    """Pins are 81 mm from the axis; the carrier supplies six times the torque of the sun."""
    (found,) = ls.solve(one_set(f"{force} kN")).positions
    each = -(100.0 + 81.0 * force) / 18.0
    assert found.torque == pytest.approx(
        {f"s1-p1{k}": each for k in (1, 2, 3)} | {f"p1{k}-r1": 2.0 * each for k in (1, 2, 3)}
    )
    samples = {"operating.forces.p11[1] [kN]": [4.0, force, -1.0, force]}
    many = ls.solve_many(one_set("0 N"), samples)
    assert many.certified.all()
    np.testing.assert_allclose(many.torque.sel(mesh="s1-p12").values[[1, 3], 0], each)


def test_a_force_that_turns_a_carrier_both_ways_needs_a_backlash():
    case = one_set("-10 kN").replace({"march": {"gear": "c1", "revolutions": 1.0, "steps": 4}})
    with pytest.raises(ls.CaseError, match=r"s1-p11.*backlash: is missing: .* both flanks in turn"):
        ls.solve(case)
    (still,) = ls.solve(case.replace({"operating.forces.p11[1]": "-1 kN", "march": None})).positions
    turned = ls.solve(case.replace({"operating.forces.p11[1]": "-1 kN"})).positions
    # After half a turn, the pin is on the other side of the axis.
    assert turned[0].torque["s1-p11"] == pytest.approx(still.torque["s1-p11"])
    assert turned[2].torque["s1-p11"] == pytest.approx(-(100.0 + 81.0) / 18.0)


def pushed(force: str, **mesh: str) -> ls.Case:
    """Return two branches with a force on idler 2, on an elastic bearing, instead of a torque."""
    case = two_branches(0.0, **mesh)
    support = {"gears.2.support": "1e8 N/m"}
    return case.replace(
        {**support, "operating.external": None, "operating.forces": {"2": ["0 N", force]}}
    )


@pytest.mark.parametrize(("force", "wrong"), [("-20 kN", True), ("-0.5 kN", False)])
def test_a_mesh_that_a_force_opens_is_warned_of(force, wrong):
    """The force turns one idler forwards along its partners, and the other one backwards."""
    (without,) = ls.solve(pushed(force, backlash="0 um")).positions
    assert (min(without.torque.values()) < -1.0) is wrong
    (found,) = ls.solve(pushed(force)).positions
    assert (found.validity.verdict == "large") is wrong
    if not wrong:
        assert found.torque == pytest.approx(without.torque, rel=1e-9)


def test_a_refusal_names_meshes_whose_other_flanks_would_hold():
    """A heavy sun rests on planets that press it on one flank each, under almost no torque."""
    case = one_set("0 N").replace(
        {
            "operating": {
                "input": "s1",
                "output": "c1",
                "torque": "0.01 N*m",
                "forces": {"s1": ["0 N", "-20 N"]},
            },
            "gears.s1.support": "free",
        }
    )
    with pytest.raises(ls.Refused, match=r"give meshes .*s1-p1\d.* a backlash: their") as refusal:
        ls.solve(case)
    assert "nothing limits the float of gear s1" in str(refusal.value)
    backlash = {f'meshes."s1-p1{k}".backlash': "50 um" for k in (1, 2, 3)}
    assert ls.solve(case.replace(backlash)).passed
