"""Loads that press other flanks of meshes without a backlash: alone, in samples, one by one."""

from __future__ import annotations

import numpy as np
import pytest

import loadshare as ls

TOOTHED = {"module": "3 mm", "face_width": "20 mm"}


def pair() -> ls.Case:
    """A pair named against the flow: its torque at the pinion is −T/2."""
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
    """Two sets in series, 18/36/90: the first carrier brings 6 T to the second sun."""

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
    """Whatever was solved before of the same case."""
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
    """The sun of the second set takes 600 N·m and what acts on the carrier: a third a planet."""
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
    with pytest.raises(ls.CaseError, match=r"s2-p21.*backlash: is missing: .* now the other"):
        ls.solve(case)
