"""The certificate has the figures of its oracle, for right and wrong answers, for one and for many;
compiled, it gives the same verdicts. Source: formulation, section 8. The oracle uses the train's
laws and goes element by element, so they differ by round-off: 1e-9 of a figure, or 1e-12 of the
case if a figure is the small difference of large ones.
"""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, note, settings
from hypothesis import strategies as st
from tests.certify import oracle
from tests.physics.test_random_trains import split_torques, stars
from tests.reproducible import TRAINS
from tests.support import (
    SHIPPED,
    answer,
    coasting,
    loaded,
    lost_contact,
    mostly_slow,
    round_ring,
    shipped,
)

import loadshare as ls
from benchmarks import families
from loadshare.certify import RESIDUALS, Judge, Residual, Verdicts, certify
from loadshare.certify.mechanics import mechanics_of
from loadshare.certify.residuals import scaled_residuals
from loadshare.certify.state import ClaimedState
from loadshare.settings import CERTIFY
from loadshare.train import Train, build_train
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations, situation_of, stack

RELATIVE, ABSOLUTE = 1e-9, 1e-12

CLAIMS = tuple(f.name for f in fields(Equilibria) if f.name != "names")


def tabled() -> ls.Case:
    """Return a star of three whose tables have different numbers of points."""
    data = families.star(3).to_dict()
    tables = (
        {
            "torque": ["30 N*m", "100 N*m", "400 N*m"],
            "deflection": ["40 urad", "90 urad", "1 mrad"],
        },
        {"torque": ["500 N*m"], "deflection": ["0.5 mrad"]},
    )
    for mesh, table in zip(data["meshes"].values(), tables, strict=False):
        del mesh["stiffness"]
        mesh["table"] = table
    return ls.Case(data | {"assumed": []})


def never_slipping() -> ls.Case:
    """Return a spline whose clearance closes before the torque-dependent friction is overcome."""
    return shipped("fgfbstts/all_elements").replace(
        {"splines.5.friction": 0.3, "splines.5.clearance": "1 um"}
    )


def clocked() -> ls.Case:
    """Return a split-path box with two rigid shafts, one of them clocked."""
    rigid = {f"shafts.wheel{p}-pinion{p}.stiffness": "rigid" for p in "AB"}
    return families.two_path("1.2 mrad").replace({**rigid, "assumed": []})


def rolling(idle: bool = False) -> ls.Case:
    """Return a star of four on ball bearings; one planet may carry nothing."""
    bearing = {"clearance": "5 um", "ball_stiffness": "6e10 N/m^1.5"}
    aside = {"installation": {"amount": "4 um", "direction": "90 deg"}}
    case = families.star(4).replace(
        {
            "bearings": {f"planet{k}": bearing for k in range(1, 5)},
            "errors": {"planet1": aside, "planet2": aside},
        }
    )
    idling = {
        "meshes.sun-planet1.backlash": "5 mm",
        "meshes.planet1-ring.backlash": "5 mm",
        "meshes.sun-planet1.gap": "20 mrad",
        "bearings.planet1.clearance": "0 um",
    }
    return case.replace(idling if idle else {})


def idler_on_a_spline() -> ls.Case:
    """Return a planet on a spline that transmits no torque, so that its friction is round-off."""
    spline = {
        "bending_stiffness": "1e9 N/m",
        "clearance": "50 um",
        "friction": 0.1,
        "radius": "10 mm",
    }
    return families.star(3).replace({"splines": {"planet1": spline}})


def pushed() -> ls.Case:
    """A planetary set on whose planets, one of them on an elastic pin, and sun forces act."""
    forces = {"planet1": ["3 kN", "-40 N"], "planet3": ["0 N", "-700 N"], "sun": ["0 N", "-90 N"]}
    return shipped("planetary/four_planets").replace({"operating.forces": forces})


def squeezed() -> ls.Case:
    """A rigid ring that both of its neighbours press, in bearings that yield."""
    towards = {"6": ["-34.6 um", "20 um"], "7": ["34.6 um", "-20 um"]}
    return shipped("fgfbstts/limit_ring").replace(
        {
            **{f"gears.{gear}.support": "1e9 N/m" for gear in towards},
            "rings.4.measured": "nominal",
            "rings.4.float": "50 um",
            "errors": {gear: {"installation": place} for gear, place in towards.items()},
        }
    )


WAYS = {name: (lambda name=name: shipped(name)) for name in SHIPPED} | {
    "clocked rigid shaft": clocked,
    "round ring": round_ring,
    "elastic round ring": lambda: round_ring("5e8 N/m"),
    "lost contact": lost_contact,
    "coast flanks": coasting,
    "tables": tabled,
    "spline that never slips": never_slipping,
    "ball bearings": rolling,
    "idler on a spline": idler_on_a_spline,
    "pushed planets": pushed,
    "squeezed ring": squeezed,
    "no load": lambda: loaded(shipped("fgfbstts/limit_ring"), "0 N*m"),
}


