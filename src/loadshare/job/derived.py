"""Load-sharing coefficients of many answers, computed from their torques when they are read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from xarray.backends import BackendArray
from xarray.core import indexing

from loadshare.array_types import Array
from loadshare.results.share import MeshTorques, shares
from loadshare.train.elements import Stage


class _Shares(BackendArray):
    """Coefficients over (sample, position, mesh), as xarray reads an array that is on disk.

    Parameters
    ----------
    meshes : tuple of str
    torque : ndarray, shape (samples, positions, meshes)
        Net torque of each [N·m].
    largest : ndarray, shape (samples, positions)
        Largest torque on any flank [N·m].
    stages : sequence of Stage
    pairs : bool
        Whether coefficients are relative to the mean of the branch's group.
    """

    def __init__(
        self,
        meshes: tuple[str, ...],
        torque: Array,
        largest: Array,
        stages: Sequence[Stage],
        pairs: bool,
    ) -> None:
        self.meshes, self.torque, self.largest = meshes, torque, largest
        self.stages, self.pairs = stages, pairs
        self.shape, self.dtype = torque.shape, torque.dtype

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        """Return coefficients of some answers."""
        how = indexing.IndexingSupport.BASIC
        return indexing.explicit_indexing_adapter(key, self.shape, how, self._read)

    def _read(self, key: tuple[Any, ...]) -> Array:
        *answers, mesh = key
        net, largest = self.torque[tuple(answers)], self.largest[tuple(answers)]
        flat = MeshTorques(self.meshes, net.reshape(-1, net.shape[-1]), np.ravel(largest))
        found = shares(flat, self.stages, self.pairs).reshape(net.shape)
        return np.asarray(found[..., mesh])


def shares_when_read(
    meshes: Sequence[str], torque: Array, largest: Array, stages: Sequence[Stage], pairs: bool
) -> Any:
    """Return coefficients that are computed when first read, and then kept; see `_Shares`."""
    found = _Shares(tuple(meshes), torque, largest, stages, pairs)
    return indexing.MemoryCachedArray(  # type: ignore[no-untyped-call]
        indexing.LazilyIndexedArray(found)
    )
