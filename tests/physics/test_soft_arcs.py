"""An arc that removes almost all stiffness across it, in closed form.

An idler on the line between two gears is pressed onto the arc of one of them, of radius d, with the
force P. Along the arc its support of stiffness k acts against a side force s; the arc, which curves
away, reduces the stiffness by P/d:

    y = s / (k − P/d)  up to the stop at the float,   κ = P / (d k).

Source: formulation, section 6.
"""

from __future__ import annotations

import math

import pytest

import loadshare as ls
from loadshare.case import Case

PRESSED, DISTANCE, FLOAT = 300.0, 0.1, 20e-6
TORQUE, RADII = 18.89, (0.04, 0.05, 0.09)
ACROSS = 2.0 * TORQUE / RADII[0] * (RADII[0] + RADII[1]) / DISTANCE
"""Force of both meshes across the line of the gears [N]: both push the idler in the same direction.
"""


def idler(stiffness: float, side: float) -> Case:
    centres = (0.0, DISTANCE, DISTANCE + DISTANCE * (RADII[1] + RADII[2]) / (RADII[0] + RADII[1]))
    gears: dict[str, dict[str, object]] = {
        name: {"centre": [f"{1e3 * x!r} mm", "0 mm"], "base_radius": f"{1e3 * r!r} mm"}
        for name, x, r in zip("iab", centres, RADII, strict=True)
    }
    gears["a"]["support"] = ["1 kN/m", f"{stiffness!r} N/m"]
    return Case(
        operating={
            "input": "i",
            "output": "b",
            "torque": f"{TORQUE!r} N*m",
            "forces": {"a": [f"{-PRESSED!r} N", f"{side - ACROSS!r} N"]},
        },
        gears=gears,
        meshes={"i-a": {"stiffness": "75 kN*m/rad"}, "a-b": {"stiffness": "75 kN*m/rad"}},
        rings={"a": {"neighbours": ["i", "b"], "float": f"{1e6 * FLOAT!r} um"}},
    )


@pytest.mark.parametrize("part", [0.5, 0.857, 0.938, 0.968, 0.984, 0.997])
@pytest.mark.parametrize("side", [0.002, -0.001, 0.02, 0.2])
@pytest.mark.quick(4)
def test_the_idler_is_where_the_closed_form_has_it(part: float, side: float) -> None:
    stiffness = PRESSED / DISTANCE / part
    expected = side / (stiffness - PRESSED / DISTANCE)
    expected = math.copysign(min(abs(expected), FLOAT), side)
    (position,) = ls.solve(idler(stiffness, side)).positions
    certificate, (_, y) = position.certificate, position.displacement["a"]
    assert abs(y - expected) <= certificate.bound.place["a y"] + 1e-6 * abs(expected)
    assert certificate.bound.place["a y"] < 1e-3 * FLOAT
