"""The ladder: the fast method first, then the back-ends, then a refusal with its reason.

Source: formulation, sections 6, 7 and 11.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.certify.oracle import ClaimedState
from tests.support import answer, disagreement, furthest, lost_contact, round_ring, shipped

import loadshare as ls
from benchmarks.random_trains.draw import draw
from loadshare.certify import certify
from loadshare.certify.residuals import turned
from loadshare.contact.plan import Role
from loadshare.errors import Refused
from loadshare.job import hot, ladder
from loadshare.job.hot import HOT, SEARCHED, hot_answers
from loadshare.job.ladder import climb, climb_all, rungs
from loadshare.job.machine import Machine
from loadshare.scene import assemble
from loadshare.settings import CERTIFY, JOB
from loadshare.solver import Options, position
from loadshare.solver.contradiction import contradiction
from loadshare.solver.hot import contact_states, vectorised
from loadshare.solver.hot.exchange import ExchangeResult, exchange, first_sets
from loadshare.solver.hot.iterate import at_rest
from loadshare.train import Train, build_train
from loadshare.train.situations import situation_of

CASES = {
    "limit ring": lambda: shipped("fgfbstts/limit_ring"),
    "every element": lambda: shipped("fgfbstts/all_elements"),
    "lost contact": lost_contact,
    "round ring": round_ring,
}


@pytest.fixture(autouse=True)
def by_numpy(monkeypatch):
    """Use the engine that tests replace, whatever was compiled before."""
    monkeypatch.setattr(hot, "available_engine", lambda _name, _count: vectorised.settle)


def failing(structure, loading, sets, parts, state, one_only):
    """Act as an engine that finds no answer on any set."""
    each = np.repeat(sets, [len(part) for part in parts], axis=0)
    return np.full(len(each), contact_states.FAILED, np.int8), each


@pytest.mark.parametrize("name", CASES)
@pytest.mark.quick(2)
def test_what_the_hot_path_leaves_the_next_rung_answers(name, monkeypatch):
    """The rung is reported; the answer is the same."""
    case = CASES[name]()
    monkeypatch.setattr(vectorised, "settle", failing)
    found = ls.solve(case, positions=[1])
    assert found.passed
    assert {p.effort.rung for p in found.positions} == {"clarabel + exact"}
    monkeypatch.undo()
    hot = ls.solve(case, positions=[1])
    assert {p.effort.rung for p in hot.positions} == {HOT}
    assert furthest(found.positions[0].torque, hot.positions[0].torque) < 1e-9


def test_what_exchange_leaves_is_searched_for(monkeypatch):
    """The proximal method finds it, and an engine of its own takes over."""
    own = Machine(build_train(shipped("fgfbstts/limit_ring")))
    exchanged = own.answer(own.situations([1, 2]), CERTIFY.tolerance, vectorised.settle)
    assert exchanged.passed.all()
    assert not exchanged.searched.any()
    with monkeypatch.context() as without:
        without.setattr(
            "loadshare.job.ways.exchange",
            lambda structure, loading, state, _, states=None, **how: exchange(
                structure, loading, state, failing, states, **how
            ),
        )
        searched = own.answer(own.situations([1, 2]), CERTIFY.tolerance, vectorised.settle)
    assert searched.passed.all()
    assert searched.searched.all()
    for one, other in zip(exchanged.equilibria.arrays, searched.equilibria.arrays, strict=True):
        # Pinion 1 may be anywhere along one direction, which the search does not settle.
        if one is not exchanged.equilibria.displacement:
            scale = np.abs(one).max(initial=1e-300)
            assert np.abs(one - other).max(initial=0.0) < 1e-9 * scale
    (found,) = climb_all(own, [1], Options(), CERTIFY.tolerance)
    assert found.rung == HOT


@pytest.mark.parametrize("lies", [False, True])
def test_samples_begin_where_the_search_for_another_ended(lies, monkeypatch):
    """One of five is searched for; if the answers of the others from there fail, all are."""
    own = Machine(build_train(shipped("fgfbstts/limit_ring")))
    indices = range(1, 6)
    expected = own.answer(own.situations(indices), CERTIFY.tolerance, vectorised.settle)
    settle, searches = vectorised.settle, [0]

    def late(structure, loading, sets, parts, state, one_only):
        searching = bool(state.stays.any())
        searches[0] += searching
        if not searches[0]:
            return failing(structure, loading, sets, parts, state, one_only)
        verdicts, proposals = settle(structure, loading, sets, parts, state, one_only)
        if lies and not searching:
            state.force[np.concatenate(parts)] *= 2.0
        return verdicts, proposals

    monkeypatch.setattr(vectorised, "settle", late)
    found = own.answer(own.situations(indices), CERTIFY.tolerance, late)
    assert found.passed.all()
    assert found.searched.tolist() == [True] + [lies] * 4
    scale = expected.equilibria.flank_force.max()
    off = np.abs(found.equilibria.flank_force - expected.equilibria.flank_force)
    assert off.max() < 1e-9 * scale


def test_an_answer_that_was_searched_for_says_so(monkeypatch):
    """It is of least norm, like any other."""
    settle, visits = vectorised.settle, []

    def slow(structure, loading, sets, parts, state, one_only):
        visits.append(bool(state.stays.any()))
        if not visits[-1]:
            return failing(structure, loading, sets, parts, state, one_only)
        return settle(structure, loading, sets, parts, state, one_only)

    monkeypatch.setattr(vectorised, "settle", slow)
    case = shipped("fgfbstts/limit_ring")
    searched = ls.explain(case)
    assert searched.rung == SEARCHED
    assert visits == sorted(visits)
    monkeypatch.undo()
    hot = ls.explain(shipped("fgfbstts/limit_ring").replace({}))
    assert hot.rung == HOT
    assert searched.equilibrium.undetermined == hot.equilibrium.undetermined
    forces, places = disagreement(hot.train, searched.equilibrium, hot.equilibrium)
    assert max(forces, places) < 1e-9
    moved = [a.equilibrium.displacement["1"] for a in (searched, hot)]
    assert moved[0] == pytest.approx(moved[1], rel=1e-9, abs=1e-15)


def test_a_wrong_set_is_not_handed_out(monkeypatch):
    """An engine accepts any set, and no search finds a better one.

    An answer that the certificate refuses goes to the next rung.
    """
    settle = vectorised.settle

    def lost(structure, loading):
        nothing = np.zeros(1, bool)
        sets = first_sets(structure, loading)
        return at_rest(structure, loading), ExchangeResult(nothing, sets, np.zeros(1, int), nothing)

    def content(structure, loading, sets, parts, state, one_only):
        settle(structure, loading, sets, parts, state, one_only)
        each = np.repeat(sets, [len(part) for part in parts], axis=0)
        return np.full(len(each), contact_states.DONE, np.int8), each

    monkeypatch.setattr(vectorised, "settle", content)
    monkeypatch.setattr("loadshare.job.ways.search", lost)
    own = Machine(build_train(shipped("fgfbstts/limit_ring")))
    answers = own.answer(own.situations([1]), CERTIFY.tolerance, content)
    assert not answers.passed.any(), "open stops are penetrated"
    assert hot_answers(own, [1], CERTIFY.tolerance) == {}
    (found,) = climb_all(own, [1], Options(), CERTIFY.tolerance)
    assert found.rung == "clarabel + exact"
    assert found.certificate.passed


@pytest.mark.parametrize("solver", ["clarabel", "cvxpy"])
def test_a_back_end_that_is_named_comes_first(solver, monkeypatch):
    """The fast method is not even tried."""

    def forbidden(*_args):
        raise AssertionError("the fast method was taken")

    monkeypatch.setattr(ladder, "hot_answers", forbidden)
    found = ls.solve(shipped("fgfbstts/limit_ring"), solver=solver, positions=[1])
    assert found.positions[0].effort.rung == f"{solver} + exact"
    assert found.stamp.solver == solver


@pytest.mark.parametrize("options", [{"method": "picard"}, {"method": "power"}, {"reduce": False}])
def test_what_only_a_back_end_can_do_is_not_given_to_the_hot_path(options):
    found = ls.solve(shipped("fgfbstts/limit_ring"), positions=[1], **options)
    assert found.positions[0].effort.rung == "clarabel + exact"


def test_the_rungs_in_order():
    names = [name for name, _ in rungs(Options())]
    assert names[:2] == ["clarabel + exact", "whole scene"]
    assert names[2:] == ["whole scene, picard", "whole scene, power"]
    assert [name for name, _ in rungs(Options(method="power", reduce=False))] == [
        "clarabel + exact",
        "whole scene, newton",
        "whole scene, picard",
    ]


def test_only_what_is_left_climbs(monkeypatch):
    """The fast method fails at one position of five; only that one climbs; the order is kept."""
    train = build_train(shipped("fgfbstts/both_errors"))
    quick = hot_answers(Machine(train), range(1, 6), CERTIFY.tolerance)
    monkeypatch.setattr(
        ladder, "hot_answers", lambda *_: {k: a for k, a in quick.items() if k != 3}
    )
    found = list(climb_all(Machine(train), range(1, 6), Options(), CERTIFY.tolerance))
    assert [a.equilibrium.index for a in found] == [1, 2, 3, 4, 5]
    assert [a.rung == HOT for a in found] == [True, True, False, True, True]


def test_the_record_of_the_hot_path():
    """Roles, redundants, visited sets and omitted inequalities can be explained."""
    found = ls.explain(shipped("fgfbstts/limit_ring"))
    assert found.rung == HOT
    assert found.record.solver == HOT
    assert found.record.kind.startswith("force method, ")
    assert found.record.rounds >= 1
    closed = {name for name, role in found.record.plan.rows.items() if role is Role.IN_PLAY}
    pushing = {name for name, f in found.equilibrium.flank_force.items() if f > 0.0}
    pushing |= {name for name, f in found.equilibrium.ring_force.items() if f > 0.0}
    assert pushing <= closed
    open_rows = {name for name, role in found.record.plan.rows.items() if role is Role.OPEN}
    assert open_rows <= {name for name, _ in found.record.removed}


def test_the_certificate_of_the_hot_path_is_that_of_the_answer():
    """It is computed on first access, and equals the result of `certify`."""
    for name in CASES:
        found = ls.explain(CASES[name]())
        again = certify(found.train, found.equilibrium)
        assert dict(found.certificate.residuals) == dict(again.residuals)
        assert dict(found.certificate.floats) == dict(again.floats)
        assert found.certificate.load == pytest.approx(again.load, rel=1e-14)
        assert found.certificate.deflection == pytest.approx(again.deflection, rel=1e-9)


# --- Contradictions ---


def squeezed(case: ls.Case, gear: str) -> ls.Case:
    """Return a case in which errors have moved two idlers by 20 µm each towards the pinion between
    them, whose ring has no clearance and is dimensioned on the drawing.
    """
    case = case.replace({f"rings.{gear}.measured": "nominal", f"rings.{gear}.clearance": "0 um"})
    train = build_train(case)
    neighbours = train.rings[gear].neighbours
    first, second = (train.gears[n].centre for n in neighbours)
    along = (second - first)[:2] / np.linalg.norm(second - first)
    moves = dict(zip(neighbours, (20e-6 * along, -20e-6 * along), strict=True))
    return case.replace(
        {f"errors.{n}.installation": [f"{float(v)!r} m" for v in c] for n, c in moves.items()}
    )


def test_a_contradiction_names_the_limits():
    """It names both arcs of the ring, and nothing that has no part in it."""
    case = squeezed(shipped("fgfbstts/limit_ring"), "4")
    scene = assemble(build_train(case), 1)
    assert set(contradiction(scene)) == {"ring 4: arc 6", "ring 4: arc 7"}
    with pytest.raises(Refused) as refused:
        ls.solve(case, positions=[1])
    message = str(refused.value)
    assert "position 1: rigid limits contradict one another" in message
    assert "ring 4: arc 6" in message
    assert "ring 4: arc 7" in message
    assert "ring 5" not in message
    assert "clearance" in message
    assert refused.value.partial is None


def test_both_rings_are_named_where_they_contradict_each_other():
    """Idler 7 pushes pinion 4 by 20 µm onto idler 6, which floats in a ring without play."""
    case = squeezed(shipped("fgfbstts/limit_ring"), "4").replace(
        {
            "gears.6.support": "free",
            "errors.6": None,
            "rings.6": {"neighbours": ["4", "10"], "clearance": "0 um", "float": "0 um"},
        }
    )
    named = contradiction(assemble(build_train(case), 1))
    assert {name.split(":")[0] for name in named} == {"ring 4", "ring 6"}
    with pytest.raises(Refused) as refused:
        ls.solve(case, positions=[1])
    assert all(name in str(refused.value) for name in named)


def test_the_positions_that_have_an_answer_are_kept():
    """An eccentric idler moves towards the pinion and away: positions at which this exceeds the
    clearance are refused, and the others are in `partial`.
    """
    case = shipped("fgfbstts/eccentricity").replace(
        {
            "gears.4.support": "free",
            "rings": {
                "4": {
                    "neighbours": ["7", "6"],
                    "clearance": "5 um",
                    "float": "5 um",
                    "measured": "nominal",
                }
            },
            "errors.6.eccentricity": {"amount": "20 um", "direction": "0 deg"},
        }
    )
    train = build_train(case)
    room = []
    for index in range(1, train.count + 1):
        here = situation_of(train, index)
        room.append(sum(here.arc(train.rings["4"], side).margin(np.zeros(3)) for side in (0, 1)))
    with pytest.raises(Refused) as refused:
        ls.solve(case)
    kept = [p.position for p in refused.value.partial.positions]
    assert kept == [k for k, r in enumerate(room, start=1) if r >= 0.0]
    assert 0 < len(kept) < train.count


@pytest.mark.parametrize("name", CASES)
def test_limits_that_can_hold_do_not_contradict(name):
    train = build_train(CASES[name]())
    for index in range(1, train.count + 1):
        assert contradiction(assemble(train, index)) == ()


def between_planets(offset: str) -> ls.Case:
    """Return a sun between the rolling rings of two planets; a round ring pins one off centre."""
    reach = 80.0 / math.cos(math.radians(20.0))
    gears = {
        "sun": {"centre": ["0 mm", "0 mm"], "base_radius": "50 mm"},
        "ring": {"centre": ["0 mm", "0 mm"], "base_radius": "110 mm", "type": "internal"},
        "p1": {"centre": [f"{reach!r} mm", "0 mm"], "base_radius": "30 mm"},
        "p2": {"centre": [f"{-reach!r} mm", "0 mm"], "base_radius": "30 mm"},
    }
    meshes = {
        mesh: {"pressure_angle": "20 deg", "stiffness": "1e6 N*m/rad"}
        for mesh in ("sun-p1", "p1-ring", "sun-p2", "p2-ring")
    }
    rings = {
        "sun": {"neighbours": ["p1", "p2"], "clearance": "0 um", "float": "100 um"},
        "p1": {"radius": "3 um", "offset": [offset, "0 um"]},
    }
    operating = {"input": "sun", "output": "ring", "torque": "100 N*m"}
    return ls.Case(operating=operating, gears=gears, meshes=meshes, rings=rings)


def test_a_round_ring_has_its_part_in_a_contradiction():
    """The planet is at least 1 µm too near, and the sun, between two rings, cannot move away.

    The arcs' sagitta over the sun's float is 0.02 µm. If the ring allows the planet its place,
    there is room.
    """
    tight = between_planets("-4 um")
    named = set(contradiction(assemble(build_train(tight), 1)))
    assert named == {"ring sun: arc p1", "ring sun: arc p2", "ring p1"}
    with pytest.raises(Refused, match="rigid limits contradict one another") as refused:
        ls.solve(tight)
    assert all(name in str(refused.value) for name in named)
    for room in ("-3 um", "-2 um", "5 um"):
        assert contradiction(assemble(build_train(between_planets(room)), 1)) == ()


def test_limits_of_drawn_trains_that_leave_no_place_are_named():
    """All rungs of the ladder used to be tried, and no set was found."""
    for number in (2600, 2863):
        with pytest.raises(Refused, match="rigid limits contradict one another: ring sun"):
            ls.solve(draw(1, number), positions=[1])


def test_room_for_the_squeeze_ends_the_contradiction():
    """The overlap is 20 µm on either side: a clearance of 21 µm is enough, 19 µm is not."""
    case = squeezed(shipped("fgfbstts/limit_ring"), "4")
    assert ls.solve(case.replace({"rings.4.clearance": "21 um"}), positions=[1]).passed
    tight = build_train(case.replace({"rings.4.clearance": "19 um"}))
    assert contradiction(assemble(tight, 1))


# --- The squeeze between opposed rigid arcs ---


def beside_the_line(distance: str = "525.6314 mm") -> ls.Case:
    """Return the seed's limit rings without clearance, idlers 1e-6 rad off the line of the arcs."""
    case = shipped("fgfbstts/limit_ring")
    for gear in ("6", "7", "8", "9"):
        case = case.replace({f"gears.{gear}.centre.distance": distance})
    return case


