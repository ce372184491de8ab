"""Means over parts of the mesh cycle: the law's mean does not depend on the number of positions."""

import math

import numpy as np
import pytest
from tests.support import mostly_slow

from loadshare.tooth.analysis.ltca import ltca
from loadshare.tooth.analysis.sampling import cells
from loadshare.tooth.cylindrical.build import helicoid_pair
from loadshare.tooth.cylindrical.gear import HelicoidGear, Modification

RELIEF = Modification(tip_relief=15e-6, tip_relief_length=2e-3)


def gear(teeth, **changes):
    return HelicoidGear(**{"module": 3e-3, "teeth": teeth, "face_width": 20e-3} | changes)


PAIRS = {
    "spur": helicoid_pair(gear(25), gear(50)),
    "relieved": helicoid_pair(gear(25, modification=RELIEF), gear(50, modification=RELIEF)),
    "helical": helicoid_pair(gear(25, helix_angle=0.2), gear(50, helix_angle=-0.2)),
    "internal": helicoid_pair(gear(24), gear(60, internal=True, addendum=0.8)),
}


@pytest.mark.parametrize("count", [1, 3, 5, 20])
@pytest.mark.parametrize("changes", [(), (0.123, 0.81), (0.0, 0.5)])
def test_jumping_cubics_are_integrated_exactly(count, changes):
    """Gauss's rule with two nodes on every interval between jumps: only round-off remains."""
    found = cells(count, changes)
    assert np.all((found.phase >= 0.0) & (found.phase < 1.0))
    assert found.weight.sum(axis=1) == pytest.approx(1.0, abs=1e-14)
    one = sum((found.phase > change).astype(float) for change in changes)
    jumps = sum(1.0 - change for change in changes)
    assert found.mean(one + np.zeros_like(found.phase)).mean() == pytest.approx(jumps, abs=1e-14)
    if count > 1:
        # Position 1 represents a part of the cycle that does not wrap around.
        low, high = 0.5 / count, 1.5 / count
        wanted = (high**4 - low**4) / 4.0 * count
        assert found.mean(found.phase**3)[1] == pytest.approx(wanted, rel=1e-13)


def test_contact_changes_where_pairs_come_and_go():
    """In a spur pair, two pairs of teeth are in contact between the changes for ε_α − 1 of the
    cycle, else one.
    """
    pair = PAIRS["spur"]
    first, last = pair.changes
    for low, high in ((first, last), (last, first + 1.0)):
        counts = {
            len(position.lines)
            for position in pair.positions(
                [(low + share * (high - low)) % 1.0 for share in (1e-6, 0.5, 1.0 - 1e-6)], 3
            )
        }
        share = high - low
        assert counts == ({2} if math.isclose(share, pair.contact_ratio - 1.0) else {1})


@pytest.mark.parametrize("name", mostly_slow(PAIRS, ("relieved", "internal")))
@pytest.mark.quick(1)
def test_the_mean_does_not_hang_on_the_positions(name):
    """Mean deflection under T against 401 positions, which are accurate to 4e-4 themselves.

    At 1, 2, 5 positions it is up to 32, 8, 5 % off for a spur pair; the means are 3.3e-4 off at
    most, including relieved tips.
    """
    wanted = ltca(PAIRS[name], 100.0, 401, (1.0,), "slices").angle[:, -1].mean()
    for count in (1, 2, 5, 10):
        found = ltca(PAIRS[name], 100.0, count, (1.0,), "slices", means=True)
        assert found.law_angle[:, -1].mean() == pytest.approx(wanted, rel=5e-4)
        # So is the mean of the law, at the loads of its fit.
        fit = found.law.angle(90.0).mean()
        assert fit == pytest.approx(
            found.law_angle[:, np.isclose(found.torque, 90.0)].mean(), rel=1e-9
        )


def test_five_points_alias_a_spur_pair():
    """The error that means avoid: −5.3 % of the mean deflection, +4.4 % of the mean stiffness."""
    found = ltca(PAIRS["spur"], 100.0, 5, (1.0,), "slices", means=True)
    assert found.approach[:, -1].mean() / found.elastic[:, -1].mean() == pytest.approx(
        0.947, abs=2e-3
    )


@pytest.mark.parametrize("name", mostly_slow(PAIRS, ("relieved", "internal")))
@pytest.mark.quick(1)
def test_the_shape_converges(name):
    """Order 1 or better on average over the cycle: only the part around a jump keeps its error."""
    course = {
        count: ltca(PAIRS[name], 100.0, count, (1.0,), "slices", means=True).law_angle[:, -1]
        for count in (5, 15, 45, 135)
    }
    finest = course.pop(135)
    errors = [np.abs(own - finest[:: 135 // n]).mean() for n, own in course.items()]
    assert errors[1] < errors[0] / 2.0
    assert errors[2] < errors[1] / 2.0


def test_tangent_and_increment_are_of_the_means():
    found = ltca(PAIRS["helical"], 100.0, 4, (0.999, 1.0, 1.001), "slices", means=True)
    np.testing.assert_allclose(found.tangent(1.0), found.increment(0.999, 1.001), rtol=1e-3)


def test_means_need_equal_parts():
    with pytest.raises(ValueError, match="number of positions"):
        ltca(PAIRS["spur"], 100.0, [0.0, 0.5], (1.0,), "slices", means=True)


@pytest.mark.parametrize("pitches", [1.0, 1.0 + 1e-7, 2.0])
def test_faces_of_whole_axial_pitches_have_means(pitches):
    """Pairs enter and leave at the same time, where almost nothing is left of their lines."""
    width = pitches * math.pi * 3e-3 / math.sin(math.radians(15.0))
    angle = math.radians(15.0)
    ends = (gear(z, face_width=width, helix_angle=way * angle) for z, way in ((25, 1), (50, -1)))
    mesh = helicoid_pair(*ends)
    found = ltca(mesh, 100.0, 2, (1.0,), "slices", points=8, means=True).elastic[:, -1]
    other = ltca(mesh, 100.0, 5, (1.0,), "slices", points=8, means=True).elastic[:, -1]
    assert found.mean() == pytest.approx(other.mean(), rel=5e-4)


@pytest.mark.parametrize("beside", [1e-15, 1e-13, 1e-9, 1e-7, 1e-6, 1e-5])
def test_a_line_of_which_nearly_nothing_is_left_carries_nothing(beside):
    """Otherwise its contact would be metres wide, or the iteration would not converge."""
    mesh = PAIRS["helical"]
    phases = [(change + way * beside) % 1.0 for change in mesh.changes for way in (-1, 1)]
    found = ltca(mesh, 100.0, phases, (0.1, 1.0), "slices", points=8)
    assert found.approach[::2] == pytest.approx(found.approach[1::2], rel=1e-3)
    widest = max(float(line.half_width.max()) for row in found.lines for line in row[-1])
    assert widest < 1e-3
