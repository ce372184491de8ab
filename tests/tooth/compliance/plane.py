"""A tooth in plane strain, meshed so finely around its contact that the pressure is resolved: an
independent check of finite elements, middle surface and Hertz contact together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import skfem
from skfem.helpers import ddot, sym_grad, trace

from loadshare.tooth.compliance.block import Divisions, block_mesh
from loadshare.tooth.compliance.middle import MiddleSurface

DIVISIONS = Divisions(across=8, flank=12, fillet=3, root=4, rim=6, width=1)


@dataclass(frozen=True)
class PlaneTooth:
    """Displacements [m] along the inward normal under q [N/m] of half-width b [m]."""

    surface: float
    foot: float
    depth: float


def solve_plane(body, u, load, half_width, side=1, teeth=5, bare=(1, 1, 1, 1)):
    """Press a half-ellipse of pressure on the flank at `u`; the mesh around it is refined until its
    cells are an eighth of the half-width.
    """
    middle = MiddleSurface(body)
    section = block_mesh(middle, teeth, bare, DIVISIONS, Divisions(4, 4, 2, 2, 6, 1))
    mesh = _triangles(section)
    foot = middle.feet(np.array([[u, 0.5]]), side)
    contact = body.outline(u, 0.5, side)[:2]
    inward = foot.inward[0, :2]
    base = section.points[:, 0, :2]
    clamped = {tuple(np.round(p, 9)) for p in base[section.clamped]}

    while True:
        corners = mesh.p[:, mesh.t]
        away = np.hypot(*(corners.mean(axis=1) - contact[:, None]))
        (ax, ay), (bx, by) = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        size = np.sqrt(np.abs(ax * by - ay * bx))
        coarse = np.flatnonzero(size > np.maximum(half_width / 8.0, 0.25 * (away - half_width)))
        coarse = coarse[away[coarse] < 6.0 * body.module]
        if not len(coarse):
            break
        mesh = mesh.refined(coarse)

    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()), intorder=4)
    nu, shear = body.poisson, 0.5 * body.youngs_modulus / (1.0 + body.poisson)
    lame = 2.0 * shear * nu / (1.0 - 2.0 * nu)

    @skfem.BilinearForm
    def energy(v, w, _):
        return 2.0 * shear * ddot(sym_grad(v), sym_grad(w)) + lame * trace(sym_grad(v)) * trace(
            sym_grad(w)
        )

    def touched(x):
        return np.hypot(*(x - contact[:, None])) < 1.5 * half_width + 0.2 * body.module

    boundary = skfem.FacetBasis(
        mesh, basis.elem, facets=mesh.facets_satisfying(touched, boundaries_only=True), intorder=10
    )
    along = np.array([-inward[1], inward[0]])

    @skfem.LinearForm
    def pressure(v, w):
        s = np.einsum("i,i...->...", along, w.x - contact[:, None, None]) / half_width
        shape = np.sqrt(np.clip(1.0 - s**2, 0.0, None)) / half_width
        return shape * np.einsum("i,i...->...", inward, v)

    stiffness, force = energy.assemble(basis), pressure.assemble(boundary)
    # The discrete pressure on the facets is scaled so that its resultant is the load.
    resultant = np.hypot(
        *(force[basis.nodal_dofs[i]].sum() + force[basis.facet_dofs[i]].sum() for i in range(2))
    )
    held = [k for k, p in enumerate(mesh.p.T) if tuple(np.round(p, 9)) in clamped]
    ends = mesh.facets[:, mesh.boundary_facets()]
    both = mesh.boundary_facets()[np.isin(ends, held).all(axis=0)]
    fixed = basis.get_dofs(both).all()
    moved = skfem.solve(*skfem.condense(stiffness, force * load / resultant, D=fixed))

    def read(place):
        probe = basis.probes(place[:, None]) @ moved
        return float(probe.reshape(2, -1)[:, 0] @ inward)

    inside = contact + 1e-4 * body.module * inward  # within the polygon of the mesh
    return PlaneTooth(read(inside), read(middle.points(foot.zw)[0, :2]), float(foot.depth[0]))


def _triangles(section):
    """Return triangles on every node of the section's quadrilaterals."""
    points = section.points[:, 0, :2]
    found = []
    for quad in section.quads:
        for i in range(2):
            for j in range(2):
                a, b, c, d = quad[i, j], quad[i + 1, j], quad[i + 1, j + 1], quad[i, j + 1]
                found += [(a, b, c), (a, c, d)]
    used, local = np.unique(np.array(found), return_inverse=True)
    return skfem.MeshTri(
        np.ascontiguousarray(points[used].T), np.ascontiguousarray(local.reshape(-1, 3).T)
    )
