import math

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.errors import CaseError
from loadshare.train import build_train


def test_a_matrix_may_differ_from_a_symmetric_one_in_its_last_digits(drive):
    """Both entries off the diagonal count alike, whichever is larger."""

    def built(xy: str, yx: str):
        matrix = [["1e8 N/m", xy], [yx, "2e8 N/m"]]
        return build_train(drive.replace({"gears.a.support": matrix})).gears["a"]

    one, other = (
        built("33333333.3 N/m", "33333333.4 N/m"),
        built("33333333.4 N/m", "33333333.3 N/m"),
    )
    assert one.support.tolist() == other.support.tolist()
    assert one.frame.tolist() == other.frame.tolist()
    assert (one.support > 0.0).all()


PIN = {"radial": "1.2e9 N/m", "tangential": "4e8 N/m"}


def test_a_pin_yields_as_the_matrix_of_its_stiffnesses():
    case = shipped("planetary/four_planets")
    pins, matrices = {}, {}
    for k in range(4):
        angle = math.radians(17.0 + 90.0 * k)
        ways = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        matrix = (ways.T @ np.diag([1.2e9, 4e8]) @ ways).tolist()
        gear = f"gears.planet{k + 1}"
        pins |= {f"{gear}.centre.angle": f"{17 + 90 * k} deg", f"{gear}.support": PIN}
        matrices[f"{gear}.support"] = [[f"{v!r} N/m" for v in row] for row in matrix]
    polar = case.replace(pins)
    one, other = (ls.solve(c).positions[0] for c in (polar, polar.replace(matrices)))
    assert one.torque == pytest.approx(other.torque, rel=1e-12)
    assert one.share["sun-planet1"] > 1.1
    for gear, place in one.displacement.items():
        assert place == pytest.approx(other.displacement[gear], abs=1e-15)


@pytest.mark.parametrize("ways", [PIN, ["radial"], ["tangential"]], ids=", ".join)
def test_stiffnesses_of_a_pin_vary_from_sample_to_sample(ways):
    case = shipped("planetary/four_planets").replace({"gears.planet1.support": PIN})
    found = ls.solve_many(case, {f"gears.planet1.support.{w} [N/m]": [1e9, 2e8] for w in ways})
    for k, stiffness in enumerate(("1e9 N/m", "2e8 N/m")):
        alone = case.replace({f"gears.planet1.support.{way}": stiffness for way in ways})
        torque = [*ls.solve(alone).positions[0].torque.values()]
        assert found.torque.values[k, 0] == pytest.approx(torque, rel=1e-12)


def test_a_pin_as_stiff_both_ways_is_one_stiffness():
    case = shipped("planetary/four_planets")
    alike = case.replace({"gears.planet1.support": dict.fromkeys(PIN, "1e9 N/m")})
    for one, other in zip(ls.solve(alike).positions, ls.solve(case).positions, strict=True):
        assert one.torque == pytest.approx(other.torque, rel=1e-12)


def test_studies_vary_a_pin():
    case = shipped("planetary/four_planets").replace({"gears.planet1.support": PIN})
    key = "gears.planet1.support.tangential"
    rate = ls.sensitivity(case, key).rates[1, key, "rising"].torque["sun-planet1"]
    ends = [
        ls.solve(case.replace({key: f"{k!r} N/m"})).positions[0].torque for k in (39.9e7, 40.1e7)
    ]
    slope = (ends[1]["sun-planet1"] - ends[0]["sun-planet1"]) / 2e6
    assert rate == pytest.approx(slope, rel=1e-4)
    assert not ls.critical(case, key, "1e8 N/m", "1e10 N/m").events


def test_only_planets_have_a_pin():
    with pytest.raises(CaseError, match=r"gears\.sun\.support\.radial .* is for planets only"):
        shipped("planetary/four_planets").replace({"gears.sun.support": PIN})
