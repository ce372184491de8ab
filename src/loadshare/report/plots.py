"""The pictures of a result: `Result.plot`."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.report.figure import Figure
from loadshare.report.figures import branches
from loadshare.report.figures import floats as rests
from loadshare.report.figures import law as laws
from loadshare.report.figures import train as trains
from loadshare.results import Result
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
        """Draw the torque on every mesh's driver over the positions, one panel for each stage."""
        return branches.torque(self.result)

    def share(self, over: branches.Mean = "stage") -> Figure:
        """Draw the load-sharing coefficient of every branch over the positions.

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
        """Draw each float's centre in its region, enlarged and true to shape.

        Raises
        ------
        LoadshareError
            If no gear floats.
        """
        return rests.floats(self.result, build_train(self.result.solved))

    def law(self) -> Figure:
        """Draw the deformation of the meshes over torque, with their operating points."""
        return laws.law(self.result, build_train(self.result.solved))

    def train(self) -> Figure:
        """Draw the train, with the forces of the loaded flanks at the first position."""
        return trains.train(self.result.case, self.result)
