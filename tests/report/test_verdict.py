"""The first screen: the largest forces are those of flanks, and K_γ is of all positions."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from tests.support import shipped

import loadshare as ls
from loadshare.report.flanks import carrying, reaction_size
from loadshare.report.page.verdict import largest_forces, measure_of, sharing


@pytest.mark.parametrize("power", ["20 kW", "0 kW", "-2000 kW"])
def test_the_largest_force_of_a_flank_is_no_difference_of_flanks(power):
    """Where a mesh is jammed, each flank carries more than the mesh transmits."""
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
    """A billionth of the load is what the certificate calls contact."""
    position = SimpleNamespace(
        certificate=SimpleNamespace(load=4e3), floats={"5": SimpleNamespace(reaction=(0.0, size))}
    )
    assert reaction_size(position, "5") == shown