QUICK = (
    "fgfbstts/all_elements",
    "fgfbstts/spline_clearance",
    "planetary/four_planets",
    "two_path/nasa",
    "clocked rigid shaft",
    "elastic round ring",
    "lost contact",
    "tables",
    "spline that never slips",
)
"""One of each kind of element; each takes a second or two."""


def claims(train: Train, indices: list[int]) -> tuple[Situations, Equilibria]:
    """Return the equilibria of some positions, by the back-end, as arrays."""
    found = Equilibria.empty(train, len(indices))
    for row, index in enumerate(indices):
        found.put(row, answer(train, index)[0])
    return stack([situation_of(train, k) for k in indices]), found


def taken(found: Equilibria, rows: np.ndarray) -> Equilibria:
    """Return some of the answers as copies."""
    return replace(found, **{name: getattr(found, name)[rows].copy() for name in CLAIMS})


def damaged(found: Equilibria, scales: dict[str, float], seed: int) -> Equilibria:
    """Return every answer with one to three of its figures scaled, reversed, dropped or shifted."""
    rng = np.random.default_rng(seed)
    wrong = taken(found, np.arange(len(found.rotation)))
    some = [name for name in CLAIMS if getattr(found, name)[0].size]
    for row in range(len(wrong.rotation)):
        for _ in range(rng.integers(1, 4)):
            name = some[rng.integers(len(some))]
            figures = getattr(wrong, name)[row].reshape(-1)
            k = rng.integers(len(figures))
            shift = rng.choice([-1.0, 1.0]) * scales[name] * 10.0 ** rng.uniform(-10.0, 0.5)
            changes = (1.001 * figures[k], -figures[k], 0.0, figures[k] + shift)
            figures[k] = changes[rng.integers(len(changes))]
    return wrong


def scales_of(train: Train, load: float, deflection: float) -> dict[str, float]:
    """Return the scales of damage to a claim: [rad], [m], [N], [N·m]."""
    radius = min(g.base_radius for g in train.gears.values())
    return {
        "rotation": deflection / radius,
        "displacement": deflection,
        "flank_force": load,
        "ring_force": load,
        "radial_reaction": load,
        "shaft_torque": load * radius,
        "support_force": load,
    }


def alike(train: Train, situations: Situations, found: Equilibria) -> Verdicts:
    """Return NumPy's verdicts; the compiled ones must be the same except for the energy gap, which
    follows from the others.
    """
    judge = Judge(train)
    many, compiled = (judge.judge(situations, found, compiled=way) for way in (False, True))
    others = residuals(train, situations, found)[:, :-1].max(axis=1) <= CERTIFY.tolerance
    due = others if train.slip is None else many.worst <= CERTIFY.tolerance
    assert compiled.passed.tolist() == (due & (many.bounds.relative <= CERTIFY.tolerance)).tolist()
    some = np.isfinite(many.worst)
    assert (compiled.worst[~some] > CERTIFY.tolerance).all()
    for scale, rows in (("load", some), ("deflection", some), ("displaced", many.passed)):
        expected = getattr(many, scale)[rows]
        np.testing.assert_allclose(getattr(compiled, scale)[rows], expected, rtol=RELATIVE)
    return many


def residuals(train: Train, situations: Situations, found: Equilibria) -> np.ndarray:
    """Return all scaled residuals, shape (S, 7)."""
    with np.errstate(all="ignore"):
        return scaled_residuals(ClaimedState(mechanics_of(train), situations, found))


def agree(train: Train, indices: list[int], situations: Situations, found: Equilibria) -> None:
    """Check that certificates of one and of many have the oracle's figures and verdicts."""
    many, figures = alike(train, situations, found), residuals(train, situations, found)
    np.testing.assert_array_equal(many.worst, figures.max(axis=1))
    for row, index in enumerate(indices):
        claimed = found.one(row, index)
        expected, single = oracle.judged(train, claimed), certify(train, claimed)
        due = [expected[name].scaled for name in RESIDUALS]
        np.testing.assert_allclose(figures[row], due, rtol=RELATIVE, atol=ABSOLUTE)
        assert single.residuals.keys() == expected.keys()
        for name, residual in single.residuals.items():
            agrees(residual, expected[name])
        assert many.passed[row] == single.passed


def agrees(residual: Residual, expected: oracle.Figures) -> None:
    """Check that a single residual has the oracle's figure, and names an element that shows it."""
    assert residual.unit == expected.unit
    scale = expected.scale
    near = {"rel": RELATIVE, "abs": ABSOLUTE * scale}
    assert residual.value == pytest.approx(expected.worst, **near)
    assert residual.scaled == pytest.approx(expected.scaled, rel=RELATIVE, abs=ABSOLUTE)
    if residual.where:
        assert expected.elements[residual.where] == pytest.approx(residual.value, **near)
    else:
        assert residual.value == 0.0


