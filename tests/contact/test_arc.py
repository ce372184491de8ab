"""The exclusion arc of a limit ring, on the side where the gear is mounted and beyond.

Source: formulation, section 6: the arc condition holds on the side of the pinion.
"""

import numpy as np
import pytest

from loadshare.contact.arc import Arc

ARC = Arc(np.array([0.16, 0.0, 0.0]), np.array([1e-5, 2e-5, 0.0]), 3e-6)


def test_on_its_own_side_it_is_the_distance_of_the_centres():
    for relative in ([0.0, 0.0, 0.0], [1e-5, -4e-4, 0.0], [-0.1, 0.05, 0.0]):
        d = ARC.start + relative
        assert ARC.margin(np.array(relative)) == pytest.approx(
            np.linalg.norm(d) - 0.16 + 3e-6, rel=1e-9
        )
        np.testing.assert_allclose(ARC.normal(np.array(relative)), d / np.linalg.norm(d))


def test_beyond_the_neighbour_it_is_violated_and_leads_back():
    """At the mirrored place the inequality |d| ≥ a − c holds, but the margin must be negative."""
    for way in ([-0.17, 0.0, 0.0], [-0.4, 0.1, 0.0], [-0.2, -3.0, 0.0]):
        relative = np.array(way)
        margin = ARC.margin(relative)
        assert margin < -0.16
        np.testing.assert_array_equal(ARC.normal(relative), [1.0, 0.0, 0.0])
        step = ARC.margin(relative + np.array([1e-3, 0.0, 0.0])) - margin
        assert step == pytest.approx(1e-3, rel=1e-9)
