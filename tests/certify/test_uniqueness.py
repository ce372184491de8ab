"""Whether an answer is the only one: closed forms in which the verdict must change, and energies.

A disc is between two arcs at distances a_1 and a_2 that squeeze it with F each; only a spring k
holds it sideways. Rolling off sideways by y gains F y²/2 (1/a_1 + 1/a_2) and costs k y²/2: the
place between them is a minimum below F* = k/(1/a_1 + 1/a_2), and a saddle above.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.support import loaded, potential, shipped

import loadshare as ls
from loadshare.certify import Claims
from loadshare.job.search import search
from loadshare.train import Train, build_train
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.situations import situation_of

A1, A2 = 0.16, 0.25
SPRING, WALL = 2.0e6, 1.0e10
CRITICAL = SPRING / (1.0 / A1 + 1.0 / A2)


def squeezed_case(force: float) -> ls.Case:
    """Return a disc without tooth load; shifted neighbours make its arcs carry `force`."""
    shift = force / WALL
    gears = {
        "p": {"base_radius": "0.05 m", "centre": ["0 m", "0 m"],
              "support": ["1e3 N/m", f"{SPRING} N/m"]},
        "1": {"base_radius": "0.1 m", "centre": [f"{-A1} m", "0 m"]},
        "2": {"base_radius": "0.18 m", "centre": [f"{A2} m", "0 m"]},
        "3": {"base_radius": "0.1 m", "centre": [f"{-A1} m", "0.22 m"]},
    }  # fmt: skip
    return ls.Case(
        {
            "gears": gears,
            "meshes": {
                m: {"pressure_angle": f"{math.acos(r / a)!r} rad", "stiffness": "1e6 N*m/rad"}
                for m, r, a in (("p-1", 0.15, A1), ("2-p", 0.23, A2), ("3-1", 0.2, 0.22))
            },
            "rings": {
                "p": {
                    "neighbours": ["1", "2"],
                    "clearance": "0 m",
                    "float": "1 mm",
                    "stiffness": f"{WALL} N/m",
                    "measured": "nominal",
                }
            },
            "errors": {
                "1": {"installation": [f"{shift!r} m", "0 m"]},
                "2": {"installation": [f"{-shift!r} m", "0 m"]},
            },
            "operating": {
                "input": "2", "output": "1", "running": "counter-clockwise", "torque": "0 N*m",
                # The output takes it from its pinion 3: it only sets the scale of forces.
                "external": {"3": "1e5 N*m"},
            },
        }
    )  # fmt: skip


def squeezed(force: float) -> tuple[Train, Equilibrium]:
    """Return the place between the arcs, which is an equilibrium for any squeeze."""
    train = build_train(squeezed_case(force))
    (ring,) = train.drums
    forces = dict.fromkeys(ring.stop_names, 0.0) | {ring.arc_name(n): force for n in "12"}
    answer = Equilibrium(
        index=1,
        rotation=dict.fromkeys(train.gears, 0.0),
        displacement={g: np.zeros(3) for g in train.gears},
        flank_force=dict.fromkeys(train.meshes, 0.0),
        ring_force=forces,
        radial_reaction={},
    )
    return train, answer


@pytest.mark.parametrize("share", [0.1, 0.5, 0.99, 0.999, 1.001, 1.01, 3.0])
def test_a_disc_between_two_arcs_flips_at_the_critical_squeeze(share):
    """The curvature is F/F* for any distances, and the exact energy agrees with the verdict.

    The wall yields by F/WALL, so the centres are closer than a by that amount.
    """
    force = share * CRITICAL
    train, answer = squeezed(force)
    given = force / WALL
    (found,) = Claims.of(train, [answer]).uniquenesses
    exact = force * (1.0 / (A1 - given) + 1.0 / (A2 - given)) / SPRING
    assert found.curvature == pytest.approx(exact, rel=1e-9)
    assert found.curvature == pytest.approx(share, rel=3.0 * given / A1 + 1e-9)
    assert found.kind == ("local" if exact < 1.0 else "not proved")
    # Sideways is along y; the neighbours' rotations open the flanks, and x follows by symmetry.
    ring = train.drums[0]
    for y in (3e-6, 1e-5):
        moved = replace(answer, displacement=answer.displacement | {"p": y * ring.across})
        work = _sideways(train, moved, answer)
        assert np.sign(work) == np.sign(1.0 - exact), (y, work)


def _sideways(train, moved, answer) -> float:
    """Return the energy of springs and walls [J] that a move costs, without flanks."""
    without = {m: replace(mesh, gaps=(1.0,)) for m, mesh in train.meshes.items()}
    bare = replace(train, meshes=without)
    return potential(bare, moved) - potential(bare, answer)


def test_what_is_convex_is_reported_as_such():
    base = ls.solve(shipped("fgfbstts/full_float"), positions=[1])
    assert base.uniqueness.kind == "convex"
    assert base.uniqueness.text == "only answer: the problem is convex"


def test_an_arc_that_does_not_carry_leaves_the_least_energy():
    result = ls.solve(shipped("fgfbstts/limit_ring").replace({
        "rings.4.clearance": "1 mm", "rings.5.clearance": "1 mm",
        "rings.4.float": "1 mm", "rings.5.float": "1 mm",
    }), positions=[1])  # fmt: skip
    assert result.uniqueness.kind == "least energy"


def test_a_float_on_an_elastic_ring_is_unique_and_the_energy_says_so():
    """Random moves around the answer of an elastic ring cost energy; the verdict is in JSON."""
    case = shipped("fgfbstts/limit_ring").replace(
        {"rings.4.stiffness": "1e9 N/m", "rings.5.stiffness": "1e9 N/m"}
    )
    result = ls.solve(case, positions=[1])
    (position,) = result.positions
    assert position.uniqueness.kind == "local"
    assert 0.0 < position.uniqueness.curvature < 1e-3
    assert "arc" in position.uniqueness.where
    train, answer = build_train(case), position.equilibrium
    rest = potential(train, answer)
    rng = np.random.default_rng(5)
    floats = [r.gear for r in train.drums]
    for size in (1e-6, 1e-5, 1e-4):
        for _ in range(20):
            moved = {
                g: answer.displacement[g] + size * rng.normal(size=2) @ train.gears[g].frame
                for g in floats
            }
            there = replace(answer, displacement=dict(answer.displacement) | moved)
            assert potential(train, there) > rest
    record = result.to_dict()["positions"][0]["uniqueness"]
    assert record["kind"] == "local"
    assert record["curvature"] == position.uniqueness.curvature


def test_friction_that_follows_the_torque_is_no_convex_problem():
    case = shipped("fgfbstts/all_elements")
    result = ls.solve(case, positions=[1])
    assert result.uniqueness.kind == "local"
    assert "spline 5" in result.uniqueness.where
    assert math.isfinite(result.uniqueness.curvature)


def test_many_answers_say_what_single_ones_say():
    """Convex if nothing carries; else the arcs' part is Σ F/a of the ring where it is largest."""
    case = shipped("fgfbstts/limit_ring")
    clearances = {f"rings.{r}.clearance [mm]": [0.0, 1.0] for r in "45"}
    floats = {"rings.4.float [um]": [8.24, 1e3], "rings.5.float [um]": [2.74, 1e3]}
    found = ls.solve_many(case, clearances | floats, positions=[1])
    assert found.convex.values[:, 0].tolist() == [False, True]
    known = ls.explain(case, 1)
    train, forces = known.train, known.equilibrium.ring_force
    largest = max(
        sum(
            forces[r.arc_name(n)] / situation_of(train, 1).arc(r, side).distance
            for side, n in enumerate(r.neighbours)
        )
        for r in train.drums
    )
    np.testing.assert_allclose(found.arc_curvature.values[:, 0], [largest, 0.0], rtol=1e-6)
    following = loaded(shipped("fgfbstts/all_elements"), "3000 N*m")
    many = ls.solve_many(following, {"operating.torque [N*m]": [3000.0]}, positions=[1, 2])
    assert not many.convex.values.any()


