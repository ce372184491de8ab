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
from loadshare.errors import CaseError, LoadshareError, Problem, Refused, ResultError
from loadshare.pictures import register_drawing

if TYPE_CHECKING:
    from loadshare.case import Case, load_case
    from loadshare.case.examples import examples
    from loadshare.case.schema import case_schema
    from loadshare.job import explain, solve
    from loadshare.job.formulation import formulate
    from loadshare.job.many import solve_many
    from loadshare.job.search import search
    from loadshare.report.figure import Figure
    from loadshare.report.plot import plot
    from loadshare.results import Result
    from loadshare.results.files import load_result
    from loadshare.study.compare import Comparison, compare
    from loadshare.study.critical import Critical, critical
    from loadshare.study.fit import Fit, fit
    from loadshare.study.march import March, march
    from loadshare.study.named import run_study
    from loadshare.study.sensitivity import Sensitivity, sensitivity
    from loadshare.study.sweep import Sweep, sweep
    from loadshare.study.tolerance.result import Tolerance
    from loadshare.study.tolerance.study import tolerance

_LAZY = {
    "Case": "loadshare.case",
    "Comparison": "loadshare.study.compare",
    "Critical": "loadshare.study.critical",
    "Figure": "loadshare.report.figure",
    "Fit": "loadshare.study.fit",
    "March": "loadshare.study.march",
    "Result": "loadshare.results",
    "Sensitivity": "loadshare.study.sensitivity",
    "Sweep": "loadshare.study.sweep",
    "Tolerance": "loadshare.study.tolerance.result",
    "case_schema": "loadshare.case.schema",
    "compare": "loadshare.study.compare",
    "critical": "loadshare.study.critical",
    "examples": "loadshare.case.examples",
    "explain": "loadshare.job",
    "fit": "loadshare.study.fit",
    "formulate": "loadshare.job.formulation",
    "load_case": "loadshare.case",
    "load_result": "loadshare.results.files",
    "march": "loadshare.study.march",
    "plot": "loadshare.report.plot",
    "run_study": "loadshare.study.named",
    "search": "loadshare.job.search",
    "sensitivity": "loadshare.study.sensitivity",
    "solve": "loadshare.job",
    "solve_many": "loadshare.job.many",
    "sweep": "loadshare.study.sweep",
    "tolerance": "loadshare.study.tolerance.study",
}

__all__ = [
    "Case",
    "CaseError",
    "Comparison",
    "Critical",
    "Figure",
    "Fit",
    "LoadshareError",
    "March",
    "Problem",
    "Refused",
    "Result",
    "ResultError",
    "Sensitivity",
    "Sweep",
    "Tolerance",
    "__version__",
    "case_schema",
    "compare",
    "critical",
    "examples",
    "explain",
    "fit",
    "formulate",
    "load_case",
    "load_result",
    "march",
    "plot",
    "run_study",
    "search",
    "sensitivity",
    "solve",
    "solve_many",
    "sweep",
    "tolerance",
]


if not TYPE_CHECKING:
    # With it, a type checker would accept any name as an attribute of the module.
    def __getattr__(name: str) -> Any:
        """Import a public name when it is first used, so that the command starts quickly."""
        if name in _LAZY:
            return getattr(import_module(_LAZY[name]), name)
        raise AttributeError(f"module 'loadshare' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List all public names, including those that are imported on first use."""
    return __all__


# Results and studies offer their pictures without importing the package that draws them.
register_drawing(lambda: import_module(_LAZY["plot"]).plot)
