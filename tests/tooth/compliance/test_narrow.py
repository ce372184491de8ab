"""Faces from far wider to far narrower than the tooth thickness: plane strain and plane stress."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from tests.support import mostly_slow
from tests.tooth.bodies import SpurTooth
from tests.tooth.compliance.plane import solve_plane

from loadshare.tooth.analysis.ltca import ltca
from loadshare.tooth.compliance.interface import Flank
from loadshare.tooth.compliance.slices import Slices
from loadshare.tooth.contact.problem import ToothContact
from loadshare.tooth.contact.strips import StripLine, contact_modulus, half_width
from loadshare.tooth.cylindrical.build import helicoid_pair
from loadshare.tooth.cylindrical.gear import HelicoidGear

E, NU = 206e9, 0.3
LOAD, CURVATURE = 5e5, 100.0
BODY = SpurTooth(teeth=25, module=5e-3, face_width=50e-3, rim=0.035)
STRESS = replace(BODY, youngs_modulus=E * (1 + 2 * NU) / (1 + NU) ** 2, poisson=NU / (1 + NU))
"""The material with which plane strain equals the plane stress of BODY."""
RIGID = 1e30


def line(width, depth, count=32):
    """Return an evenly divided line over a face, on a compliant body and an almost rigid one."""
    n = np.ones(count)
    depths = depth * n, depth * n
    return StripLine(
        width / count * n, CURVATURE * n, 0.0 * n, (E, RIGID), (NU, NU), depths, face_width=width
    )


def local(width, depth):
    """Return the mean compression between flank and middle surface under an even load [m]."""
    strips = line(width, depth)
    zero = np.zeros((len(strips.length),) * 2)
    problem = ToothContact(zero, zero[0], (strips,))
    return float((problem.alone.yielded(LOAD * strips.length[None])[0]).mean())


def test_the_limit_of_no_width_is_a_slice_in_plane_stress():
    """Weber and Banaschek's compression with E' = E and ν' = ν/(1 + ν); the half-space's part is
    the ratio of width to thickness.
    """
    depth = 3e-3
    width = half_width(LOAD, CURVATURE, E)
    wanted = 2.0 * LOAD / (np.pi * E) * (np.log(2.0 * depth / width) - 0.5 * NU)
    for face in (6e-6, 6e-8):
        assert local(face, depth) == pytest.approx(wanted, rel=1.1 * face / (2.0 * depth))


def test_a_face_as_wide_as_the_tooth_is_thick_is_left_alone():
    """From there on the half-space has the whole part, bit for bit; the limit is plane strain."""
    depth = 3e-3
    for face in (6e-3, 60e-3):
        assert line(face, depth).narrow == 0.0
        assert not line(face, depth).slices[0].any()
        plain = replace(line(face, depth), face_width=np.inf)
        np.testing.assert_array_equal(plain.removed, line(face, depth).removed)
    width = half_width(LOAD, CURVATURE, contact_modulus((E, RIGID), (NU, NU)))
    wanted = np.log(2.0 * depth / width) - 0.5 * NU / (1.0 - NU)
    wanted *= 2.0 * LOAD * (1.0 - NU**2) / (np.pi * E)
    assert local(60.0, depth) == pytest.approx(wanted, rel=1e-3)


def test_the_tangent_is_the_slope():
    strips = line(2e-3, 3e-3, 6)
    zero = np.zeros((6, 6))
    problem = ToothContact(zero, zero[0], (strips,))
    force = LOAD * strips.length * np.linspace(0.5, 1.5, 6)
    tangent = problem.compliance(force)[1]
    for k in range(6):
        step = np.zeros(6)
        step[k] = 1e-4 * force[k]
        moved = problem.alone.yielded(np.stack([force + step, force - step]).reshape(2, 6)[:1])
        back = problem.alone.yielded((force - step)[None])
        np.testing.assert_allclose((moved - back)[0] / (2 * step[k]), tangent[:, k], rtol=1e-6)


@pytest.mark.parametrize("u", mostly_slow((0.55, 0.75, 0.95), (0.75,)))
def test_a_whole_tooth_softens_as_two_plane_models_say(u):
    """Narrow over wide, against plane stress over plane strain, both resolved: measured +0.2, −0.2
    and −0.7 %. With the half-space alone, the narrow face yielded 17 to 38 % less than plane
    stress.
    """
    strain = solve_plane(BODY, u, 1.0, half_width(LOAD, CURVATURE, E / (1 - NU**2)))
    stress = solve_plane(STRESS, u, 1.0, half_width(LOAD, CURVATURE, E))
    found = {}
    for width in (200e-3, 0.05e-3):
        model = Slices(replace(BODY, face_width=width), 1)
        w = (np.arange(32) + 0.5) / 32
        bulk = model.bulk((Flank(0, np.column_stack([np.full(32, u), w])),)).mean() * width
        found[width] = bulk + local(width, strain.depth) / LOAD
    ratio = found[0.05e-3] / found[200e-3]
    assert ratio == pytest.approx(stress.surface / strain.surface, rel=0.01)


def test_ever_narrower_faces_are_ever_softer():
    """A pair under the same load per width; at 0.1 mm it used to be stiffer by a quarter."""
    found = []
    for width in (6e-3, 3e-3, 1.5e-3, 0.3e-3, 0.1e-3):
        common = {"module": 3e-3, "face_width": width}
        pair = helicoid_pair(HelicoidGear(teeth=25, **common), HelicoidGear(teeth=50, **common))
        analysed = ltca(pair, 150e3 * width * pair.arm, [0.0], (1.0,), "slices")
        found.append(float(analysed.approach[0, -1]))
    assert all(wide < narrow for wide, narrow in pairwise(found))
    assert found[-1] == pytest.approx(1.065 * found[0], rel=0.01)