def positions(train: Train) -> list[int]:
    return sorted({1, 1 + train.count // 2, train.count})


@pytest.mark.parametrize("name", mostly_slow(WAYS, WAYS.keys() - {"fgfbstts/from_geometry"}))
@pytest.mark.quick(9)
def test_right_answers(name):
    train = build_train(WAYS[name]())
    indices = positions(train)
    situations, found = claims(train, indices)
    agree(train, indices, situations, found)
    many = Judge(train).judge(situations, found)
    assert many.passed.all()
    assert many.tolerance == CERTIFY.tolerance
    single = [certify(train, found.one(row, k)) for row, k in enumerate(indices)]
    np.testing.assert_allclose(many.load, [c.load for c in single], rtol=1e-14)
    np.testing.assert_allclose(many.deflection, [c.deflection for c in single], rtol=1e-9)


@pytest.mark.parametrize("name", mostly_slow(WAYS, QUICK))
@pytest.mark.quick(2)
def test_wrong_answers(name):
    """Thirty answers have damage in one to three places; most are refused, all in the same way."""
    train = build_train(WAYS[name]())
    first = positions(train)
    situations, found = claims(train, first)
    right = Judge(train).judge(situations, found)
    rows = np.arange(30) % len(first)
    indices = [first[row] for row in rows]
    scales = scales_of(train, float(right.load[0]), float(right.deflection[0]))
    wrong = damaged(taken(found, rows), scales, seed=len(name))
    agree(train, indices, situations.take(rows), wrong)
    many = alike(train, situations.take(rows), wrong)
    assert not many.passed.all()
    if "all_elements" in name:
        figures = residuals(train, situations.take(rows), wrong)
        assert (figures > CERTIFY.tolerance).any(axis=0).all(), (
            "a residual was never put to the test"
        )


@pytest.mark.parametrize(
    "family", mostly_slow((stars, split_torques), (stars,)), ids=["star", "split torque"]
)
def test_answers_of_random_trains(family):
    @settings(TRAINS, max_examples=6)
    @given(family(), st.integers(0, 1000))
    def run(case: ls.Case, seed: int) -> None:
        note(case.to_toml())
        train = build_train(case)
        situations, found = claims(train, [1])
        right = Judge(train).judge(situations, found)
        agree(train, [1], situations, found)
        rows = np.zeros(6, dtype=int)
        scales = scales_of(train, float(right.load[0]), float(right.deflection[0]))
        wrong = damaged(taken(found, rows), scales, seed)
        agree(train, [1] * 6, situations.take(rows), wrong)

    run()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_figure_that_is_not_a_number(bad):
    """In any claim, it makes every residual infinite, and does not affect other samples."""
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    names = [name for name in CLAIMS if getattr(found, name)[0].size]
    rows = np.zeros(len(names) + 1, dtype=int)
    wrong = taken(found, rows)
    for row, name in enumerate(names):
        getattr(wrong, name)[row].flat[-1] = bad
    many = alike(train, situations.take(rows), wrong)
    for row, name in enumerate(names):
        assert np.isinf(many.worst[row]), name
    assert many.passed.tolist() == [False] * len(names) + [True]


def test_a_spline_whose_law_drops():
    """S1 is fixed and F_m follows the torque, so the law would drop if the flanks carried little.
    Such a claim is judged and refused, as by the single certificate.
    """
    case = shipped("fgfbstts/all_elements").replace({"splines.5.stick_limit": "0.5 um"})
    train = build_train(case)
    situations, found = claims(train, [1])
    wrong = taken(found, np.zeros(2, dtype=int))
    wrong.flank_force[0] *= 1e-3
    many = alike(train, situations.take(np.zeros(2, dtype=int)), wrong)
    single = certify(train, wrong.one(0, 1))
    assert "drop" in single.residuals["cone_membership"].where
    assert np.isinf(many.worst[0])
    assert [figure.scaled for figure in single.residuals.values()] == [np.inf] * 7
    assert many.passed.tolist() == [False, True]


def test_a_gear_beyond_its_neighbour():
    """Mirrored at a neighbour, a limited gear is as far from it as before; no such place passes,
    whatever force the ring claims for it.
    """
    train = build_train(shipped("fgfbstts/limit_ring"))
    situations, found = claims(train, [1])
    places = [(ring, side) for ring in train.drums for side in (0, 1)]
    rows = np.zeros(len(places), dtype=int)
    wrong = taken(found, rows)
    order = list(train.gears)
    for row, (ring, side) in enumerate(places):
        moved = wrong.displacement[row]
        gear, neighbour = order.index(ring.gear), order.index(ring.neighbours[side])
        way = situation_of(train, 1).arc(ring, side).start + moved[gear] - moved[neighbour]
        moved[gear] -= 2.0 * way
    agree(train, [1] * len(places), situations.take(rows), wrong)
    many = alike(train, situations.take(rows), wrong)
    assert np.isinf(many.worst).all()
    for row, (ring, side) in enumerate(places):
        where = certify(train, wrong.one(row, 1)).failing["penetration"].where
        assert "beyond the neighbour" in where
        assert ring.arc_name(ring.neighbours[side]) in where


def test_a_squeeze_between_opposed_arcs():
    """Both arcs of one ring push at once, for either ring: the force that the squeeze leaves
    undetermined is the largest excess over a cone.
    """
    train = build_train(shipped("fgfbstts/limit_ring"))
    situations, found = claims(train, [1])
    rings = list(train.rings.values())
    rows = np.zeros(len(rings), dtype=int)
    wrong = taken(found, rows)
    load = certify(train, found.one(0, 1)).load
    for row, ring in enumerate(rings):
        for neighbour in ring.neighbours:
            wrong.ring_force[row, found.names.contacts.index(ring.arc_name(neighbour))] += (
                1e6 * load
            )
    alike(train, situations.take(rows), wrong)
    figures = residuals(train, situations.take(rows), wrong)
    cone = RESIDUALS.index("cone_membership")
    for row, ring in enumerate(rings):
        single = certify(train, wrong.one(row, 1)).failing["cone_membership"]
        assert single.where == f"ring {ring.gear}: arcs"
        assert figures[row, cone] == pytest.approx(single.scaled, rel=RELATIVE)


def test_a_wrong_shaft_torque_is_caught():
    """With a claimed torque, the balance does not depend on the digits of the rotations; the law
    still ties it to them.
    """
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    elastic = [k for k, s in enumerate(train.shafts.values()) if np.isfinite(s.stiffness)]
    rows = np.zeros(len(elastic), dtype=int)
    wrong = taken(found, rows)
    for row, shaft in enumerate(elastic):
        wrong.shaft_torque[row, shaft] *= 1.0 + 1e-6
    alike(train, situations.take(rows), wrong)
    figures = residuals(train, situations.take(rows), wrong)
    assert elastic
    for row in range(len(elastic)):
        failing = certify(train, wrong.one(row, 1)).failing
        assert {"moment_balance", "deformation_law"} <= failing.keys()
        assert (figures[row, [1, 4]] > CERTIFY.tolerance).all()


def test_a_wrong_support_force_is_caught():
    train = build_train(shipped("fgfbstts/all_elements"))
    situations, found = claims(train, [1])
    held = [k for k, g in enumerate(train.gears.values()) if g.support is not None]
    rows = np.zeros(len(held), dtype=int)
    wrong = taken(found, rows)
    load = float(Judge(train).judge(situations, found).load[0])
    for row, gear in enumerate(held):
        wrong.support_force[row, gear, 0] += 1e-6 * load
    alike(train, situations.take(rows), wrong)
    figures = residuals(train, situations.take(rows), wrong)
    assert len(held) > 1
    for row, k in enumerate(held):
        gear = list(train.gears.values())[k]
        failing = certify(train, wrong.one(row, 1)).failing
        assert failing["force_balance"].where.endswith(gear.name)
        # A bearing that does not exist carries nothing; an elastic one carries its displacement
        # times stiffness.
        law = "deformation_law" if gear.support[0] > 0.0 else "cone_membership"
        assert law in failing
        shown = dict(zip(RESIDUALS, figures[row] > CERTIFY.tolerance, strict=True))
        assert shown["force_balance"]
        assert shown[law]


@pytest.mark.parametrize("ratio", [1e12, 1e15])
def test_a_stiff_shaft_is_certified_by_its_claimed_torque(ratio):
    """The wind-up of a shaft that is 1e12 times as stiff as a mesh is lost in the digits of the
    rotations, and a torque that follows from them is far out of balance. The claimed torque is
    exact, and the shaft is nearly rigid.
    """
    case = shipped("fgfbstts/both_errors")
    (shaft, *_) = case.shafts
    rigid = ls.solve(case.replace({f'shafts."{shaft}".stiffness': "rigid"}), positions=[1])
    stiff = ls.explain(case.replace({f'shafts."{shaft}".stiffness': f"{4e6 * ratio!r} N*m/rad"}))
    assert certify(stiff.train, stiff.equilibrium).passed
    assert not certify(stiff.train, replace(stiff.equilibrium, shaft_torque={})).passed
    forces, expected = stiff.equilibrium.flank_force, rigid.positions[0].torque
    torque = {m.name: m.radii[0] * forces[m.name] for m in stiff.train.meshes.values()}
    assert torque == pytest.approx(expected, rel=1e-9)
