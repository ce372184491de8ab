"""The pictures of results and studies: `loadshare.plot`, and `plot` of each."""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from loadshare.arguments import one_of
from loadshare.report.figure import Figure
from loadshare.report.figures import branches, comparison, critical, sensitivity, sweep, tolerance
from loadshare.report.plots import Plots
from loadshare.results import Result
from loadshare.study.compare import Comparison
from loadshare.study.critical import Critical
from loadshare.study.fit import Fit
from loadshare.study.march import March
from loadshare.study.sensitivity import Sensitivity
from loadshare.study.sweep import Sweep
from loadshare.study.tolerance.result import OVERS, Over, Tolerance


@singledispatch
def plot(found: object, *settings: Any, **named: Any) -> Any:
    """Draw a result or a study.

    Parameters
    ----------
    found : Result or study
        What `solve`, `sweep`, `critical`, `sensitivity`, `tolerance`, `march`, `compare` or `fit`
        returned.
    *settings, **named
        What to show: as for ``found.plot`` of the study.

    Returns
    -------
    Plots or Figure
        The pictures of a result, each a method; the one picture of a study.

    Raises
    ------
    TypeError
        If there are no pictures of objects of this type.
    """
    raise TypeError(f"there are no pictures of {type(found).__name__}, only of results and studies")


plot.register(Result, Plots)
plot.register(Critical, critical.critical)
plot.register(Sensitivity, sensitivity.sensitivity)
plot.register(Comparison, comparison.comparison)


@plot.register
def _(found: Sweep, *settings: Any, **named: Any) -> Figure:
    return sweep.sweep(found.dataset, *settings, **named)


@plot.register
def _(found: March, over: branches.Mean = "stage") -> Figure:
    return branches.share(found.result, over)


@plot.register
def _(found: Fit) -> Figure:
    return comparison.comparison(found.comparison)


@plot.register
def _(found: Tolerance, stage: str = "system", over: Over = "stage") -> Figure:
    one_of("over", over, OVERS)
    return tolerance.tolerance(found.dataset.sel(over=over), stage)