def test_a_search_finds_the_places_beside_a_saddle():
    """Above the critical squeeze the disc rolls off to either stop, so there is another answer
    besides any that is found; below it there is none.
    """
    beyond = search(squeezed_case(3.0 * CRITICAL))
    places = [o.displacement["p"][1] for o in (beyond.answer.equilibrium, *beyond.others)]
    assert len(beyond.others) >= 1
    assert max(abs(y) for y in places) > 1e-4
    assert "other answer" in beyond.text
    below = search(squeezed_case(0.5 * CRITICAL))
    assert below.others == ()
    assert below.starts > 0


def test_an_answer_of_splines_with_memory_is_judged_where_an_arc_carries():
    """If nothing has slipped, splines hold by their shafts in the same way as by their laws."""
    changes = {
        "splines.5.normal_force": "500 N",
        "splines.5.radius": None,
        "splines.5.friction": 0.1,
        "march.revolutions": 0.3,
        "march.steps": 6,
    }
    marched = ls.march(shipped("fgfbstts/all_elements").replace(changes)).result.positions
    free = ls.solve(shipped("fgfbstts/all_elements").replace(changes)).positions
    local = [k for k, p in enumerate(marched) if p.uniqueness.kind == "local"]
    assert local
    for k in local:
        assert marched[k].uniqueness.curvature == pytest.approx(
            free[k].uniqueness.curvature, rel=0.01
        )
