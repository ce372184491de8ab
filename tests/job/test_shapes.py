"""Cases of one shape share a machine, and their answers do not depend on that."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.case.recent import Recent
from loadshare.job import positions
from loadshare.train import build_train
from loadshare.train.shape import shape_of

CHANGES: list[tuple[str, dict[str, Any], bool]] = [
    ("fgfbstts/limit_ring", {"operating.power": "1400 kW"}, True),
    ("fgfbstts/limit_ring", {"rings.4.float": "2 um"}, True),
    ("fgfbstts/limit_ring", {"rings.4.float": "0 um"}, False),
    ("fgfbstts/limit_ring", {"errors.6.installation": ["11 um", "-3 um"]}, True),
    ("fgfbstts/all_elements", {"operating.power": "700 kW"}, True),
    ("fgfbstts/full_float", {"splines.4.clearance": "0.3 mm"}, True),
    ("fgfbstts/base", {'meshes."4-6".stiffness': "2e6 N*m/rad"}, True),
    ("planetary/four_planets", {"operating.torque": "777 N*m"}, True),
    ("planetary/four_planets", {"gears.sun.support": "3e7 N/m"}, False),
    ("planetary/four_planets", {"errors.planet2.pin.tangential": "44 um"}, True),
    ("planetary/four_planets", {"gears.ring.support": "1e9 N/m"}, False),
]


@pytest.mark.parametrize(("name", "changes", "alike"), CHANGES)
@pytest.mark.parametrize("engine", ["vectorised", "compiled"])
@pytest.mark.quick(6)
def test_an_answer_does_not_depend_on_what_was_solved_before(
    name: str, changes: dict[str, Any], alike: bool, engine: str, monkeypatch: Any
) -> None:
    """They agree bit for bit, whether the machine is shared or their own."""
    case = shipped(name)
    changed = case.replace(changes)
    shapes = [shape_of(build_train(each)) for each in (case, changed)]
    assert (shapes[0] == shapes[1]) == alike
    found = []
    for before in (None, case):
        monkeypatch.setattr(positions, "_shapes", type(positions._shapes)())
        if before is not None:
            ls.solve(before.replace({"title": "before"}), engine=engine)
        found.append(ls.solve(changed.replace({"title": "after"}), engine=engine))
    for own, shared in zip(found[0].positions, found[1].positions, strict=True):
        assert own.torque == shared.torque
        assert own.claim == shared.claim
        assert own.floats == shared.floats
        assert own.certificate.proved == shared.certificate.proved


def test_only_the_last_shapes_are_kept(monkeypatch: Any) -> None:
    monkeypatch.setattr(positions, "_shapes", type(positions._shapes)())
    case = shipped("fgfbstts/base")
    for k in np.arange(1, 25):
        radius = {"gears.4.base_radius": f"{45.0 + 0.01 * k} mm"}
        try:
            ls.solve(case.replace(radius), positions=[1])
        except (ls.CaseError, ls.Refused):
            continue
    assert len(positions._shapes) <= positions.JOB.recent


def test_what_was_made_may_be_looked_at_while_more_is_made() -> None:
    """Two threads that solve side by side do this."""
    case = shipped("fgfbstts/base")
    recent: Recent[int] = Recent()
    for k in range(2):
        recent.keep(case, k, k)
    looked = iter(recent)
    assert next(looked) == 1
    for k in range(2, 3 * positions.JOB.recent):
        recent.keep(case, k, k)
    assert list(looked) == [0]
    assert len(list(recent)) == positions.JOB.recent
    assert next(iter(recent)) == 3 * positions.JOB.recent - 1
