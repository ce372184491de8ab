"""A stage compares the parallel branches of a torque."""

import pytest
from tests.support import CASES

import loadshare as ls

FOUR = CASES / "planetary" / "four_planets.toml"


@pytest.mark.parametrize(
    "meshes", [["sun-planet1", "planet1-ring"], ["planet2-ring", "sun-planet3", "sun-planet2"]]
)
def test_meshes_in_series_are_no_stage(meshes):
    """Meshes of the same branch differ by the sizes of the gears, not by sharing."""
    with pytest.raises(ls.CaseError, match=r"stages\.I\.meshes.*gear planet\d first in .* second"):
        ls.load_case(FOUR).replace({"stages.I.meshes": meshes})


def test_meshes_with_their_common_gear_now_first_now_second_are_no_stage():
    """The torque at a planet differs from that at the sun, and has the opposite sign."""
    gear = {"module": "3 mm", "face_width": "20 mm"}
    centre = ["0 mm", "0 mm"]
    planets = {"teeth": 36, "copies": 3, "carrier": "carrier", "centre": {"angle": "0 deg"}}
    case = {
        "operating": {"input": "sun", "output": "carrier", "torque": "100 N*m"},
        "gears": {
            "sun": {**gear, "teeth": 18, "centre": centre},
            "p": {**gear, **planets},
            "ring": {**gear, "type": "internal", "teeth": 90, "centre": centre, "held": True},
            "carrier": {"type": "carrier", "centre": centre},
        },
        "meshes": {"p-ring": {"law": "iso"}}
        | {name: {"law": "iso"} for name in ("sun-p1", "p2-sun", "sun-p3")},
        "stages": {"I": {"meshes": ["sun-p1", "p2-sun", "sun-p3"]}},
    }
    with pytest.raises(ls.CaseError, match="has gear sun first in sun-p3 and second in p2-sun"):
        ls.Case(case)
