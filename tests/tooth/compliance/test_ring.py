"""The body of a gear as a ring: limits, closed forms, published figures, plane finite elements."""

from dataclasses import replace

import numpy as np
import pytest
import skfem
from skfem.helpers import ddot, sym_grad, trace

from loadshare.tooth.compliance.ring import Ring

WIDE, NARROW = 1e3, 1e-6
"""Face widths [m] at which every harmonic is in plane strain, or in plane stress."""
EXTERNAL = Ring(0.06, 0.03, 0.013, WIDE, 24, 0.3)
INTERNAL = Ring(0.06, 0.09, 0.013, WIDE, 24, 0.3)


@pytest.mark.parametrize("ring", [EXTERNAL, INTERNAL])
def test_reciprocity_and_energy(ring):
    for k in (0, 1, 2, 5):
        np.testing.assert_allclose(ring.root(k), ring.root(-k).T, atol=1e-13)
    assert np.all(np.linalg.eigvalsh(ring.root(0)) > 0.0)


@pytest.mark.parametrize("ring", [EXTERNAL, INTERNAL])
def test_all_teeth_together_twist_the_ring_and_swell_it(ring):
    """Adjacent roots without spaces load the ring evenly, which leaves torsion, u_θ = τR (R² −
    h²)/(2G h²), and Lamé's ring in plane stress, u_r = A(r − h²/r). The substitute for the finest
    harmonics, of which there are none here, is 0.0011.
    """
    whole = replace(ring, thickness=2.0 * np.pi * ring.loaded / ring.teeth)
    total = sum(whole.root(k) for k in range(24))
    square, nu = (ring.held / ring.loaded) ** 2, ring.poisson
    per_root = ring.teeth / (2.0 * np.pi)
    twist = abs(1.0 - square) / square / (1.0 - nu)
    swell = abs(1.0 - square) / ((1.0 + square) + nu * (1.0 - square))
    assert total[0, 0] == pytest.approx(per_root * twist, abs=1.2e-3)
    assert total[2, 2] == pytest.approx(per_root * swell, abs=1.2e-3)


def test_a_small_root_stands_on_a_half_plane():
    """The lean is 18/π under a linear traction and (1 − 2ν)/(1 − ν) under shear; a root half as
    thick deflects by 2/π ln 2 more. The thickness is 1/500 of radius and depth; the omitted
    harmonics oscillate by 1 % of the smallest figure.
    """
    ring = Ring(1.0, 0.5, 2e-3, WIDE, 100, 0.3)
    root, half = ring.root(0), replace(ring, thickness=1e-3).root(0)
    assert root[1, 1] == pytest.approx(18.0 / np.pi, rel=2e-3)
    assert root[0, 1] == pytest.approx(0.4 / 0.7, rel=2e-2)
    assert half[0, 0] - root[0, 0] == pytest.approx(2.0 / np.pi * np.log(2.0), rel=1e-3)


@pytest.mark.parametrize("bore", [2.0, 3.0, 5.0, 7.0])
@pytest.mark.parametrize("half_angle", [0.03, 0.06, 0.1])
def test_deflection_by_shear_is_the_published_one(bore, half_angle):
    """P* of Sainsot, Velex and Duverger (2004), table 1, in units of 1/E: 3 %. Measured: 2.3 %. At
    the end of their range, a bore of 1/1.4, the polynomial differs from the series by 20 %.
    """
    h, t = bore, half_angle
    published = -50.952e-5 / t**2 + 185.5e-3 * h**2 + 0.0538e-4 * h / t
    published += 53.3e-3 / t + 0.2895 * h + 0.9236
    ring = Ring(1.0, 1.0 / h, 2.0 * t, NARROW, 30, 0.3)
    assert ring.root(0)[0, 0] * (1.0 - 0.3**2) == pytest.approx(published, rel=0.03)


def test_a_ring_of_forty_depths_is_flat():
    """For the body of a face gear, half the curvature changes less than 1 % of the deflection."""
    depth, thickness, pitch = 0.03, 0.0107, 0.0135
    roots = [
        Ring(n * depth, (n - 1.0) * depth, thickness, WIDE, 2.0 * np.pi * n * depth / pitch, 0.3)
        for n in (40.0, 80.0)
    ]
    for k in (0, 1, 2):
        one, two = (ring.root(k) for ring in roots)
        np.testing.assert_allclose(one, two, atol=0.01 * roots[0].root(0)[0, 0])


