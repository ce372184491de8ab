"""Labels keep off each other and off what is drawn."""

from __future__ import annotations

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


@settings(deadline=None, max_examples=30)
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
