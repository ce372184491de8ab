"""The statement of a result on the proved accuracy of its torques."""

import pytest

import loadshare as ls
from loadshare.certify import Certificate
from loadshare.report.records import proved


def pair(positions: int) -> ls.Result:
    """Return the result for a pair of gears whose stiffness varies through the cycle."""
    stiffness = [f"{1e6 + 1e4 * k} N*m/rad" for k in range(positions)]
    return ls.solve(
        ls.Case(
            {
                "operating": {
                    "input": "a",
                    "output": "b",
                    "torque": "100 N*m",
                    "positions": positions,
                },
                "gears": {
                    "a": {"centre": ["0 mm", "0 mm"], "base_radius": "50 mm"},
                    "b": {"centre": ["160 mm", "0 mm"], "base_radius": "100 mm"},
                },
                "meshes": {"a-b": {"stiffness": stiffness}},
            }
        )
    )


def test_few_positions_are_looked_at_closely() -> None:
    result = pair(3)
    assert proved(result) == max(p.certificate.bound.relative for p in result.positions)


def test_many_positions_are_not_bounded_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    result = pair(40)
    monkeypatch.setattr(Certificate, "bound", property(lambda _: pytest.fail("bounded alone")))
    assert proved(result) == max(p.certificate.proved for p in result.positions) < 1e-12