@pytest.mark.parametrize("ring", [EXTERNAL, INTERNAL])
@pytest.mark.quick(1)
def test_against_plane_finite_elements(ring):
    """The same tractions act on a meshed ring, at the root and the next tooth. Quadratic elements,
    eight over a root, miss 0.2 % of the lean, near the ends of the traction. The mesh swells in
    plane strain, `Ring` in plane stress.
    """
    cells, over_root, apart = 240, 8, 10  # around the ring, on a root, between two roots
    ring = replace(ring, thickness=2.0 * np.pi * ring.loaded * over_root / cells)
    meshed = _meshed(ring, cells, over_root, apart)
    nu = ring.poisson
    square = (ring.held / ring.loaded) ** 2
    stress = abs(1.0 - square) / ((1.0 + square) + nu * (1.0 - square))
    side = nu / (1.0 - nu)
    strain = (1.0 - side**2) * abs(1.0 - square) / ((1.0 + square) + side * (1.0 - square))
    for k, found in zip((0, 1), meshed, strict=True):
        wanted = ring.root(k)
        wanted[2, 2] += 0.5 / np.pi * (strain - stress)
        np.testing.assert_allclose(found, wanted, rtol=3e-3, atol=8e-3)


def _meshed(ring, cells, over_root, apart):
    """Return the compliances (3, 3) of a root and of the one `apart` cells further, in units of (1
    − ν²)/E.
    """
    around = 2.0 * np.pi * np.arange(cells) / cells
    radii = ring.held + (ring.loaded - ring.held) * (1.0 - (1.0 - np.linspace(0, 1, 13)) ** 2)
    points = radii[:, None] * np.exp(1j * around)
    here = np.arange(cells * 12).reshape(12, cells)
    right = np.roll(here, -1, axis=1)
    quads = np.stack([here, right, right + cells, here + cells], axis=-1).reshape(-1, 4)
    mesh = skfem.MeshQuad(np.stack([points.real.ravel(), points.imag.ravel()]), quads.T)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()))
    nu = ring.poisson

    @skfem.BilinearForm
    def energy(u, v, _):
        # In units of E/(1 − ν²), plane strain.
        strain = ddot(sym_grad(u), sym_grad(v)) + nu / (1.0 - 2.0 * nu) * trace(
            sym_grad(u)
        ) * trace(sym_grad(v))
        return (1.0 - nu) * strain

    middle = 0.5 * (np.abs(points[-1, 0]) + np.abs(points[-2, 0]))
    inwards = ring.held > ring.loaded

    def loads(first):
        start = (first - 0.01) * 2.0 * np.pi / cells
        end = start + (over_root + 0.02) * 2.0 * np.pi / cells

        def touched(x):
            angle = np.arctan2(x[1], x[0]) % (2.0 * np.pi)
            beyond = np.hypot(*x) < middle if inwards else np.hypot(*x) > middle
            return beyond & (angle > start) & (angle < end)

        facets = mesh.facets_satisfying(touched, boundaries_only=True)
        edge = skfem.FacetBasis(mesh, basis.elem, facets=facets, intorder=6)
        centre = 0.5 * (start + end)

        def form(pattern):
            @skfem.LinearForm
            def work(v, w):
                angle = np.arctan2(w.x[1], w.x[0]) % (2.0 * np.pi)
                out, along = pattern((angle - centre) * ring.loaded / ring.thickness)
                c, s = np.cos(angle), np.sin(angle)
                return (
                    out * (c * v[0] + s * v[1]) + along * (c * v[1] - s * v[0])
                ) / ring.thickness

            return work.assemble(edge)

        up = -1.0 if inwards else 1.0
        return np.column_stack(
            [
                form(lambda s: (0.0 * s, 1.0 + 0.0 * s)),
                form(lambda s: (-12.0 * up * s, 0.0 * s)),
                form(lambda s: (up + 0.0 * s, 0.0 * s)),
            ]
        )

    first, second = loads(20), loads(20 + apart)
    far = 0.9 * np.abs(points[0, 0]) + 0.1 * np.abs(points[1, 0])
    held = basis.get_dofs(lambda x: (np.hypot(*x) > far) == inwards)
    free = np.setdiff1d(np.arange(basis.N), held.all())
    stiffness = energy.assemble(basis)[free][:, free].tocsc()
    moved = np.column_stack([skfem.solve(stiffness, first[free, i]) for i in range(3)])
    return first[free].T @ moved, second[free].T @ moved
