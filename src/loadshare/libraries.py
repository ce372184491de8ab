"""Libraries that are slow to load and that few calls need: each is loaded when it is first used.

Modules import these names from here as they would import the libraries themselves.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__all__ = ["optimize", "pa", "parquet", "pd", "qmc", "special", "stats", "xr"]

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    import xarray as xr
    from pyarrow import parquet
    from scipy import optimize, special, stats
    from scipy.stats import qmc
else:

    class _Library:
        """A module that is imported when one of its names is first used."""

        def __init__(self, name: str) -> None:
            self._name = name

        def __getattr__(self, name: str) -> Any:
            return getattr(import_module(self._name), name)

    pd, pa, xr, parquet = map(_Library, ("pandas", "pyarrow", "xarray", "pyarrow.parquet"))
    optimize, special, stats = map(_Library, ("scipy.optimize", "scipy.special", "scipy.stats"))
    qmc = _Library("scipy.stats.qmc")
