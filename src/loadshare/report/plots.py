"""The pictures of what was found: `loadshare.plot`, and `plot` of results and studies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Any

from loadshare.arguments import one_of
from loadshare.report.figure import Figure
from loadshare.report.figures import branches, comparison, critical, sensitivity, sweep, tolerance
from loadshare.report.figures import floats as rests
from loadshare.report.figures import law as laws
from loadshare.report.figures import train as trains
from loadshare.results import Result
from loadshare.study.compare import Comparison
from loadshare.study.critical import Critical
from loadshare.study.fit import Fit
from loadshare.study.march import March
from loadshare.study.sensitivity import Sensitivity
from loadshare.study.sweep import Sweep
from loadshare.study.tolerance.result import OVERS, Over, Tolerance
from loadshare.train import build_train


@dataclass(frozen=True)
class Plots:
    """Pictures of a result; each method returns a `Figure` with ``save``.

    Examples
    --------
    >>> import loadshare as ls
    >>> result = ls.solve("cases/fgfbstts/limit_ring.toml")
    >>> result.plot.floats().save("floats.svg")
    PosixPath('floats.svg')
    """

    result: Result

    def torque(self) -> Figure:
        """Torque on the driver of every mesh over the positions, one panel for each stage."""
        return branches.torque(self.result)

    def share(self, over: branches.Mean = "stage") -> Figure:
        """Load-sharing coefficient of every branch over the positions.

        Parameters
        ----------
        over : {"stage", "group"}
            Mean to which the torque of a branch is compared.

        Raises
        ------
        LoadshareError
            If no loaded mesh is in a stage.
        """
        return branches.share(self.result, over)

    def floats(self) -> Figure:
        """Each float's centre in its region, enlarged and true to shape.

        Raises
        ------
        LoadshareError
            If no gear floats.
        """
        return rests.floats(self.result, build_train(self.result.solved))

    def law(self) -> Figure:
        """Deformation of the meshes over torque, with the points at which they work."""
        return laws.law(self.result, build_train(self.result.solved))

    def train(self) -> Figure:
        """Drawing of the train, with the push of the flanks that carry at the first position."""
        return trains.train(self.result.case, self.result)


@singledispatch
def plot(found: object, *settings: Any, **named: Any) -> Any:
    """Draw what was found.

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
        If there are no pictures of such a thing.
    """
    raise TypeError(f"there are no pictures of {type(found).__name__}, only of results and studies")


@plot.register
def _(found: Result) -> Plots:
    return Plots(found)


@plot.register
def _(found: Sweep, *settings: Any, **named: Any) -> Figure:
    return sweep.sweep(found.dataset, *settings, **named)


@plot.register
def _(found: Critical) -> Figure:
    return critical.critical(found)


@plot.register
def _(found: Sensitivity, stage: str = "system", over: Over = "stage") -> Figure:
    return sensitivity.sensitivity(found, stage, over)


@plot.register
def _(found: March, over: branches.Mean = "stage") -> Figure:
    return branches.share(found.result, over)


@plot.register(Comparison)
@plot.register(Fit)
def _(found: Comparison | Fit) -> Figure:
    return comparison.comparison(found.comparison if isinstance(found, Fit) else found)


@plot.register
def _(found: Tolerance, stage: str = "system", over: Over = "stage") -> Figure:
    one_of("over", over, OVERS)
    return tolerance.tolerance(found.dataset.sel(over=over), stage)
