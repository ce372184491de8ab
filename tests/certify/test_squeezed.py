"""Rigid limits without clearance between them may squeeze a gear with any force."""

import math

import pytest
from tests.support import CASES

import loadshare as ls


def stops(**changes: str) -> dict[str, float]:
    case = ls.load_case(CASES / "fgfbstts" / "limit_ring.toml").replace(changes)
    bound = ls.solve(case, positions=[1]).positions[0].certificate.bound
    assert bound.relative < 1e-9
    return {name: error for name, error in bound.force.items() if name.startswith("ring 4: ")}


def test_two_rigid_stops_without_clearance_share_as_they_like() -> None:
    bounds = stops(**{"rings.4.float": "0 um"})
    assert math.isinf(bounds["ring 4: upper stop"])
    assert math.isinf(bounds["ring 4: lower stop"])


@pytest.mark.parametrize(
    "changes",
    [
        {"rings.4.float": "0 um", "rings.4.stiffness": "1e9 N/m"},
        {"rings.4.float": "1 nm"},
    ],
    ids=["elastic", "with clearance"],
)
def test_what_gives_way_or_has_room_is_determined(changes: dict[str, str]) -> None:
    bounds = stops(**changes)
    assert max(bounds["ring 4: upper stop"], bounds["ring 4: lower stop"]) < 1e-3
