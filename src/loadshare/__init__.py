"""loadshare: certified load sharing in multi-branch gear transmissions.

>>> import loadshare as ls
>>> case = ls.load_case("cases/fgfbstts/limit_ring.toml")
>>> result = ls.solve(case)
>>> result.floats[0]["4"].state
'on boundary'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from loadshare._version import __version__
from loadshare.errors import CaseError, LoadshareError, Problem, Refused

if TYPE_CHECKING:
    from loadshare.case import Case, load_case
    from loadshare.case.schema import case_schema
    from loadshare.job import explain, solve
    from loadshare.results import Result, load_result

_LAZY = {
    "Case": "loadshare.case",
    "Result": "loadshare.results",
    "case_schema": "loadshare.case.schema",
    "explain": "loadshare.job",
    "load_case": "loadshare.case",
    "load_result": "loadshare.results",
    "solve": "loadshare.job",
}

__all__ = [
    "Case",
    "CaseError",
    "LoadshareError",
    "Problem",
    "Refused",
    "Result",
    "__version__",
    "case_schema",
    "explain",
    "load_case",
    "load_result",
    "solve",
]


def __getattr__(name: str) -> Any:
    """Import what is asked for only when it is asked for, so that the command starts quickly."""
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module 'loadshare' has no attribute {name!r}")
