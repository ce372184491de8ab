"""The page's pictures: the same figures give the same file, whatever the round-off."""

from __future__ import annotations

from benchmarks.reproduction.drawing import Panel, picture
from loadshare.report.palette import look


def drawn(curve: list[tuple[float, float]]) -> str:
    panel = Panel("", "x [µm]", "y [µm]", {"a": curve}, {"a": look(0)}, "path", true_to_shape=True)
    return picture("path", "A path", "", [panel]).to_svg()


def test_round_off_changes_no_picture():
    """A point that stays at the origin has round-off of the solver, far below seven digits."""
    exact = [(0.0, 0.0), (4.12, 7.136)]
    assert drawn([(-3e-17, 2e-17), (4.12 * (1 + 2e-16), 7.136)]) == drawn(exact)
    assert drawn([(0.0, 0.0), (4.12001, 7.136)]) != drawn(exact)