def squeeze(train: Train, found: ls.Result | object) -> float:
    """Return the largest force with which both arcs of a ring push at once [N]."""
    forces = found.ring_force
    return max(
        min(forces[ring.arc_name(n)] for n in ring.neighbours) for ring in train.rings.values()
    )


def test_a_float_between_opposed_arcs_rolls_or_is_refused():
    """Arcs 1e-6 rad off the line seem to wedge a float with a squeeze of 1e6 times its push. The
    float rolls away; the squeeze is never certified.
    """
    case = beside_the_line()
    train = build_train(case)
    ring = train.rings["4"]
    arcs = [situation_of(train, 1).arc(ring, side) for side in (0, 1)]
    wedge = float(np.linalg.norm(sum(a.normal(np.zeros(3)) for a in arcs)))
    assert 1e-8 < wedge < 1e-5
    for solver in ("auto", "clarabel"):
        try:
            found = ls.explain(case, solver=solver)
        except Refused:
            continue
        assert found.certificate.passed
        assert squeeze(train, found.equilibrium) < 1e-3 * found.certificate.load
        moved = max(
            abs(float(r.across @ found.equilibrium.displacement[g])) for g, r in train.rings.items()
        )
        assert moved > 1e-6, "the float has rolled to its stop"


def test_a_squeeze_is_refused_by_its_certificate():
    """It is the rolled answer with a squeeze added to both arcs of ring 4. It is balanced to 1e-6
    of the squeeze, and refused for the uncertainty of the two directions.
    """
    case = beside_the_line()
    train = build_train(case)
    found = ls.explain(case).equilibrium
    load = certify(train, found).load
    pair = {f"ring 4: arc {n}": 1e5 * load for n in ("6", "7")}
    forced = {k: v + pair.get(k, 0.0) for k, v in found.ring_force.items()}
    wedged = replace(found, ring_force=forced)
    assert "cone_membership" in certify(train, wedged).failing
    band = 1e-9 * certify(train, found).deflection
    state = ClaimedState(train, wedged)
    assert state.squeezes(band)["ring 4: arcs"] > 1e-9 * load
    assert state.squeezes(band)["ring 5: arcs"] < 1e-9 * load


