"""The first screen: the largest forces are those of flanks, and K_γ is over all positions."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.certify import FloatState
from loadshare.certify.floats import Touch
from loadshare.report import records
from loadshare.report.flanks import carrying, reaction_size
from loadshare.report.verdict import largest_forces, measure_of, sharing
from loadshare.report.words import rest_lines
from loadshare.results.share import load_factors


@pytest.mark.parametrize("power", ["20 kW", "0 kW", "-2000 kW"])
def test_the_largest_force_of_a_flank_is_no_difference_of_flanks(power):
    """In a jammed mesh, each flank carries more than the mesh transmits."""
    case = shipped("fgfbstts/all_elements").replace({"operating.power": power})
    result = ls.solve(case, positions=[1, 5, 11])
    forces = [(f, name) for p in result.positions for name, f in p.equilibrium.flank_force.items()]
    most, flank = max(forces)
    first = next(largest_forces(result))
    assert first["value"].value == most
    assert first["where"].text.startswith(f"mesh {flank.replace(' coast', ', coast flank')}")
    closed = [flank.mesh for flank in carrying(result.positions[0])]
    assert len(closed) > len({*closed})


def test_it_is_called_k_gamma_where_all_positions_are_there(all_elements, limit_ring):
    assert measure_of(limit_ring) == "Kγ"
    assert sharing(limit_ring).columns[-1].title == "Ω = Kγ"
    assert measure_of(all_elements) == "Ω at 4 of 20"
    one = ls.solve(shipped("fgfbstts/limit_ring"), positions=[3])
    assert sharing(one).columns[-1].title == "Ω at position 3"


@pytest.mark.parametrize(("size", "shown"), [(1.4e-6, 0.0), (1.4e-2, 1.4e-2)])
def test_a_reaction_of_round_off_is_none(size, shown):
    """Below a billionth of the load, the certificate does not count a force as contact."""
    position = SimpleNamespace(
        certificate=SimpleNamespace(load=4e3), floats={"5": SimpleNamespace(reaction=(0.0, size))}
    )
    assert reaction_size(position, "5") == shown


def test_torques_of_drivers_of_two_sizes_are_not_called_k_gamma():
    """The forces are in the ratio 2 : 1 where the torques are equal."""
    gears = {
        "a": {"base_radius": "30 mm", "centre": ["120 mm", "0 mm"]},
        "b": {"base_radius": "60 mm", "centre": ["0 mm", "150 mm"]},
        "o": {"base_radius": "80 mm", "centre": ["0 mm", "0 mm"]},
    }
    case = ls.Case(
        {
            "operating": {
                "input": "a",
                "output": "o",
                "torque": "100 N*m",
                "external": {"b": "100 N*m"},
            },
            "gears": gears,
            "meshes": {name: {"stiffness": "1e6 N*m/rad"} for name in ("a-o", "b-o")},
            "stages": {"I": {"meshes": ["a-o", "b-o"]}},
        }
    )
    result = ls.solve(case)
    assert measure_of(result) == "Ω"
    assert sharing(result).columns[-1].title == "Ω"
    here = result.positions[0]
    assert here.share["a-o"] == pytest.approx(1.0)
    factors = load_factors(here.train, here.torque, here.train.stages[0])
    assert factors == pytest.approx({"a-o": 4.0 / 3.0, "b-o": 2.0 / 3.0})


def test_a_load_is_that_of_its_position(all_elements):
    found = {p.position: p.loads for p in all_elements.positions}
    rows = list(records.loads(all_elements))
    for row in rows:
        kind, name = row["part"].text.split(" ", 1)
        of = {at: (x.gears if kind == "gear" else x.shafts)[name] for at, x in found.items()}
        if row["torque at"].value is not None:
            assert row["torque"].value == of[row["torque at"].value]
            assert abs(row["torque"].value) == pytest.approx(max(map(abs, of.values())), rel=1e-9)
            alike = np.allclose([*of.values()], row["torque"].value, rtol=1e-9, atol=0.0)
            assert (row["torque at"].text == "all") is alike
        if row["bearing at"].value is not None:
            forces = {at: math.hypot(*x.bearings[name]) for at, x in found.items()}
            assert row["bearing"].value == forces[row["bearing at"].value]
            assert row["bearing"].value == pytest.approx(max(forces.values()), rel=1e-9)
    assert {row["torque at"].text for row in rows} | {row["bearing at"].text for row in rows} > {
        "–"
    }


@pytest.mark.parametrize(("force", "told"), [(1e-5, False), (1.0, True)])
def test_a_reaction_that_is_as_good_as_none_is_not_told_beside_a_margin(force, told):
    """The margin of a float that is inside at another position is no bound of its reaction."""
    ways = [("inside", 2e-6, 0.0), ("on boundary", 0.0, force)]
    rests = [
        FloatState(
            gear="4",
            state=state,
            boundary=None,
            margin=margin,
            normal=None,
            reaction=(push, 0.0),
            boundaries=(Touch("ring 4: upper stop", margin, push, (1.0, 0.0), margin == 0.0),),
            spline=None,
            spline_force=0.0,
            friction=None,
        )
        for state, margin, push in ways
    ]
    lines = rest_lines(rests, [1, 2], least=1e-3)
    assert any(line.startswith("least margin inside 2 µm") for line in lines)
    assert any(line.startswith("reaction up to") for line in lines) is told
