"""Light loads: torques 1e-8 of those that would wind the meshes by their gaps.

Compressions are then a millionth of the play that floats take up, so contacts close one after
another, many exchanges from the start of the search.
"""

from pathlib import Path

import numpy as np
import pytest

import loadshare as ls
from benchmarks.reference import reference
from loadshare.certify import certify
from loadshare.train import build_train

HERE = Path(__file__).parent
LOADS = [10.0**k for k in range(6)]


@pytest.mark.parametrize("factor", LOADS)
@pytest.mark.parametrize("name", ["light_load", "light_load_2"])
@pytest.mark.quick(3)
def test_every_load_is_certified(name, factor):
    case = ls.load_case(HERE / f"{name}.toml")
    torque = case.operating.input_torque[0] * factor
    case = case.replace({"operating.torque": f"{torque!r} N*m"})
    found = ls.explain(case)
    assert found.certificate.passed
    exact = reference(build_train(case), 1, found.equilibrium)
    forces = {**found.equilibrium.flank_force, **found.equilibrium.ring_force}
    largest = max(exact.force.values())
    assert max(abs(exact.force[n] - f) for n, f in forces.items()) < 1e-9 * largest
    furthest = max(np.abs(place).max() for place in exact.displacement.values())
    for gear in exact.displacement.keys() - exact.loose:
        moved = found.train.gears[gear].frame @ found.equilibrium.displacement[gear]
        assert np.abs(moved - exact.displacement[gear]).max() < 1e-9 * furthest


def test_a_steep_ring_is_judged_by_its_place():
    """Round-off of a place 10 µm out, times 3.6e9 N/m, is 1e-8 of such a load; a place that is
    wrong by a thousandth of the deflection is still refused.
    """
    found = ls.explain(ls.load_case(HERE / "light_load.toml"))
    assert found.certificate.passed
    one = found.equilibrium.displacement["q1"]
    ring = found.train.rings["q1"]
    outward = one - ring.offset
    moved = one + 1e-3 * found.certificate.deflection * outward / np.linalg.norm(outward)
    found.equilibrium.displacement["q1"][:] = moved
    assert "cone_membership" in certify(found.train, found.equilibrium).failing
