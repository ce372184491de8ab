"""Elastic solid of hexahedra with scikit-fem, clamped where the teeth are cut from their gear."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from loadshare.tooth.compliance.block import BlockMesh, Index
from loadshare.tooth.geometry.body import Array

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix


class LayeredFactor:
    """Cholesky factors of a symmetric positive definite, block tridiagonal matrix.

    A swept mesh couples only neighbouring layers; the blocks are sections, dense enough for LAPACK
    to be faster on them than a general sparse factorisation.

    Parameters
    ----------
    matrix : csr_matrix, shape (n, n)
    group : array (n,) of int
        Block of each row, rising from 0; rows couple only within a block and with its neighbours.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is not positive definite.
    """

    def __init__(self, matrix: csr_matrix, group: Index) -> None:
        from scipy.linalg import cholesky, solve_triangular
        from scipy.linalg.blas import dsyrk

        ends = np.searchsorted(group, np.arange(int(group[-1]) + 2))
        rows = [slice(a, b) for a, b in pairwise([*ends.tolist(), len(group)])]
        self._parts: list[tuple[slice, Array, Array]] = []
        diagonal = matrix[rows[0], rows[0]].toarray(order="F")
        for here, after in pairwise(rows):
            # Only the lower triangle is read from here on, and written below.
            factor = cholesky(diagonal, lower=True, overwrite_a=True, check_finite=False)
            coupling = matrix[here, after].tocsc()
            reach = int(np.flatnonzero(np.diff(coupling.indptr)).max(initial=-1)) + 1
            link = coupling[:, :reach].toarray(order="F")
            link = solve_triangular(factor, link, lower=True, overwrite_b=True, check_finite=False)
            self._parts.append((here, factor, link))
            diagonal = matrix[after, after].toarray(order="F")
            if reach:
                diagonal[:reach, :reach] -= dsyrk(1.0, link, trans=1, lower=1)

    def solve(self, right: Array) -> Array:
        """Solve for right-hand sides (n, k)."""
        from scipy.linalg import solve_triangular

        found = right.copy()
        for rows, factor, link in self._parts:
            found[rows] = solve_triangular(factor, found[rows], lower=True, check_finite=False)
            found[rows.stop : rows.stop + link.shape[1]] -= link.T @ found[rows]
        for rows, factor, link in reversed(self._parts):
            found[rows] -= link @ found[rows.stop : rows.stop + link.shape[1]]
            found[rows] = solve_triangular(
                factor, found[rows], lower=True, trans=1, check_finite=False
            )
        return found


@dataclass(frozen=True, eq=False)
class Solid:
    """A clamped solid, factorised.

    Attributes
    ----------
    factor : LayeredFactor
        Factors of the stiffness matrix of the free degrees of freedom.
    free : array (m·layers, 3) of int
        Index of each node's displacements among the free ones; −1 where it is clamped or where
        the element has no node.
    """

    factor: LayeredFactor
    free: Index

    @property
    def size(self) -> int:
        """Number of free degrees of freedom."""
        return int((self.free >= 0).sum())

    def displacements(self, forces: Array, nodes: Index) -> Array:
        """Return the displacements (..., 3, k) [m] of nodes (...) under forces (size, k) [N].

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
    nodes = np.empty(basis.N, dtype=np.int64)
    nodes[basis.element_dofs] = _lexicographic(cells, straight.doflocs)

    # Node by node along a layer, layer by layer: the order of the factorisation.
    section, layer = np.divmod(nodes, mesh.layers)
    order = np.lexsort((nodes, layer))
    kept = order[~mesh.clamped[section[order]]]
    free = np.full((len(coordinates), 3), -1, dtype=np.int64)
    free[nodes[kept]] = np.arange(3 * len(kept)).reshape(-1, 3)
    places = (3 * kept[:, None] + np.arange(3)).ravel()
    matrix = _stiffness(basis, modulus, poisson)[places][:, places]
    return Solid(LayeredFactor(matrix, np.repeat(layer[kept] // 2, 3)), free)


def _lexicographic(cells: Index, places: Array) -> Index:
    """Return the nodes (p, cells) of grid cells (cells, 3, 3, 3) at reference places (p, 3)."""
    i, j, k = np.rint(2.0 * np.asarray(places)).astype(int).T
    return cells[:, i, j, k].T


def _stiffness(basis: Any, modulus: float, poisson: float) -> csr_matrix:
    """Return the sparse matrix of isotropic elasticity, the three directions of a node adjacent.

    This is much faster than a form over pairs of shape functions, as it multiplies all at once.
    """
    from scipy.sparse import coo_matrix

    lame = modulus * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = 0.5 * modulus / (1.0 + poisson)
    slopes = np.stack([np.asarray(b[0].grad) for b in basis.basis], axis=1)  # (3, 20, cells, …)
    nodes, cells = slopes.shape[1:3]
    flat = slopes.transpose(2, 1, 0, 3).reshape(cells, 3 * nodes, -1)
    pairs = (flat * np.asarray(basis.dx)[:, None]) @ flat.transpose(0, 2, 1)
    pairs = pairs.reshape(cells, nodes, 3, nodes, 3)  # ∫ ∂ᵢN_a ∂ⱼN_b
    total = lame * pairs + shear * pairs.transpose(0, 1, 4, 3, 2)
    trace = np.trace(pairs, axis1=2, axis2=4)
    total += shear * trace[:, :, None, :, None] * np.eye(3)[:, None, :]
    places = (3 * basis.element_dofs.T[..., None] + np.arange(3)).reshape(cells, -1)
    rows, columns = np.broadcast_arrays(places[:, :, None], places[:, None, :])
    return coo_matrix((total.ravel(), (rows.ravel(), columns.ravel()))).tocsr()
