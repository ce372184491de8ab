"""Meshes through which torque would lead back to its origin."""

from __future__ import annotations

import math

import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.case import Case
from loadshare.errors import CaseError

X = (90.0**2 + 150.0**2 - 130.0**2) / 300.0
Y = math.sqrt(90.0**2 - X**2)
"""Position of an idler [mm], 90 mm from gear 1 and 130 mm from gear 2."""


def base(teeth: int) -> str:
    """Return the base radius of a gear of module 4 mm."""
    return f"{2.0 * teeth * math.cos(math.radians(20.0))!r} mm"


def two_idlers(meshes: dict[str, str], **mesh: str) -> Case:
    """Return gear 1 of 20 teeth and gear 2 of 40, with an idler of 25 teeth on either side."""
    gears: dict[str, object] = {
        "1": {"base_radius": base(20), "centre": ["0 mm", "0 mm"]},
        "2": {"base_radius": base(40), "centre": ["150 mm", "0 mm"]},
    }
    for name, side in (("a", 1), ("b", -1)):
        gears[name] = {
            "base_radius": base(25),
            "centre": [f"{X!r} mm", f"{side * Y!r} mm"],
        }
    return Case(
        operating={"input": "1", "output": "2", "torque": "100 N*m"},
        gears=gears,
        meshes={name: {"stiffness": k, **mesh} for name, k in meshes.items()},
    )


# Stiffnesses at the drivers, equal along the line of action whichever gear drives.
ALONG = {"1-a": "1e6 N*m/rad", "a-2": "1e6 N*m/rad"}
RIGHT = {**ALONG, "1-b": "1e6 N*m/rad", "b-2": "1e6 N*m/rad"}
BACK = {**ALONG, "b-1": "1.5625e6 N*m/rad", "2-b": "2.56e6 N*m/rad"}


def test_a_branch_that_is_named_from_the_output_on_is_refused():
    """With one flank per mesh it would carry nothing, and the other branch everything."""
    with pytest.raises(CaseError) as caught:
        two_idlers(BACK)
    lines = str(caught.value).splitlines()
    assert len(lines) == 2
    for name, line in zip(("b-1", "2-b"), lines, strict=True):
        assert f'meshes."{name}": carries no torque' in line
        assert "Is the mesh named driver-driven?" in line


def test_with_both_flanks_a_branch_carries_under_either_name():
    expected = ls.solve(two_idlers(RIGHT)).positions[0].torque
    assert expected["1-a"] == pytest.approx(50.0, rel=1e-9)
    found = ls.solve(two_idlers(BACK, backlash="1 nm")).positions[0].torque
    assert found["1-a"] == pytest.approx(50.0, rel=1e-3)
    assert abs(found["b-1"]) == pytest.approx(50.0 * 25 / 20, rel=1e-3)


@pytest.mark.parametrize(("torque", "clocking"), [("100 N*m", "-1 mrad"), ("-100 N*m", "1 mrad")])
def test_power_may_go_round_over_shafts(torque, clocking):
    """In this test rig, two pairs of gears brace one another because their shaft is clocked."""
    wheel = {"module": "4 mm"}
    case = Case(
        operating={"input": "A", "output": "B", "torque": torque},
        gears={
            "A": {"teeth": 20, "centre": ["0 mm", "0 mm", "0 mm"], **wheel},
            "B": {"teeth": 40, "centre": ["120 mm", "0 mm", "0 mm"], **wheel},
            "C": {"teeth": 40, "centre": ["120 mm", "0 mm", "200 mm"], **wheel},
            "D": {"teeth": 20, "centre": ["0 mm", "0 mm", "200 mm"], **wheel},
        },
        meshes={"A-B": {"stiffness": "1e6 N*m/rad"}, "C-D": {"stiffness": "4e6 N*m/rad"}},
        shafts={
            "B-C": {"stiffness": "1e5 N*m/rad", "clocking": clocking},
            "D-A": {"stiffness": "1e5 N*m/rad"},
        },
    )
    found = ls.solve(case).positions[0].torque
    # The ratio of both pairs is 1 : 2, so that only the torque from clocking circulates.
    assert abs(found["C-D"]) > 1.0


@pytest.mark.parametrize("backlash", ["100 um", "0 um", None])
def test_planets_of_a_gear_are_named_alike_where_there_is_backlash(backlash):
    """Backlash is behind the drive flank of the gear named first; a planet carried nothing."""
    case = shipped("planetary/four_planets")
    every = {"law": "iso", **({"backlash": backlash} if backlash else {})}
    mixed = {f"sun-planet{k}": every for k in (1, 3, 4)} | {"planet2-sun": every}
    rings = {f"planet{k}-ring": every for k in (1, 2, 3, 4)}
    changes = {
        **{f'meshes."{name}"': None for name in case.to_dict()["meshes"]},
        **{f'meshes."{name}"': law for name, law in (mixed | rings).items()},
        **dict.fromkeys(("stages", "assumed", "errors")),
    }
    if backlash == "100 um":
        with pytest.raises(
            CaseError, match='"planet2-sun": names its planet first, but sun-planet1'
        ):
            case.replace(changes)
        return
    torque = ls.solve(case.replace(changes)).positions[0].torque
    # The torque is that of the gear named first; a planet has twice the teeth of the sun.
    expected = [250.0, 250.0, 250.0, 500.0]
    assert [abs(torque[name]) for name in mixed] == pytest.approx(expected, rel=1e-9)
