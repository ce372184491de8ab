"""The pictures of a result: `result.plot`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from loadshare.errors import LoadshareError

if TYPE_CHECKING:
    from loadshare.case import Case
    from loadshare.report.figure import Figure
    from loadshare.report.figures.share import Mean
    from loadshare.results import Result
    from loadshare.train import Train


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

    def floats(self, case: Case | None = None) -> Figure:
        """Each float's centre in its region, enlarged and true to shape.

        Parameters
        ----------
        case : Case, optional
            What was solved; needed for a result that was loaded from a file.

        Raises
        ------
        LoadshareError
            If no gear floats, or the case is missing or another one.
        """
        from loadshare.report.figures.floats import floats

        return floats(self.result, self._train(case))

    def law(self, case: Case | None = None) -> Figure:
        """Deformation of the meshes over torque, with the points at which they work.

        Parameters
        ----------
        case : Case, optional
            As for `floats`.

        Raises
        ------
        LoadshareError
            If the case is missing or another one.
        """
        from loadshare.report.figures.law import law

        return law(self.result, self._train(case))

    def train(self, case: Case | None = None) -> Figure:
        """Drawing of the train.

        Parameters
        ----------
        case : Case, optional
            As for `floats`.

        Raises
        ------
        LoadshareError
            If the case is missing or another one.
        """
        from loadshare.report.figures.train import train

        return train(self._case(case))

    def _train(self, given: Case | None) -> Train:
        from loadshare.train import build_train

        return build_train(self._case(given))

    def _case(self, given: Case | None) -> Case:
        case = given if given is not None else self.result.case
        stamp = self.result.stamp
        if case is None:
            raise LoadshareError(
                f"{stamp.case}: this result was loaded from a file and does not hold its case, "
                "which the picture needs. Give it, as in "
                'result.plot.floats(ls.load_case("case.toml")).'
            )
        if case.hash != stamp.case_hash:
            raise LoadshareError(
                f"{stamp.case}: the case given is not the one that was solved: its hash is "
                f"{case.hash[:12]}…, the result's {stamp.case_hash[:12]}…"
            )
        return case
