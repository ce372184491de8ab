"""The pictures of a result: `result.plot`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from loadshare.train import build_train

if TYPE_CHECKING:
    from loadshare.report.figure import Figure
    from loadshare.report.figures.share import Mean
    from loadshare.results import Result


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
        from loadshare.report.figures.torque import torque

        return torque(self.result)

    def share(self, over: Mean = "stage") -> Figure:
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
        from loadshare.report.figures.share import share

        return share(self.result, over)

    def floats(self) -> Figure:
        """Each float's centre in its region, enlarged and true to shape.

        Raises
        ------
        LoadshareError
            If no gear floats.
        """
        from loadshare.report.figures.floats import floats

        return floats(self.result, build_train(self.result.case))

    def law(self) -> Figure:
        """Deformation of the meshes over torque, with the points at which they work."""
        from loadshare.report.figures.law import law

        return law(self.result, build_train(self.result.case))

    def train(self) -> Figure:
        """Drawing of the train."""
        from loadshare.report.figures.train import train

        return train(self.result.case)