def test_the_turn_of_a_squeeze():
    """y with ε y + y²/2a = band, over a: both limits in closed form."""
    distance, band = 0.16, 1e-14
    assert turned(0.0, band, distance) == pytest.approx(math.sqrt(2.0 * band / distance))
    assert turned(0.1, band, distance) == pytest.approx(band / 0.1 / distance, rel=1e-6)
    wedge = 3e-7
    y = turned(wedge, band, distance) * distance
    assert wedge * y + y * y / (2.0 * distance) == pytest.approx(band)


def test_only_rigid_arcs_between_firm_neighbours_squeeze():
    elastic = build_train(shipped("fgfbstts/limit_ring").replace({"rings.4.stiffness": "1e9 N/m"}))
    state = ClaimedState(elastic, answer(elastic)[0])
    assert state.squeezes(1e-12).keys() == {"ring 5: arcs"}
    giving = build_train(shipped("fgfbstts/all_elements"))
    assert ClaimedState(giving, answer(giving)[0]).squeezes(1e-12) == {}


def test_climbing_alone_gives_the_answer_of_the_hot_path():
    train = build_train(shipped("fgfbstts/all_elements"))
    hot = hot_answers(Machine(train), [1], CERTIFY.tolerance)[1]
    climbed = climb(train, 1, Options(), CERTIFY.tolerance)
    assert max(disagreement(train, hot.equilibrium, climbed.equilibrium)) < 1e-9


