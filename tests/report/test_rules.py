"""Lines across a panel: their labels are on the side that has room, and never overlap."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.reproducible import examples

from loadshare.report.figures.marks import BREADTH, rules


def sides(places: list[float]) -> list[str]:
    """Return the side of the label of each line [px], "" for a line without a label."""
    named = [{"x": place, "text": f"{k}"} for k, place in enumerate(places)]
    found = dict.fromkeys(range(len(places)), "")
    for layer in rules(named, {}, 1.0):
        if layer["mark"]["type"] == "text":
            # It follows from the baseline: text below it is on the left of a line, as it is
            # rotated.
            side = {"bottom": "left", "top": "right"}[layer["mark"]["baseline"]]
            for row in layer["data"]["values"]:
                found[int(row["text"])] = side
    return list(found.values())


@pytest.mark.parametrize(
    ("places", "expected"),
    [
        ([], []),
        ([100.0], ["left"]),
        ([100.0, 107.0], ["left", "right"]),
        ([100.0, 107.0, 112.0], ["left", "", "right"]),
        ([100.0, 107.0, 130.0], ["left", "right", "right"]),
        ([100.0, 107.0, 140.0], ["left", "right", "left"]),
    ],
)
def test_words_take_the_side_that_has_room(places, expected):
    assert sides(places) == expected


@settings(max_examples=examples(15, 40))
@given(st.lists(st.floats(0.0, 400.0), min_size=1, max_size=8, unique=True).map(sorted))
def test_no_words_lie_on_others_or_on_a_rule(places):
    found = sides(places)
    spans = [
        (place - BREADTH, place) if side == "left" else (place, place + BREADTH)
        for place, side in zip(places, found, strict=True)
        if side
    ]
    # Round-off of a sum of figures up to 400.
    least = -1e-9
    assert all(after[0] - before[1] >= least for before, after in pairwise(spans))
    for low, high in spans:
        assert all(not low + 1e-9 < place < high - 1e-9 for place in places)
    assert found[0] == "left"
