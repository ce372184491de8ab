"""Iterates: coordinates and forces of a batch of samples, from set to set."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from loadshare.array_types import Array, Flags, Numbers
from loadshare.scene.loading import Loading
from loadshare.scene.structure import Structure
from loadshare.settings import HOT


@dataclass(slots=True, eq=False)
class Iterate:
    """Coordinates and forces of every sample, renewed in place.

    Attributes
    ----------
    x : ndarray, shape (S, n)
        Coordinates.
    force : ndarray, shape (S, m)
        Forces of all elements, 0 for those that do not act.
    root : ndarray, shape (S, m)
        Cube root of the force at which the next tangent of a nonlinear law is taken; 0 where there
        is no such law.
    floor : ndarray, shape (S,)
        Smallest root at which a tangent is taken.
    stays : ndarray of bool, shape (S,)
        Whether coordinates that nothing holds may stay where they are, if those of least norm would
        overlap.
    """

    x: Array
    force: Array
    root: Array
    floor: Array
    stays: Flags

    def take(self, rows: Numbers) -> Iterate:
        """Return some of the samples, as a copy."""
        return Iterate(*(getattr(self, field.name)[rows] for field in fields(self)))

    def put(self, rows: Numbers, other: Iterate) -> None:
        """Replace some samples by those of another iterate, in its order."""
        for field in fields(self):
            getattr(self, field.name)[rows] = getattr(other, field.name)

    def begin(
        self,
        samples: Numbers | slice,
        share: Array,
        loading: Loading,
        which: Numbers | None = None,
    ) -> None:
        """Set the forces, in shares of the load, at which some samples first take their tangents.

        Parameters
        ----------
        samples : ndarray of int, or slice
        share : ndarray, shape (m,), (S, m) or (k, m)
            For all samples, for each, or rows from which `which` selects one for each.
        loading : Loading
        which : ndarray of int, shape (S,), optional
        """
        roots = np.cbrt(np.maximum(share[..., loading.nonlinear], HOT.least_share))
        roots = roots if which is None else roots[which]
        of_load = loading.root[samples] if len(loading.root) > 1 else loading.root
        if isinstance(samples, slice):
            np.multiply(of_load[:, None], roots, out=self.root[samples, loading.nonlinear])
        else:
            self.root[samples, loading.nonlinear] = of_load[:, None] * roots


def at_rest(
    structure: Structure,
    loading: Loading,
    share: Array | None = None,
    which: Numbers | None = None,
) -> Iterate:
    """Return the iterate before anything has moved.

    Parameters
    ----------
    structure : Structure
    loading : Loading
    share, which : ndarray, optional
        As in `Iterate.begin`; by default the first tangents are taken at half the load.
    """
    count, width = loading.count, len(structure.kinds)
    found = Iterate(
        x=np.zeros((count, structure.size)),
        force=np.zeros((count, width)),
        root=np.zeros((count, width)),
        floor=np.array(np.broadcast_to(HOT.floor * loading.root, (count,))),
        stays=np.zeros(count, dtype=bool),
    )
    found.begin(slice(None), np.full(width, 0.5) if share is None else share, loading, which)
    return found


def pushes(loading: Loading) -> Array:
    """Return the largest load of every sample, shape (S,); 1 where there is none."""
    return np.broadcast_to(np.where(loading.push > 0.0, loading.push, 1.0), (loading.count,))
