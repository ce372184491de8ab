"""Condense coordinates that only springs touch, once per problem (formulation, section 11).

A coordinate in no contact row and no radial element, such as a flange between two torsion shafts,
follows linearly from the others. It need not be in any programme.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.settings import CONTACT


@dataclass(frozen=True, slots=True, eq=False)
class Condensation:
    """x = expansion · q + constant.

    Attributes
    ----------
    kept : ndarray of int, shape (k,)
        Coordinates that stay; q are their values.
    expansion : ndarray, shape (n, k)
    constant : ndarray, shape (n,)
        [m].
    """

    kept: Numbers
    expansion: Array
    constant: Array

    def expand(self, q: Array) -> Array:
        """Return all coordinates from those that stay."""
        return np.asarray(self.expansion @ q + self.constant)


def nothing_condensed(size: int) -> Condensation:
    """Return the condensation that keeps every coordinate."""
    return Condensation(np.arange(size), np.eye(size), np.zeros(size))


def condense(stiffness: Array, load: Array, touched: Flags) -> Condensation:
    """Condense the coordinates that no contact touches.

    Parameters
    ----------
    stiffness : ndarray, shape (n, n)
        H [N/m].
    load : ndarray, shape (n,)
        f [N].
    touched : ndarray of bool, shape (n,)
        Coordinates that appear in a row or a radial element.

    Returns
    -------
    Condensation
        Minimises ½xᵀHx − fᵀx over the coordinates that no contact touches, for any values of the
        others. Keeps every coordinate if those to be condensed are not held by springs.
    """
    loose = np.flatnonzero(~touched)
    if not len(loose):
        return nothing_condensed(len(load))
    block = stiffness[np.ix_(loose, loose)]
    scale = np.sqrt(np.diag(block))
    if not scale.all() or np.linalg.eigvalsh(block / np.outer(scale, scale))[0] < CONTACT.condensed:
        return nothing_condensed(len(load))
    kept = np.flatnonzero(touched)
    expansion = np.zeros((len(load), len(kept)))
    expansion[kept, np.arange(len(kept))] = 1.0
    expansion[loose] = -np.linalg.solve(block, stiffness[np.ix_(loose, kept)])
    constant = np.zeros(len(load))
    constant[loose] = np.linalg.solve(block, load[loose])
    return Condensation(kept, expansion, constant)
