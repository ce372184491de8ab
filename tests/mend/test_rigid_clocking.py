"""A clocked rigid shaft does work: T·β is part of the energies, whatever the stiffness."""

import math
from pathlib import Path

import numpy as np
import pytest

import loadshare as ls

HERE = Path(__file__).parent


def test_a_clocked_rigid_shaft_is_certified_like_a_very_stiff_one():
    rigid = ls.load_case(HERE / "rigid_clocking.toml")
    stiff = rigid.replace({"shafts.3-5.stiffness": "1e15 N*m/rad"})
    answers = [ls.solve(case).positions[0] for case in (rigid, stiff)]
    assert all(a.certificate.passed for a in answers)
    assert answers[0].torque == pytest.approx(answers[1].torque, rel=1e-9)


@pytest.mark.parametrize("seed", range(25))
@pytest.mark.quick(10)
def test_random_split_paths_with_clocked_rigid_shafts(seed):
    """All rigid shafts of a split are clocked, in either sense, so that a path may lose contact."""
    rng = np.random.default_rng(seed)
    base = ls.load_case(HERE / "rigid_clocking.toml")
    changes: dict[str, object] = {}
    for shaft in ("2-4", "3-5"):
        clocking = f"{rng.normal() * 10.0 ** rng.uniform(-5, -2.5)} rad"
        changes |= {f"shafts.{shaft}.stiffness": "rigid", f"shafts.{shaft}.clocking": clocking}
    case = base.replace({**changes, "operating.torque": f"{10.0 ** rng.uniform(-2, 3)} N*m"})
    found = ls.solve(case).positions[0]
    assert found.certificate.passed
    # Either both paths are in contact, and their approaches differ by the clocking, or one path
    # carries everything.
    carried = found.torque["1-2"] + found.torque["1-3"]
    assert carried == pytest.approx(case.operating.input_torque[0], rel=1e-9)
    assert math.isfinite(found.certificate.worst)
