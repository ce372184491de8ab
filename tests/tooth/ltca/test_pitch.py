"""Pitch deviations: teeth ahead of or behind their place take more or less of the load."""

from dataclasses import replace

import numpy as np
import pytest
from tests.tooth.use.pairs import FACE, SPUR, written

from loadshare.errors import CaseError
from loadshare.tooth.analysis.ltca import PairCompliance, contact_problems, ltca
from loadshare.tooth.compliance.slices import Slices
from loadshare.tooth.contact.programme import solve_contact
from loadshare.tooth.cylindrical.build import helicoid_pair
from loadshare.tooth.cylindrical.gear import HelicoidGear
from loadshare.tooth.geometry.body import PitchDeviations
from loadshare.tooth.law.file import law_of, law_text, load_law
from loadshare.tooth.pair.file import load_pair
from loadshare.tooth.unloaded.positions import transmission_error
from loadshare.tooth.unloaded.touch import contact_points

BACK = 10e-6
"""Distance by which tooth 2 of the driver is behind its place [m]."""


def pair(driver=(), driven=(), first=1):
    """Return two spur gears: ε_α = 1.68, pairs 0 and −1 in contact from phase 0.12 to 0.81."""
    common = {"module": 3e-3, "face_width": 20e-3}
    gears = [
        HelicoidGear(teeth=teeth, pitch=PitchDeviations(tuple(ahead), start), **common)
        for teeth, ahead, start in ((25, driver, first), (50, driven, 1))
    ]
    return helicoid_pair(*gears)


def independent(gears):
    """Return compliances of teeth that do not move their neighbours."""
    sides = (gears.driver, 1), (gears.driven, gears.driven_side)
    return PairCompliance(*(Slices(*side, rigid_body=True) for side in sides), "slices")


def test_a_tooth_that_stands_back_waits_for_the_load():
    """Two springs in parallel, one with a gap g: it takes load once the other yields by g.

    Both springs are those of the single pairs. Z is the deflection of the first; that of the second
    is Z − g, where g is 10 µm times cos α along the normal.
    """
    gears = pair([0.0, -BACK])
    (place,) = gears.positions([0.5], 12)
    assert [line.pair for line in place.lines] == [-1, 0]
    late, first = place.lines
    opening = BACK * np.cos(np.radians(20.0))
    np.testing.assert_allclose(late.gap, opening, rtol=1e-9)
    np.testing.assert_allclose(first.gap, 0.0, atol=1e-12)
    models = independent(gears)
    both = contact_problems(gears, [place], models)[0]
    touching = replace(late, gap=late.gap - opening)
    alone = [
        contact_problems(gears, [replace(place, lines=(line,))], models)[0]
        for line in (touching, first)
    ]

    closing = _load_for(alone[1], opening)
    before = solve_contact(both, 0.99 * closing)
    assert before.force[both.parts[0]].sum() == 0.0
    assert before.approach == pytest.approx(
        solve_contact(alone[1], 0.99 * closing).approach, rel=1e-9
    )
    for load in (1.01 * closing, 3.0 * closing):
        found = solve_contact(both, load)
        taken = [found.force[part].sum() for part in both.parts]
        assert min(taken) > 0.0
        assert sum(taken) == pytest.approx(load, rel=1e-12)
        assert solve_contact(alone[1], taken[1]).approach == pytest.approx(found.approach, rel=1e-7)
        assert solve_contact(alone[0], taken[0]).approach == pytest.approx(
            found.approach - opening, rel=1e-6
        )


def _load_for(problem, approach):
    """Return the load at which a contact yields by `approach`, by bisection."""
    low, high = 1.0, 1e6
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        if solve_contact(problem, middle).approach < approach:
            low = middle
        else:
            high = middle
    return low


@pytest.mark.parametrize(
    ("driver", "driven", "sign"), [((5e-6,) * 25, (), -1.0), ((), (5e-6,) * 50, 1.0)]
)
def test_a_whole_gear_ahead_is_turned(driver, driven, sign):
    """All teeth ahead by F turn the gear by F/r: a lead of −F/r1, or F/r2 times the ratio."""
    gears, plain = pair(driver, driven), pair()
    turn = sign * 5e-6 / 37.5e-3  # the driven gear's F/r2 times its ratio of 2 is as much
    for phase in (0.0, 0.3, 0.9):
        assert transmission_error(gears, phase) == pytest.approx(turn, rel=1e-6)
        for with_it, without in zip(
            contact_points(gears, phase), contact_points(plain, phase), strict=True
        ):
            assert with_it.lead - without.lead == pytest.approx(turn, rel=1e-6)
    one, other = (ltca(p, 100.0, 3, (1.0,), "slices", points=8) for p in (gears, plain))
    np.testing.assert_allclose(one.approach, other.approach, rtol=1e-3)


