"""Elastic solid of hexahedra with scikit-fem, clamped where the teeth are cut from their gear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from loadshare.tooth.compliance.block import BlockMesh
from loadshare.tooth.compliance.layered import LayeredFactor
from loadshare.tooth.geometry.body import Array

Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Solid:
    """A clamped solid, factorised.

    Attributes
    ----------
    factor : LayeredFactor
        Of the free degrees of freedom.
    free : array (m·layers, 3) of int
        Place of each node's displacements among the free ones; −1 where it is clamped or where
        the element has no node.
    layers : int
        Node layers over the width.
    """

    factor: LayeredFactor
    free: Index
    layers: int

    @property
    def size(self) -> int:
        """Number of free degrees of freedom."""
        return int((self.free >= 0).sum())

    def displacements(self, forces: Array, nodes: Index) -> Array:
        """Displacements (len(nodes), 3, k) [m] under forces (m·layers, 3, k) [N], given sparsely.

        Parameters
        ----------
        forces : array (size, k)
            Right-hand sides over the free degrees of freedom.
        nodes : array (...) of int
            Nodes to read.
        """
        found = self.factor.solve(forces)
        places = self.free[nodes]
        return np.where((places >= 0)[..., None], found[np.maximum(places, 0)], 0.0)


def build_solid(mesh: BlockMesh, modulus: float, poisson: float) -> Solid:
    """Assemble and factorise quadratic serendipity hexahedra (20 nodes, 27 Gauss points).

    Parameters
    ----------
    mesh : BlockMesh
    modulus, poisson : float
        E [Pa] and ν.
    """
    import skfem
    from scipy.sparse import coo_matrix

    cells = mesh.hexahedra()
    coordinates = mesh.points.reshape(-1, 3)
    curved, straight = skfem.ElementHex2(), skfem.ElementHexS2()
    corners = _lexicographic(cells, curved.doflocs[:8])
    used, local = np.unique(corners, return_inverse=True)
    vertices = skfem.MeshHex(
        np.ascontiguousarray(coordinates[used].T),
        np.ascontiguousarray(local.reshape(corners.shape)),
    )
    hexes = skfem.MeshHex2.from_mesh(vertices)
    hexes.doflocs[:, hexes.dofs.element_dofs] = coordinates[
        _lexicographic(cells, curved.doflocs)
    ].transpose(2, 0, 1)

    basis = skfem.CellBasis(hexes, straight, intorder=4)
    gradients = np.stack([np.asarray(b[0].grad) for b in basis.basis])  # (20, 3, cells, points)
    stiffness = _stiffness(gradients, np.asarray(basis.dx), modulus, poisson)

    nodes = _lexicographic(cells, straight.doflocs)
    present = np.zeros(len(coordinates), dtype=bool)
    present[nodes] = True
    held = np.repeat(mesh.clamped, mesh.layers) | ~present
    # Node by node along a layer, layer by layer: the order of the factorisation.
    number = np.full((len(coordinates), 3), -1, dtype=np.int64)
    layer = np.tile(np.arange(mesh.layers), len(mesh.points))
    order = np.argsort(layer, kind="stable")
    kept = order[~held[order]]
    number[kept] = np.arange(3 * len(kept)).reshape(-1, 3)
    places = number[nodes].transpose(1, 0, 2).reshape(len(cells), -1)  # (cells, 60)
    rows = np.repeat(places, places.shape[1], axis=1).ravel()
    columns = np.tile(places, (1, places.shape[1])).ravel()
    inside = (rows >= 0) & (columns >= 0)
    size = 3 * len(kept)
    matrix = coo_matrix(
        (stiffness.ravel()[inside], (rows[inside], columns[inside])), shape=(size, size)
    ).tocsr()
    group = np.repeat(layer[kept] // 2, 3)
    return Solid(LayeredFactor(matrix, group), number, mesh.layers)


def _lexicographic(cells: Index, places: Array) -> Index:
    """Nodes (p, cells) of grid cells (cells, 3, 3, 3) at reference places (p, 3)."""
    i, j, k = np.rint(2.0 * np.asarray(places)).astype(int).T
    return cells[:, i, j, k].T


def _stiffness(gradients: Array, weights: Array, modulus: float, poisson: float) -> Array:
    """Element matrices (cells, 60, 60) of isotropic elasticity, nodes outermost."""
    nodes, _, cells, points = gradients.shape
    lame = modulus * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = 0.5 * modulus / (1.0 + poisson)
    flat = gradients.transpose(2, 0, 1, 3).reshape(cells, 3 * nodes, points)
    pairs = (flat * weights[:, None, :]) @ flat.transpose(0, 2, 1)
    pairs = pairs.reshape(cells, nodes, 3, nodes, 3)  # ∫ ∂ᵢN_a ∂ⱼN_b
    total = lame * pairs + shear * pairs.transpose(0, 1, 4, 3, 2)
    trace = shear * np.trace(pairs, axis1=2, axis2=4)
    for i in range(3):
        total[:, :, i, :, i] += trace
    return total.reshape(cells, 3 * nodes, 3 * nodes)
