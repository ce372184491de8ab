"""A mesh gives the same with a backlash of a nanometre and without, whichever way it is loaded."""

from __future__ import annotations

import numpy as np
import pytest

import loadshare as ls
from loadshare.report.figures.train import train as drawn
from loadshare.report.flanks import carrying


def pair(torque: float, name: str = "a-b", backlash: str = "") -> ls.Case:
    mesh = {"stiffness": "1e6 N*m/rad"} | ({"normal_backlash": backlash} if backlash else {})
    return ls.Case(
        {
            "operating": {"input": "a", "output": "b", "torque": f"{torque!r} N*m"},
            "gears": {
                "a": {"base_radius": "50 mm", "centre": ["0 mm", "0 mm"]},
                "b": {"base_radius": "60 mm", "centre": ["120 mm", "0 mm"]},
            },
            "meshes": {name: mesh},
        }
    )


@pytest.mark.parametrize("torque", [-100.0, 100.0])
@pytest.mark.parametrize("name", ["a-b", "b-a"])
def test_force_error_and_flank_with_and_without_backlash(torque: float, name: str) -> None:
    """F = T/r and r₁φ₁ − r₂φ₂ = ±F/k of the gear named first; its stiffness is r²k."""
    radius = 0.05 if name == "a-b" else 0.06
    sign = np.sign(torque) * (1.0 if name == "a-b" else -1.0)
    for backlash in ("", "1 nm"):
        (p,) = ls.solve(pair(torque, name, backlash)).positions
        assert p.loads.meshes[name] == pytest.approx(sign * 2000.0, rel=1e-12)
        slack = 1e-9 if backlash and sign < 0 else 0.0
        error = sign * (2000.0 * radius**2 / 1e6 + slack)
        assert p.elastic.mesh_transmission_error[name] == pytest.approx(error, rel=1e-9)
        (flank,) = carrying(p)
        assert flank.side == ("drive flank" if sign > 0 else "coast flank")
        work = p.loads.meshes[name] * p.elastic.mesh_transmission_error[name]
        assert torque * p.elastic.transmission_error["input"] == pytest.approx(work, rel=1e-9)


def test_a_sweep_through_no_load_is_a_straight_line() -> None:
    found = ls.sweep(pair(1.0), {"operating.torque": "-100 N*m:100 N*m:5"}).dataset
    for name in ("mesh_force", "mesh_transmission_error", "torque"):
        values = found[name].values.ravel()
        assert np.diff(values) == pytest.approx(np.full(4, values[-1] / 2.0), rel=1e-9)


def test_a_drawing_without_a_result_says_which_flanks() -> None:
    assert "without backlash: loaded flanks" in str(drawn(pair(-100.0)).chart.to_dict())
    assert "loaded flanks" not in str(drawn(pair(100.0)).chart.to_dict())
