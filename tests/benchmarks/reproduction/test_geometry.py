"""The family of geometries behind Figs. 13 and 14."""

from __future__ import annotations

import pytest

from benchmarks.reproduction.geometry import START, figures, layout
from benchmarks.reproduction.rings import fig13_entries
from loadshare.train import build_train


def test_the_layout_is_that_of_the_case_files(seed):
    """Centres and radii agree within the rounding of the case files, 0.1 µm to 0.1 mm."""
    own = build_train(seed.case("limit_ring"))
    made = build_train(seed.case("limit_ring").replace(layout(*START)))
    for gear, there in own.gears.items():
        here = made.gears[gear]
        assert here.centre == pytest.approx(there.centre, abs=1e-4)
        assert here.base_radius == pytest.approx(there.base_radius, abs=1e-4)


@pytest.mark.slow
def test_the_layout_gives_the_figures_of_the_case_files(seed, limited):
    """The case files round lengths to 0.1 µm, and to 0.1 mm of half a metre: 1e-3 relative."""
    found = figures(seed.case("limit_ring"), START)
    own = {e.quantity: e.computed for e in fig13_entries(limited)}
    expected = [
        *(own[f"Ω of pinion {p}'s pair, clearance 0"] for p in "45"),
        *(own[f"clearance that frees pinion {p} [µm]"] for p in "45"),
    ]
    assert found == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
def test_other_weights_find_other_radii_and_the_same_angle(limited):
    """The idler angle is well determined, radius and pressure angle are not."""
    radii, idlers, _ = zip(*(g.values for g in limited.geometries), strict=True)
    assert max(idlers) - min(idlers) < 0.5
    assert max(radii) - min(radii) > 1.0