def test_the_rungs_after_the_hot_path_give_up_after_so_many_steps():
    """Lost contact needs curved solves; with too few steps, it is refused with that reason."""
    train = build_train(lost_contact())
    with pytest.raises(Refused, match="in the steps allowed"):
        climb(train, 1, Options(), CERTIFY.tolerance, steps=1)
    assert climb(train, 1, Options(), CERTIFY.tolerance, steps=JOB.steps).certificate.passed


def test_a_plan_that_never_arrives_leaves_steps_to_the_others(monkeypatch):
    """One of a floating branch without load went on and on, and no other was tried."""
    settled = position.settle

    def endless(scene, plan, solver, options, method, work):
        while method == "newton":
            work.step()
        return settled(scene, plan, solver, options, method, work)

    monkeypatch.setattr(position, "settle", endless)
    train = build_train(lost_contact())
    assert climb(train, 1, Options(), CERTIFY.tolerance, JOB.steps).certificate.passed


def test_what_a_part_of_the_load_displaces_too_far_is_refused_at_once():
    """Solving the whole load took seven seconds, without a result."""
    with pytest.raises(ls.Refused, match="under 70% of the load, the displacements are too large"):
        climb(build_train(draw(1, 3487)), 1, Options(), CERTIFY.tolerance, JOB.steps)


def test_a_refusal_tells_of_a_part_of_the_load_that_is_too_much_already():
    """Soft rings yield until the input rolls off its arc: part of the load displaces it too far."""
    with pytest.raises(ls.Refused, match="already large for the geometry") as caught:
        climb(build_train(draw(1, 1292)), 1, Options(), CERTIFY.tolerance)
    assert "under 70% of the load" in str(caught.value)
    assert "line of action turned" in str(caught.value)
