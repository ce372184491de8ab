"""Radial laws as five numbers, and the place of an element on such a law.

Source: formulation, sections 5 and 6. The reference is `train.radial`, which writes the same laws
as chains of pieces.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.certify.oracle import interval
from tests.reproducible import TRAINS, examples
from tests.solver.hot.trains import varied

import loadshare as ls
from benchmarks import families
from loadshare.contact.radial import RadialLaw, round_ring_law, spline_law
from loadshare.job.hot import HOT
from loadshare.job.machine import Machine
from loadshare.scene import assemble
from loadshare.scene.loading import loading_of
from loadshare.settings import CERTIFY
from loadshare.solver.hot import contact_states as at
from loadshare.solver.hot import radials, vectorised
from loadshare.train import build_train
from loadshare.train.samples import samples_of

NAN = math.nan
EVERYWHERE = (0.0, 0.3, 0.999, 1.0, 1.001, 1.5, 2.0, 4.0)
"""Radii relative to the ends of pieces."""


def graph(
    stiffness: float,
    stick: float | None,
    reach: float,
    friction: float = NAN,
    per_torque: float = 0.0,
    last: float | None = None,
    torque: float = 0.0,
) -> at.Graph:
    numbers = np.array(
        [
            [
                stiffness,
                NAN if stick is None else stick,
                reach,
                friction,
                per_torque,
                stiffness if last is None else last,
                1.0,
            ]
        ]
    )
    return at.graph(numbers, np.array([torque]))


def force(law: at.Graph, radius: float) -> float:
    """Return the force of the chain that the five numbers define, away from its steps."""
    first, stick, bound, reach, last = (float(v[0]) for v in law[:5])
    if radius <= stick:
        return first * radius
    if radius <= reach:
        return bound
    return bound + last * (radius - reach)


def tells_the_same(law: at.Graph, judge: RadialLaw, lengths: tuple[float, ...]) -> None:
    assert law.valid[0]
    scale = max(lengths) or 1e-6
    for length in (*lengths, scale):
        for factor in EVERYWHERE:
            radius = length * factor
            low, high = interval(judge, radius, 1e-9 * scale)
            if math.isinf(high):
                assert math.isinf(law.last[0])
                assert radius >= law.reach[0] * (1.0 - 1e-9)
                continue
            here = force(law, radius)
            room = 1e-9 * abs(high)
            assert low - room <= here <= high + room, (radius, low, here, high)


stiffnesses = st.sampled_from([1e6, 1.78e7, 1e9])
lengths = st.floats(0.0, 1e-4).map(lambda v: 0.0 if v < 1e-9 else v)


@settings(TRAINS, max_examples=examples(30, 60))
@given(stiffnesses, lengths, lengths, st.floats(1.0, 3.0), st.booleans())
def test_a_spline_is_the_chain_that_the_train_writes(
    stiffness, stick, clearance, jump, given_stick
):
    """With and without a jump at S1, given or continuous; friction fixed or by the torque."""
    friction = stiffness * stick * (jump if given_stick else 1.0)
    limit = stick if given_stick else None
    assume(not given_stick or clearance >= stick)
    judge = spline_law(stiffness, limit, clearance, friction)
    ends = (stick, clearance, friction / stiffness)
    tells_the_same(graph(stiffness, limit, clearance, friction), judge, ends)
    follows = graph(stiffness, limit, clearance, NAN, per_torque=20.0, torque=-friction / 20.0)
    tells_the_same(follows, judge, ends)


@settings(TRAINS, max_examples=examples(15, 30))
@given(lengths, st.sampled_from([math.inf, 1e6, 1e9]))
def test_a_round_ring_is_the_chain_that_the_train_writes(radius, stiffness):
    law = graph(0.0, 0.0, radius, 0.0, last=stiffness)
    tells_the_same(law, round_ring_law(radius, stiffness), (radius,))


@settings(TRAINS, max_examples=examples(30, 60))
@given(stiffnesses, lengths, lengths, st.floats(0.0, 3.0))
def test_a_law_without_meaning_is_reported(stiffness, stick, clearance, share):
    """If the chain would drop, or S2 is inside S1, the train raises and the fast method refuses."""
    friction = stiffness * stick * share
    assume(abs(share - 1.0) > 1e-5)
    law = graph(stiffness, stick, clearance, friction)
    try:
        spline_law(stiffness, stick, clearance, friction)
    except ValueError:
        assert not law.valid[0]
    else:
        assert law.valid[0]


def test_the_clearance_of_a_continuous_spline_may_close_first():
    """The shaft then bends throughout: one rising piece without end."""
    law = graph(1e7, None, 1e-6, 1e3)
    assert law.stick[0] == math.inf
    assert [p.name for p in spline_law(1e7, None, 1e-6, 1e3).pieces] == ["stick"]


# --- From place to place ---

STIFFNESS, STICK, CLEARANCE = 1e7, 2e-6, 8e-6
LAWS = {
    "continuous": (graph(STIFFNESS, None, CLEARANCE, STIFFNESS * STICK), at.STICK),
    "with a jump": (graph(STIFFNESS, STICK, CLEARANCE, 1.5 * STIFFNESS * STICK), at.STICK),
    "no friction": (graph(STIFFNESS, None, CLEARANCE, 0.0), at.OPEN),
    "pinned": (graph(STIFFNESS, 0.0, CLEARANCE, 30.0), at.PINNED),
    "no clearance": (graph(STIFFNESS, None, STICK, STIFFNESS * STICK), at.STICK),
    "rigid ring": (graph(0.0, 0.0, CLEARANCE, 0.0, last=math.inf), at.OPEN),
    "elastic ring": (graph(0.0, 0.0, CLEARANCE, 0.0, last=1e8), at.OPEN),
    "rigid ring without room": (graph(0.0, 0.0, 0.0, 0.0, last=math.inf), at.PINNED),
    "elastic ring without room": (graph(0.0, 0.0, 0.0, 0.0, last=1e8), at.STOP),
}
FORCE_BAND, LENGTH_BAND = 1e-9, 1e-15


def moved(law: at.Graph, place: int, radius: float, pull: float) -> int:
    """Return the place to which an element at `radius` under `pull` should move."""
    bands = np.array([FORCE_BAND]), np.array([LENGTH_BAND]), np.array([FORCE_BAND])
    offset, load = np.array([[0.6, 0.8]]) * radius, np.array([[0.6, 0.8]]) * pull
    wrong, other = radials.right_state(place, law, offset, load, *bands)
    return int(other[0]) if wrong[0] else place


def stands(law: at.Graph, place: int, pull: float, judge: float) -> tuple[float, float]:
    """Return radius and force that the law of a place gives for an intended pull or radius."""
    first, stick, bound, reach, last = (float(v[0]) for v in law[:5])
    if place == at.OPEN:
        return judge, 0.0
    if place == at.STICK:
        return pull / first, pull
    if place == at.CORNER:
        return stick, pull
    if place == at.PINNED:
        return 0.0, pull
    if place == at.SLIP:
        return judge, bound
    if place == at.STOP:
        return reach + (pull - bound) / last, pull
    return reach, pull


def settled(law: at.Graph, place: int, pull: float) -> int:
    """Return the place where an element comes to rest under a given force."""
    far = 2.0 * float(law.reach[0]) + 1e-5
    for _ in range(8):
        out = far if pull > float(law.bound[0]) else 0.0
        other = moved(law, place, *stands(law, place, pull, out))
        if other == place:
            return place
        place = other
    raise AssertionError("no end of places")


@pytest.mark.parametrize("share", [0.0, 0.5, 1.2, 1.6, 5.0])
@pytest.mark.parametrize("name", LAWS)
def test_an_element_under_a_dead_load_ends_where_the_law_says(name, share):
    """It moves from its first place, in any number of steps, to the piece that carries the load."""
    law, place = LAWS[name]
    pull = share * STIFFNESS * STICK
    first, stick, bound, reach, last = (float(v[0]) for v in law[:5])
    end = settled(law, place, pull)
    if pull <= first * stick and stick > 0.0:
        expected = at.STICK
    elif pull <= bound and bound > 0.0:
        expected = at.CORNER if stick > 0.0 else at.PINNED
    elif math.isinf(last):
        expected = at.PINNED if reach == 0.0 else (at.WALL if pull > 0.0 else at.OPEN)
    elif pull == 0.0 and bound == 0.0:
        expected = at.OPEN if reach > 0.0 else at.STOP
    else:
        expected = at.STOP
    assert end == expected


@pytest.mark.parametrize(
    ("name", "place", "radius", "back"),
    [("rigid ring", at.WALL, CLEARANCE, at.OPEN), ("with a jump", at.CORNER, STICK, at.STICK)],
)
def test_a_limit_does_not_hold_from_outside(name, place, radius, back):
    """A set may ask for this: passes then alternate between the two sides of the centre, and an
    intermediate result has a force that points inwards. A limit cannot exert such a force.
    """
    law, _ = LAWS[name]
    push = 1.2 * STIFFNESS * STICK
    assert moved(law, place, radius, push) == place
    assert moved(law, place, radius, -push) == back


@pytest.mark.parametrize("name", ["splines", "every element", "round ring", "elastic round ring"])
@pytest.mark.quick(2)
def test_a_solved_element_stands_on_its_law(name):
    """In random samples, the force of every radial element is on the train's graph at its radius,
    and the element is on the piece that its code names.
    """
    case, samples = varied(name, 60, seed=3)
    ((_, group),) = samples_of(case, samples)
    machine = Machine(group.train)
    found = machine.answer(group.situations(1), CERTIFY.tolerance, vectorised.settle)
    seen = set()
    for row in np.flatnonzero(found.passed)[:25].tolist():
        other = assemble(build_train(group.one(row)), 1)
        equilibrium = found.equilibria.one(row, 1)
        for j, radial in enumerate(other.radials):
            law = radial.law(other.train.transmitted(radial.gear, equilibrium.flank_force))
            gear, centre = other.train.gears[radial.gear], radial.centre
            radius = float(np.hypot(*(gear.frame @ equilibrium.displacement[radial.gear] - centre)))
            size = float(np.linalg.norm(equilibrium.radial_reaction[radial.name]))
            low, high = interval(law, radius, 1e-13)
            load = max(equilibrium.flank_force.values())
            assert low - 1e-9 * load <= size <= high + 1e-9 * load
            place = int(found.states[row, machine.structure.rows + j])
            seen.add(place)
            piece = {at.STICK: "stick", at.SLIP: "slip", at.STOP: "stop"}.get(place)
            names = [p.name for k, p in enumerate(law.pieces) if _on(law, k, radius)]
            if piece and "on boundary" not in names:
                assert piece in names
    assert len(seen) > 1


def _on(law: RadialLaw, piece: int, radius: float) -> bool:
    """Return whether a radius is on a piece, up to round-off."""
    begin = law.start(piece)
    end = begin + law.pieces[piece].length
    return begin - 1e-12 <= radius <= end + 1e-12


def test_torque_that_reaches_the_spline_bounds_its_friction():
    """The force method's matrix for this torque is compared with the train's own sum."""
    case, samples = varied("every element", 5, seed=4)
    ((_, group),) = samples_of(case, samples)
    machine = Machine(group.train)
    situations = group.situations(2)
    found = machine.answer(situations, CERTIFY.tolerance, vectorised.settle)
    structure = machine.structure
    loading = loading_of(structure, situations)
    flanks = slice(structure.springs, structure.springs + found.equilibria.flank_force.shape[1])
    carried = found.equilibria.flank_force @ loading.carried[:, flanks].T
    for row in range(5):
        forces = found.equilibria.one(row, 2).flank_force
        for j, radial in enumerate(structure.radials):
            torque = group.train.transmitted(radial.gear, forces)
            assert abs(carried[row, j]) == pytest.approx(abs(torque), rel=1e-12)


def test_a_ring_without_play_relieves_a_spline_that_would_pin_its_gear_too():
    """Both hold the sun in one place; their shares are undetermined, the torques are not."""
    spline = {
        "bending_stiffness": "2e7 N/m", "clearance": "10 um", "stick_limit": "0 um",
        "friction_force": "50 N",
    }  # fmt: skip
    held = families.star(3).replace({"rings": {"sun": {"radius": "0 um"}}})
    both = held.replace({"splines": {"sun": spline}})
    for case in (held, both):
        found = ls.explain(case, 1)
        assert found.rung == HOT
        torques = ls.solve(case).positions[0].torque
        assert torques == pytest.approx(ls.solve(held).positions[0].torque, rel=1e-12)
    # If their centres differ, the force of the spline is determined.
    aside = both.replace({"rings.sun.offset": ["15 um", "0 um"]})
    found = ls.explain(aside, 1).equilibrium
    pushed = 50.0 + 2e7 * 5e-6
    assert np.linalg.norm(found.radial_reaction["spline sun"]) == pytest.approx(pushed, rel=1e-9)


def test_a_spline_without_an_end_beside_a_rolling_bearing_has_its_graph():
    """The wall of a ball bearing is its tangent, 1.5 K √gap (R − begin); warnings are errors."""
    spline, ball = (
        [1.0, np.nan, np.inf, 2.0, np.nan, 1.0, 1.0, 1e-12],
        [0, np.nan, 1e-5, 0, np.nan, 1e9, 1.5, 1e-12],
    )
    found = at.graph(np.array([spline, ball]), np.zeros(2), np.array([0.0, 2e-5]))
    assert found.reach.tolist() == pytest.approx([np.inf, 1e-5 + 1e-5 / 3.0])
    assert found.last.tolist() == pytest.approx([1.0, 1.5e9 * np.sqrt(1e-5)])


def test_friction_without_an_end_stands_beside_a_ball_bearing():
    friction = [0.0, np.nan, np.inf, 2.0, np.nan, np.inf, 1.0, 1e-12]
    ball = [0.0, 0.0, 1e-5, 0.0, np.nan, 8e6, 1.5, 1e-12]
    found = at.graph(np.array([friction, ball]), np.zeros(2), np.array([np.inf, 2e-5]))
    assert found.reach[0] == found.last[0] == np.inf
