"""The whole programme gives an answer if forces leave the place of floats undetermined.

At the least norm of the free displacements, contacts without force open and close without end; an
interior-point method keeps away from them. Source: formulation, section 11.
"""

import math

import numpy as np
import pytest

import loadshare as ls

REDUCED = 1e-10


def star(seed: int) -> ls.Case:
    """Return four planets; the first, unloaded behind a gap, floats in a stiff ring."""
    rng = np.random.default_rng(seed)
    angle, sun, planet = math.radians(20.0), 0.04, 0.05
    distance = (sun + planet) / math.cos(angle)

    def micrometres(size: float) -> list[str]:
        return [f"{float(v)!r} um" for v in size * rng.normal(size=2)]

    gears = {
        "s": {"centre": ["0 m", "0 m"], "base_radius": f"{sun} m"},
        "r": {
            "centre": ["0 m", "0 m"],
            "type": "internal",
            "base_radius": f"{sun + 2.0 * planet} m",
            "support": f"{10.0 ** rng.uniform(6, 8)!r} N/m",
        },
    }
    meshes = {}
    for k in range(4):
        at = math.radians(90.0 * k + rng.uniform(-5.0, 5.0))
        centre = [f"{distance * math.cos(at)!r} m", f"{distance * math.sin(at)!r} m"]
        gears[f"p{k}"] = {"centre": centre, "base_radius": f"{planet} m"}
        for name in (f"s-p{k}", f"p{k}-r"):
            c = f"{10.0 ** rng.uniform(-6, -4)!r} rad/(N*m)^(2/3)"
            meshes[name] = {"pressure_angle": "20 deg", "law": {"b": "0 rad/(N*m)", "c": c}}
    gears["p0"]["support"] = "free"
    meshes["s-p0"]["gap"] = "5 mrad"
    return ls.Case(
        {
            "title": "Star",
            "source": "drawn at random",
            "operating": {"input": "s", "output": "r", "torque": "20 N*m"},
            "gears": gears,
            "meshes": meshes,
            "rings": {
                "p0": {"radius": "16 um", "stiffness": "6e7 N/m", "offset": micrometres(4.0)}
            },
            "errors": {g: {"installation": micrometres(40.0)} for g in ("s", "p1", "p3")},
        }
    )


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.quick(5)
def test_floats_that_nothing_places_do_not_keep_the_whole_programme_from_an_answer(seed):
    case = star(seed)
    usual, whole = (ls.solve(case, reduce=reduce).positions[0] for reduce in (True, False))
    assert any(name.startswith("gear p0") for name in usual.undetermined)
    largest = max(abs(t) for t in usual.torque.values())
    for name, torque in usual.torque.items():
        assert abs(whole.torque[name] - torque) <= REDUCED * largest, name
