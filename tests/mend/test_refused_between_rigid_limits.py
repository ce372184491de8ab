"""Rigid limits that hold a float between them: their forces are found and certified."""

from pathlib import Path

import numpy as np
import pytest

import loadshare as ls
from benchmarks.reference import NoReference, reference
from loadshare.certify import certify
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium

HERE = Path(__file__).parent


def inside(distance: str, **changes: object) -> ls.Case:
    """Return rigid rings without play; pinion 4 is inside the line of its idlers (497.5 mm)."""
    case = ls.load_case(HERE / "wedge.toml")
    return case.replace({"gears.4.centre.distance": distance, **changes})


def meshes_agree(train: Train, found: Equilibrium, index: int = 1) -> bool:
    """Return whether every flank carries its force in 50 digits."""
    try:
        exact = reference(train, index, found)
    except NoReference:
        # If rigid limits may share a force arbitrarily, an answer is no start for the 50-digit
        # search.
        exact = reference(train, index)
    largest = max(exact.force[n] for n in found.flank_force)
    return all(abs(exact.force[n] - f) < 1e-9 * largest for n, f in found.flank_force.items())


@pytest.mark.parametrize("name", ["zero_play_spline", "wedge", "message"])
def test_the_case_is_certified_at_every_position(name):
    case = ls.load_case(HERE / f"{name}.toml")
    found = ls.solve(case)
    assert found.passed
    assert len(found.positions) == 5
    assert meshes_agree(build_train(case), ls.explain(case).equilibrium)


def test_a_locked_pinion_is_a_rigid_one():
    """A ring without play keeps pinion 4 in place, whatever its spline does."""
    case = ls.load_case(HERE / "zero_play_spline.toml")
    rigid = case.replace({"gears.4.support": "rigid", "splines": None, "rings.4": None})
    locked, fixed = (ls.solve(c, positions=[1]).positions[0] for c in (case, rigid))
    assert locked.torque == pytest.approx(fixed.torque, rel=1e-9)
    assert np.abs(locked.displacement["4"]).max() < 1e-18
    assert locked.floats["4"].spline_force <= 132.0 * (1.0 + 1e-9)


@pytest.mark.parametrize(
    ("play", "friction"),
    [(p, f) for p in ("0 um", "1 um") for f in ("0 N", "1e-6 N", "1 N", "132 N", "10 kN")],
)
@pytest.mark.quick(5)
def test_splines_without_clearance_in_rings_of_little_play(friction, play):
    case = ls.load_case(HERE / "zero_play_spline.toml")
    case = case.replace({"splines.4.friction_force": friction, "rings.4.float": play})
    assert ls.solve(case, positions=[1]).passed


@pytest.mark.parametrize(
    ("play", "nearer"),
    [(p, n) for p in ("0 um", "2 um", "8 um") for n in (3.0, 1.0, 0.3, 0.1, 0.03, 0.01)],
)
@pytest.mark.quick(8)
def test_a_pinion_in_a_wedge_of_its_idlers_is_held_by_both_arcs(nearer, play):
    """It is closer to gear 10 by `nearer` millimetres, and is pushed away from it."""
    case = inside(f"{497.5 - nearer!r} mm", **{"rings.4.float": play})
    found = ls.explain(case)
    assert found.certificate.passed
    assert meshes_agree(found.train, found.equilibrium)
    if play != "0 um":
        pushes = [found.equilibrium.ring_force[f"ring 4: arc {n}"] for n in ("6", "7")]
        assert min(pushes) > 0.0
        # Both arcs pass through the nominal position of the pinion.
        assert np.abs(found.equilibrium.displacement["4"]).max() < 1e-12


@pytest.mark.parametrize(
    ("name", "load"),
    [(n, k) for n in ("wedge", "zero_play_spline") for k in (1e-6, 1e-3, 1.0, 10.0)],
)
@pytest.mark.quick(4)
def test_every_load(name, load):
    case = ls.load_case(HERE / f"{name}.toml")
    torque = case.operating.input_torque[0] * load
    gone = {"operating.power": None, "operating.speed": None}
    found = ls.solve(case.replace({**gone, "operating.torque": f"{torque!r} N*m"}), positions=[1])
    assert found.passed


def test_a_wedge_is_certified_by_where_its_arcs_stand():
    """In a wedge of 1e-3 rad, a place that is off by 1e-9 of the deflection would mean a squeeze
    that balances another load; a claim that is off by 1e-3 of the deflection is refused.
    """
    found = ls.explain(ls.load_case(HERE / "wedge.toml"))
    ring = found.train.rings["4"]
    off = 1e-3 * found.certificate.deflection * ring.across
    found.equilibrium.displacement["4"][:] += off
    assert "cone_membership" in certify(found.train, found.equilibrium).failing
