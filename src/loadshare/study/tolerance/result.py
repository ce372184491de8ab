"""The result of a tolerance study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

from loadshare.equality import Comparable
from loadshare.errors import LoadshareError
from loadshare.libraries import pd, xr
from loadshare.numbers import counted
from loadshare.pictures import Figure, picture
from loadshare.results.dataset import unchanging
from loadshare.study.tolerance.dataset import dataset as labelled
from loadshare.study.tolerance.folder import Folder
from loadshare.study.tolerance.inputs import ScatteredInputs
from loadshare.study.tolerance.statistics import OmegaStatistics, Summary
from loadshare.study.tolerance.view import tolerance_view
from loadshare.study.tolerance.worst import WorstCase
from loadshare.view import View, Viewed

Over: TypeAlias = Literal["stage", "group"]
OVERS: tuple[Over, ...] = get_args(Over)
"""Whose mean torque Ω may be over."""


@dataclass(frozen=True, slots=True, eq=False)
class FloatStatistics(Comparable):
    """Statistics of a float.

    Attributes
    ----------
    gear : str
    way : Summary
        Displacement of its centre, the largest over the positions [m].
    boundary_force : Summary or None
        Largest force on a contact of its ring [N]; None without a ring.
    pressed : float or None
        Share of the samples in which it presses against its ring at some position.
    """

    gear: str
    way: Summary
    boundary_force: Summary | None
    pressed: float | None


@dataclass(frozen=True, eq=False, repr=False)
class Tolerance(Viewed):
    """The result of a tolerance study.

    Attributes
    ----------
    case : str
        Name of the case.
    inputs : ScatteredInputs
    settings : mapping
        Everything on which the samples depend, as in ``study.json``.
    limit : float or None
    samples, refused : int
        Number of all samples, and of those without a certified answer, which enter no statistic.
    messages : mapping of str to int
        Why samples were refused, and how many for each reason.
    omega : tuple of OmegaStatistics
    torque : mapping of mesh to Summary
        Largest driver torque over the positions [N·m].
    floats : tuple of FloatStatistics
    design_refused : int
        Samples for the shares of variance without a certified answer; their rows are left out.
    overs : tuple of str
        "stage", and "group" if the system's Ω over the mean of the group differs.
    worst : tuple of WorstCase
        One for each of `overs`.
    residual : float
        Largest scaled residual of all certificates.
    folder : Folder
        Where the samples are.
    """

    case: str
    inputs: ScatteredInputs
    settings: Mapping[str, Any]
    limit: float | None
    samples: int
    refused: int
    messages: Mapping[str, int]
    omega: tuple[OmegaStatistics, ...]
    torque: Mapping[str, Summary]
    floats: tuple[FloatStatistics, ...]
    design_refused: int
    overs: tuple[str, ...]
    worst: tuple[WorstCase, ...]
    residual: float
    folder: Folder = field(compare=False)

    def of(self, stage: str = "system", over: Over = "stage") -> OmegaStatistics:
        """Return the statistics of Ω of a stage.

        Raises
        ------
        KeyError
            If there is no such stage or mean.
        """
        for one in self.omega:
            if (one.stage, one.over) == (stage, over):
                return one
        raise KeyError(f"no Ω of stage {stage!r} over the mean of each {over!r}")

    @property
    def parts(self) -> list[Path]:
        """Parquet files of the samples, in order."""
        return self.folder.files()

    def to_frame(self, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Read the samples: inputs and largest figures, one row each.

        Parameters
        ----------
        columns : sequence of str, optional
            Such as ``["omega.system", "float.4 [m]"]``; all by default.

        Raises
        ------
        ValueError
            If there is no such column.
        """
        return self.folder.frame(columns)

    def to_dataframe(self, columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Read the samples, as `to_frame` does; column names include the unit."""
        return self.to_frame(columns)

    def to_xarray(self) -> xr.Dataset:
        """Return the statistics as labelled arrays, `dataset`."""
        return self.dataset

    @cached_property
    def dataset(self) -> xr.Dataset:
        """Statistics of Ω as labelled arrays: over (over, stage), level, input, bin."""
        return unchanging(labelled(self))

    def plot(self, stage: str = "system", over: Over = "stage") -> Figure:
        """Plot how Ω of a stage scatters, and which inputs cause it.

        Parameters
        ----------
        stage : str
        over : {"stage", "group"}
            Whose mean torque Ω is over.

        Raises
        ------
        LoadshareError
            If there is no such stage, or none at all.
        ValueError
            If there is no such mean.
        """
        if not self.omega:
            raise LoadshareError("a case without stages has torques, but no Ω to draw")
        return picture(self, stage, over)

    def _view(self) -> View:
        """Show how Ω scatters, where that comes from, and the worst case found."""
        return tolerance_view(self)

    def _left_open(self) -> list[str]:
        if not self.refused:
            return []
        return [f"{counted(self.refused, 'sample')} of {self.samples} not certified."]
