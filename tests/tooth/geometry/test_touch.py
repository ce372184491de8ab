"""First contact of a single pair of teeth, against searches that use no contact equations."""

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.tooth.geometry.samples import RELIEVED, face_pair, pair

from loadshare.tooth.cylindrical.gear import Modification
from loadshare.tooth.cylindrical.pair import Misalignment
from loadshare.tooth.face.pair import FaceMisalignment
from loadshare.tooth.geometry.gap import least_gap
from loadshare.tooth.unloaded.touch import contact_points

CYLINDRICAL = {
    "helical": pair(
        helix=0.15,
        modification=Modification(lead_crowning=20e-6, profile_crowning=20e-6),
        off=Misalignment(deviation=2e-4),
    ),
    "spur": pair(modification=RELIEVED, off=Misalignment(deviation=5e-4)),
}
FACE = face_pair(
    off=FaceMisalignment(shaft_angle=3e-4),
    modification=Modification(profile_crowning=60e-6, lead_crowning=10e-6),
)
PHASES = (0.05, 0.35, 0.75)


def least_turn(mesh, phase, found):
    """Return the least turn of the driver at which its flank meets the driven flank [rad].

    Points of the driver's flank are turned until they are on the other flank, and the one with the
    least turn is searched for over the whole flank: without normals and without a line of contact.
    """
    driver, driven = (rotation[:, None] for rotation in mesh.ideal(np.array([phase])))
    number = np.full((1, 1), float(found.pair))
    middle = float(mesh.roll(number, 0.0, driver + found.lead)[0, 0])

    def turn(at):
        a, b = np.full((1, 1), middle + 0.1 * at[0]), np.full((1, 1), 1e-2 * at[1])
        meeting = np.array([found.lead, float(mesh.partner_roll(a[0, 0])), b[0, 0]])
        for _ in range(8):
            t, c, d = (np.full((1, 1), x) for x in meeting)
            own = mesh.driver_patch(number, (a, b), driver + t)
            other = mesh.driven_patch(number, (c, d), driven)
            about = np.cross([0.0, 0.0, 1.0], own.point.ravel())
            matrix = np.column_stack([about, *(-ray.ravel() for ray in other.rays)])
            meeting = meeting - np.linalg.solve(matrix, (own.point - other.point).ravel())
        return 1e6 * meeting[0]

    options = {"xatol": 1e-6, "fatol": 1e-9, "maxiter": 2000}
    return 1e-6 * minimize(turn, (0.0, 0.0), method="Nelder-Mead", options=options).fun


@pytest.mark.parametrize("name", CYLINDRICAL)
@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.quick(2)
def test_a_pair_touches_where_a_search_over_its_flank_finds_it(name, phase):
    """Lines of contact alone are 1 to 137 µrad late here, most if a pair is far from contact."""
    mesh = CYLINDRICAL[name]
    inner = [point for point in contact_points(mesh, phase) if not point.edge]
    assert inner
    for point in inner:
        assert point.lead == pytest.approx(least_turn(mesh, phase, point), abs=1e-10)


@pytest.mark.parametrize("phase", PHASES)
def test_a_pair_far_from_contact_is_turned_until_it_touches(phase):
    """The gap over the arm is up to 9 µrad off while the teeth are far apart, at 310 µrad."""
    driver, driven = FACE.ideal(np.array([phase]))
    for point in contact_points(FACE, phase):
        lead, gap = 0.0, 1.0
        while abs(gap) > 1e-13:
            lines = FACE.extents(driver + lead, driven)
            (own,) = np.flatnonzero(lines.pairs == point.pair)
            gap = least_gap(lines, 101)[0][own]
            lead += gap / FACE.arm
        assert point.lead == pytest.approx(lead, abs=1e-10)
