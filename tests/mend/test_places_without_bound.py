"""A result in which some displacements have no bound is written like any other."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import loadshare as ls

CASE = Path(__file__).with_name("places_without_bound.toml")
SAME = ["8e7 N/m", "8e7 N/m"]
"""The support of the ring as two stiffnesses instead of a matrix."""


@pytest.mark.parametrize("changes", [{}, {"gears.ring.support": SAME}], ids=["matrix", "two"])
@pytest.mark.quick(1)
def test_places_without_a_bound_are_written_and_read(tmp_path, changes):
    result = ls.march(ls.load_case(CASE).replace(changes)).result
    place = result.positions[1].certificate.bound.place
    assert math.isinf(place["ring x"])
    assert math.isinf(place["ring y"])
    for name in ("result.json", "result.nc"):
        file = tmp_path / name
        result.to_json(file) if file.suffix == ".json" else result.to_netcdf(file)
        assert ls.load_result(file) == result
