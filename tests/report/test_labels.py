"""Labels do not overlap each other or the drawing."""

from __future__ import annotations

import math
from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st

from loadshare.report.figures.labels import BROAD, SIZE, Labels

LETTERS = st.text("abcdefgh 123", min_size=1, max_size=12)


def boxes(labels):
    found = []
    for row in labels.rows:
        half = BROAD * SIZE * len(row["text"]) / 2
        x, y = row["x"], row["y"]
        found.append((x - half, y - SIZE / 2, x + half, y + SIZE / 2))
    return found


def apart(one, other):
    return one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


@settings(max_examples=30)
@given(st.lists(st.tuples(LETTERS, st.floats(60, 240), st.floats(60, 240)), min_size=2, max_size=5))
def test_labels_do_not_overlap_and_stay_inside(wanted):
    labels = Labels((0.0, 0.0), (300.0, 300.0), 1.0)
    for text, x, y in wanted:
        labels.place(text, [(x, y)])
    placed = boxes(labels)
    assert len(placed) == len(wanted)
    assert all(apart(a, b) for a, b in combinations(placed, 2))
    assert all(b[0] >= 0 and b[1] >= 0 and b[2] <= 300 and b[3] <= 300 for b in placed)


def test_a_label_keeps_off_a_line():
    labels = Labels((0.0, 0.0), (300.0, 300.0), 1.0)
    labels.avoid([(100.0, 150.0), (300.0, 150.0)])
    labels.place("name", [(150.0, 150.0)], towards=(1.0, 0.0))
    ((_, low, _, high),) = boxes(labels)
    assert low > 150.0 or high < 150.0


def test_the_preferred_side_is_taken_when_it_is_free():
    for towards, k in (((1.0, 0.0), 0), ((0.0, 1.0), 1)):
        labels = Labels((0.0, 0.0), (300.0, 300.0), 1.0)
        labels.place("name", [(150.0, 150.0)], towards=towards)
        (box,) = boxes(labels)
        assert box[k] > 150.0


def leader(labels):
    """Return the ends of the leader of the one placed label; empty for a label beside its point."""
    for layer in labels.layers({}, {}):
        if layer["mark"]["type"] == "line":
            return [(row["x"], row["y"]) for row in layer["data"]["values"]]
    return []


def test_a_line_leads_to_what_stands_further_away():
    labels = Labels((0.0, 0.0), (300.0, 300.0), 1.0)
    labels.avoid([(130.0, 160.0), (170.0, 160.0), (170.0, 140.0), (130.0, 140.0), (130.0, 160.0)])
    labels.place("name", [(150.0, 150.0)])
    (box,) = boxes(labels)
    start, end = leader(labels)
    assert start == (150.0, 150.0)
    # It ends on the edge of the label; drawn coordinates have seven digits.
    assert box[0] - 1e-4 <= end[0] <= box[2] + 1e-4
    assert box[1] - 1e-4 <= end[1] <= box[3] + 1e-4
    beside = Labels((0.0, 0.0), (300.0, 300.0), 1.0)
    beside.place("name", [(150.0, 150.0)])
    assert leader(beside) == []


def test_a_label_does_not_seem_to_name_another_point():
    """Two points are 24 px apart vertically: without the other, the label would be above."""
    own, other = (150.0, 150.0), (150.0, 174.0)
    alone, beside = (Labels((0.0, 0.0), (300.0, 300.0), 1.0) for _ in range(2))
    alone.place("name", [own], towards=(0.0, 1.0), gap=7.0)
    beside.place("name", [own], towards=(0.0, 1.0), gap=7.0, others=[other])
    (met,), (kept,) = boxes(alone), boxes(beside)
    assert met[1] > own[1]

    def away(box, point):
        return math.hypot(
            max(box[0] - point[0], 0.0, point[0] - box[2]),
            max(box[1] - point[1], 0.0, point[1] - box[3]),
        )

    assert away(met, other) < 1.5 * away(met, own)
    assert leader(beside) or away(kept, other) >= 1.5 * away(kept, own)
