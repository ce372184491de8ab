"""A load that no forces can balance is reported before any search.

Source: formulation, section 6: a load along a move that nothing resists has no equilibrium.
"""

import re

import numpy as np
import pytest
from tests.support import round_ring, shipped

import loadshare as ls
from benchmarks.random_trains.draw import draw
from loadshare.contact import ContactProblem
from loadshare.contact.runaway import runaway
from loadshare.errors import Refused
from loadshare.job import ways
from loadshare.scene import assemble
from loadshare.scene.structure import structure_of
from loadshare.solver.balance import is_unbalanced
from loadshare.train import build_train


@pytest.mark.parametrize("name", ["base", "limit_ring", "all_elements", "spline_clearance"])
def test_what_is_held_is_balanced(name):
    train = build_train(shipped(f"fgfbstts/{name}"))
    scene, structure = assemble(train, 1), structure_of(train)
    assert not is_unbalanced(structure, scene.load)
    assert not is_unbalanced(structure, np.zeros(scene.size))


def test_what_a_ring_alone_holds_is_not_reported_as_free():
    scene = assemble(build_train(round_ring()), 1)
    assert not is_unbalanced(structure_of(scene.train), scene.load)


@pytest.mark.parametrize("number", range(24))
def test_what_is_reported_as_free_moves_without_end(number):
    """The linear programme names what moves, and none of these cases is solved."""
    case = draw(11, number)
    scene = assemble(build_train(case), 1)
    if is_unbalanced(structure_of(scene.train), scene.load):
        assert runaway(scene)
        with pytest.raises(Refused, match="nothing balances the load"):
            ls.solve(case, positions=[1])


def test_nothing_is_searched_for_without_balance(monkeypatch):
    """The sun of a stepped star drifts away from its planets."""
    case = draw(11, 1)
    scene = assemble(build_train(case), 1)
    assert is_unbalanced(structure_of(scene.train), scene.load)
    monkeypatch.setattr(ways, "search", lambda *_: pytest.fail("a search was made"))
    with pytest.raises(Refused, match="nothing balances the load on gear sun rotation"):
        ls.solve(case)


@pytest.mark.parametrize("off", ["1e-5 mm", "1e-7 mm"])
def test_a_load_that_rounded_centres_alone_do_not_balance_is_told(off):
    """Sun, ring and carrier float, and the sun is slightly off centre."""
    case = shipped("planetary/four_planets")
    free = {f"gears.{gear}.support": "free" for gear in ("sun", "ring", "carrier")}
    told = r"only up to rounding in the geometry.* float of gear sun, carr"
    with pytest.raises(Refused, match=told):
        ls.solve(case.replace(free | {"gears.sun.centre": [off, off], "errors": None}))


@pytest.mark.parametrize("given", ["1 N*m", "-7000 N*m"])
@pytest.mark.parametrize("running", ["counter-clockwise", "clockwise"])
def test_torques_that_do_not_cancel_are_told_what_would(running, given):
    """The sun drives, the carrier is the output: the ring takes z_ring/z_sun of the sun's torque.

    A torque of the wrong sense presses flanks of meshes without backlash, which cannot hold it.
    """
    case = shipped("planetary/four_planets").replace({"operating.running": running})
    sun, ring = (case.gears[g].teeth for g in ("sun", "ring"))
    torque = case.operating.input_torque[0]
    free = {"gears.ring.held": False, "operating.external": {"ring": given}}
    with pytest.raises(Refused, match=r'external\.ring = "([-\d.]+) N\*m"') as caught:
        ls.solve(case.replace(free), positions=[1])
    needed = re.search(r'external\.ring = "(.*) N', str(caught.value))
    assert needed is not None
    assert float(needed[1]) == pytest.approx(torque * ring / sun, rel=1e-6)
    right = {"gears.ring.held": False, "operating.external": {"ring": f"{needed[1]} N*m"}}
    held, balanced = (ls.solve(c, positions=[1]) for c in (case, case.replace(right)))
    for name, value in held.positions[0].torque.items():
        assert balanced.positions[0].torque[name] == pytest.approx(value, rel=1e-6)


def test_what_would_balance_a_differential_has_the_sign_of_its_key():
    case = shipped("planetary/differential")
    wrong = case.replace({"operating.external.right": "-480 N*m"})
    with pytest.raises(Refused, match=r'external\.right = "-500 N\*m"'):
        ls.solve(wrong)
    third = case.replace({"operating.torque": f"{1000 / 3!r} N*m"})
    with pytest.raises(Refused, match=r'external\.right = "([-\d.]+ N\*m)"') as caught:
        ls.solve(third)
    told = re.search(r'external\.right = "(.*?)"', str(caught.value))
    assert told is not None
    assert ls.solve(third.replace({"operating.external.right": told[1]})).passed


def test_a_soft_spring_beside_stiff_ones_holds():
    """A shaft twelve decades softer than the adjacent stiffness, and the same without the shaft."""
    for soft, held in ((1.0, True), (0.0, False)):
        stiffness = np.array([[soft, -soft, 0.0], [-soft, soft + 1e11, 1e11], [0.0, 1e11, 2e11]])
        problem = ContactProblem(("x", "y", "z"), stiffness, np.array([1.0, 0.0, 0.0]))
        assert runaway(problem) == ({} if held else {"x": 1.0})


def freed(gear: str) -> ls.Case:
    """Return a pinion, an idler and a ring eccentric to the pinion; one of them is free."""
    places = {"a": ("0, 0", 0.6), "b": ("1.525, 1.328", 1.37), "c": ("-0.1, -0.642", 3.68)}
    gears: dict[str, dict[str, object]] = {
        name: {"centre": [f"{x} m" for x in centre.split(", ")], "base_radius": f"{r} m"}
        for name, (centre, r) in places.items()
    }
    gears["c"]["type"] = "internal"
    gears[gear]["support"] = "free"
    meshes = {m: {"stiffness": "1e6 N*m/rad"} for m in ("a-b", "b-c")}
    operating = {"input": "a", "output": "c", "torque": "10 N*m"}
    return ls.Case(gears=gears, meshes=meshes, operating=operating)


@pytest.mark.parametrize(("gear", "stops"), [("b", True), ("c", False)])
def test_a_backlash_is_asked_for_where_it_stops_what_moves(gear, stops):
    """Pinion and ring hold an idler between their flanks; an idler pushes a ring away with all its
    flanks.
    """
    case = freed(gear)
    with pytest.raises(Refused, match=f"nothing limits the float of gear {gear}") as caught:
        ls.solve(case)
    assert ("a backlash: " in str(caught.value)) == stops
    both = case.replace({f'meshes."{m}".backlash': "1 um" for m in case.meshes})
    if stops:
        assert ls.solve(both).passed
    else:
        with pytest.raises(Refused, match=f"nothing limits the float of gear {gear}"):
            ls.solve(both)
