"""Thin rims of internal gears: the thin ring, amplitudes of harmonics, shares, 50 digits.

Source: formulation, section 12; Timoshenko, Strength of Materials II: a ring under two opposite
forces changes its diameter by P R³/(E I) (π/4 − 2/π).
"""

import math

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from benchmarks.reference.solve import reference
from loadshare.train import build_train

RIM = {"gears.ring.ovalisation": "rim", "gears.ring.rim": "15 mm"}


def a_set(**changes: object) -> ls.Case:
    return shipped("planetary/four_planets").replace({**RIM, **changes})


def test_a_thin_ring_under_two_opposite_forces():
    """Eight harmonics give all but 0.2 % of it."""
    gear = a_set().gears["ring"]
    force, middle = 1000.0, gear.tooth.root + 0.0075
    bending = 206e9 * 0.06 * 0.015**3 / 12.0
    exact = force * middle**3 / bending * (math.pi / 4.0 - 2.0 / math.pi)
    even = gear.rim_stiffnesses[::2]
    found = 2.0 * sum(2.0 * force / k for k in even)
    assert found == pytest.approx(exact, rel=3e-3)
    assert found < exact


def test_a_rim_follows_from_the_outside_diameter():
    gear = a_set().gears["ring"]
    outside = f"{2e3 * gear.tooth.root + 30.0!r} mm"
    other = shipped("planetary/four_planets").replace(
        {"gears.ring.ovalisation": "rim", "gears.ring.outside_diameter": outside}
    )
    assert other.gears["ring"].rim_stiffnesses == pytest.approx(gear.rim_stiffnesses, rel=1e-12)


def test_a_rim_that_contradicts_the_outside_diameter_is_told_the_one_that_follows():
    """The rim used to count, without a message."""
    ring = shipped("planetary/four_planets").gears["ring"]
    both = {"gears.ring.rim": "15 mm", "gears.ring.outside_diameter": "500 mm"}
    follows = f"contradicts the rim: with it the diameter is {2e3 * ring.tooth.root + 30.0:g} mm"
    with pytest.raises(ls.CaseError, match=follows):
        shipped("planetary/four_planets").replace(both)
    fits = both | {"gears.ring.outside_diameter": f"{2e3 * ring.tooth.root + 30.1} mm"}
    assert shipped("planetary/four_planets").replace(fits).gears["ring"].rim_depth == 0.015
    on_web = both | {"gears.ring.web": "10 mm"}
    assert shipped("planetary/four_planets").replace(on_web).gears["ring"].rim_depth == 0.015


def test_amplitudes_are_what_the_meshes_push():
    """For every harmonic: forces times shapes over the stiffness, both computed here again."""
    case = a_set()
    train, at = build_train(case), ls.solve(case).positions[0]
    stiffnesses = case.gears["ring"].rim_stiffnesses
    for n, stiffness in enumerate(stiffnesses, start=2):
        total = 0j
        for planet in (g for g, gear in case.gears.items() if gear.carrier):
            mesh = train.meshes[f"{planet}-ring"]
            push = at.loads.meshes[mesh.name] * mesh.drive_normal
            push = push if mesh.driver == planet else -push
            place = train.gears[planet].centre - train.gears["ring"].centre
            turn = complex(place[0], place[1]) / abs(complex(place[0], place[1]))
            onto = complex(push[0], push[1]) / turn
            # The approach grows with n·p of the driver, so the force on the ring is along the push.
            total += onto.real * turn**n + onto.imag * 1j * turn**n / n
        moved = at.displacement[f"ring: harmonic {n}"]
        assert complex(*moved) == pytest.approx(total / stiffness, rel=1e-9, abs=1e-18)


@pytest.mark.parametrize("rim", ["8 mm", "15 mm", "40 mm"])
def test_shares_on_a_thin_rim_agree_with_50_digits(rim):
    case = a_set(**{"gears.ring.rim": rim})
    found, exact = ls.solve(case).positions[0], reference(build_train(case))
    assert found.torque == pytest.approx({m: float(t) for m, t in exact.torque.items()}, rel=1e-11)
    assert found.certificate.proved < 1e-11


def test_a_soft_rim_evens_out_what_a_fixed_sun_does_not():
    """A pin is out of place and everything else is held; a stiff rim is nearly rigid."""

    def spread(case: ls.Case) -> float:
        at = ls.solve(case).positions[0].torque
        return float(np.ptp([t for mesh, t in at.items() if mesh.startswith("sun-")]))

    held = {"gears.sun.support": "rigid"}
    rims = [spread(a_set(**{**held, "gears.ring.rim": rim})) for rim in ("6 mm", "12 mm", "2 m")]
    rigid = spread(shipped("planetary/four_planets").replace(held))
    assert rims[0] < 0.5 * rims[1] < 0.25 * rims[2]
    assert rims[2] == pytest.approx(rigid, rel=1e-2)


def test_batches_and_marches_have_it():
    case = a_set(march={"gear": "sun", "revolutions": 1.0, "steps": 6})
    torque = np.array([500.0, 1000.0, 2000.0])
    for engine in ("compiled", "vectorised"):
        batch = ls.solve_many(case, {"operating.torque [N*m]": torque}, engine=engine)
        assert batch.certified.all()
        alone = ls.solve(case).positions[3].torque
        for mesh, value in alone.items():
            found = float(batch.torque.sel(sample=1, mesh=mesh).values[3])
            assert found == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gears.ring.face_width": None}, r"gears\.ring\.face_width: is missing"),
        ({"gears.sun.ovalisation": ["1e8 N/m"]}, "is for internal gears only"),
        ({"gears.ring.ovalisation": ["1e8 N/m"] * 8}, r"gears\.ring\.ovalisation"),
        ({"gears.ring.ovalisation": "soft"}, r"gears\.ring\.ovalisation"),
    ],
)
def test_what_does_not_hold_is_reported(changes, message):
    with pytest.raises(ls.CaseError, match=message):
        a_set(**changes)