def test_the_first_contact_is_on_the_tooth_that_stands_ahead():
    """In the double zone the tooth ahead touches first; in the single zone there is no choice."""
    gears = pair([0.0, 0.0, 8e-6], first=3)  # tooth 3 is pair 0, tooth 2 is pair 1
    assert gears.driver_gear.tooth_of(0) == 3
    assert gears.driver_gear.tooth_of(-1) == 4
    assert transmission_error(gears, 0.0) == pytest.approx(-8e-6 / 37.5e-3, rel=1e-6)
    found = ltca(gears, 20.0, [0.2, 0.5, 0.7], (1.0,), "slices", points=8)
    for own in found.shares():
        assert own.get(0, 0.0) == max(own.values()) > 0.9


PITCH = '\n[driver.pitch]\ncumulative = ["0 um", "-3 um"]\n'


def test_a_pair_file_takes_them(tmp_path):
    text = SPUR.replace("positions = 2", "positions = 4") + PITCH
    given = load_pair(written(tmp_path, text))
    found = given.analyse()
    law = law_of(given, found)
    assert set(law.carried) == {"1-1", "2-2"}
    for k, own in enumerate(zip(*law.carried.values(), strict=True)):
        assert sum(own) == pytest.approx(1.0, abs=1e-3), k
    assert load_law(written(tmp_path, law_text(law), "law.toml")) == law
    assert "The teeth in contact under T are" in law.findings[-1]
    plain = load_pair(written(tmp_path, SPUR.replace("positions = 2", "positions = 4")))
    assert given.hash != plain.hash
    # The tooth behind its place softens the mesh where two pairs would carry.
    late, even = found.angle[:, -1], plain.analyse().angle[:, -1]
    assert late[0] == even[0]
    assert np.all(late[1:] > 1.1 * even[1:])
    assert law_of(plain, plain.analyse()).carried == {}


def test_single_deviations_add_up_the_other_way(tmp_path):
    """A pitch that is too long moves the next tooth back; the last pitch closes the circle."""
    single = ["3 um", "-1 um", *["0 um"] * 22, "-2 um"]
    text = SPUR + f"\n[driver.pitch]\nsingle = {single}\n".replace("'", '"')
    ahead = load_pair(written(tmp_path, text)).geometry.driver_gear.pitch.cumulative
    assert ahead[:4] == pytest.approx((0.0, -3e-6, -2e-6, -2e-6), abs=1e-18)
    assert ahead[24] == pytest.approx(-2e-6, abs=1e-18)


def test_a_face_gear_takes_them(tmp_path):
    text = FACE + '\n[driven.pitch]\ncumulative = ["-15 um"]\n'
    gears = load_pair(written(tmp_path, text)).geometry
    plain = load_pair(written(tmp_path, FACE)).geometry
    # Pair 0 is alone at phase 0.4: its tooth is behind by F, towards the pinion.
    late = [transmission_error(p, 0.4) for p in (gears, plain)]
    assert late[0] - late[1] == pytest.approx(-15e-6 / 244.5e-3 * 120 / 25, rel=1e-3)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('single = ["1 um"]', "driver.pitch.single = .*has 1 value. Allowed: 25, one per tooth"),
        ("first_tooth = 2", "needs exactly one list. Allowed: single or cumulative"),
        (f"cumulative = {['0 um'] * 26}", "has 26 values. Allowed: 25 at most, one per tooth"),
        (f"single = {['1 um'] * 25}", "adds up to 25 µm around the gear. Allowed: 0"),
        ('cumulative = ["1 um"]\nfirst_tooth = 26', "is no tooth. Allowed: 1 to 25"),
    ],
)
def test_lists_that_do_not_fit_are_reported(tmp_path, entry, message):
    text = SPUR + f"\n[driver.pitch]\n{entry}\n".replace("'", '"')
    with pytest.raises(CaseError, match=message):
        load_pair(written(tmp_path, text))
