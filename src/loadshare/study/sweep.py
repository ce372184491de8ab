"""Sweeps: a case solved over a grid of one or two parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from math import prod
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from loadshare.case import Case
from loadshare.errors import CaseError, Problem, Refused
from loadshare.job import Progress, solve
from loadshare.output import csv_of, netcdf_of, write_whole
from loadshare.pictures import picture
from loadshare.settings import ALLOWED
from loadshare.study.parameter import (
    STUDY,
    Parameter,
    applied,
    grid,
    named,
    read_parameter,
    too_many,
)
from loadshare.study.positions import loaded
from loadshare.train import build_train
from loadshare.view import View, Viewed

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from loadshare.report.figure import Figure
    from loadshare.results import Result

CERTIFIED, PARTLY, REFUSED, INVALID = "certified", "partly refused", "refused", "invalid"
MOST = 2
"""Parameters of a sweep."""


@dataclass(frozen=True, slots=True)
class Point:
    """What was found at one point of a sweep.

    Attributes
    ----------
    values : tuple of float
        Of the parameters, in their units.
    status : str
        "certified", "partly refused" (some positions), "refused", or "invalid" (no usable case).
    message : str
        Why not, where it is not certified.
    result : Result or None
        Of the certified positions.
    """

    values: tuple[float, ...]
    status: str
    message: str
    result: Result | None


@dataclass(frozen=True, repr=False)
class Sweep(Viewed):
    """A case over a grid.

    Attributes
    ----------
    case : str
        Name of the case.
    parameters : tuple of Parameter
    grids : tuple of tuple of float
        Values of each parameter, in its unit.
    count : int
        Positions of the case.
    points : tuple of Point
        The last parameter runs fastest.
    """

    case: str
    parameters: tuple[Parameter, ...]
    grids: tuple[tuple[float, ...], ...]
    count: int
    points: tuple[Point, ...]

    @property
    def passed(self) -> bool:
        """Whether every point is certified."""
        return all(p.status == CERTIFIED for p in self.points)

    @cached_property
    def dataset(self) -> xr.Dataset:
        """Everything found as labelled arrays: one dimension per parameter, then position."""
        from loadshare.study.tables import sweep_dataset

        return sweep_dataset(self)

    def plot(
        self,
        show: str = "omega",
        *,
        names: Sequence[str] | None = None,
        position: int | None = None,
        events: Sequence[tuple[float, str]] = (),
    ) -> Figure:
        """Picture of a figure over the grid: lines over one parameter, maps over two.

        Parameters
        ----------
        show : str
            Variable of `dataset`: "omega", "pair_omega", "torque", "share", "pair_share",
            "displacement", "margin", "reaction".
        names : sequence of str, optional
            Stages, meshes or floats to show; all by default.
        position : int, optional
            Position to show; by default the largest value over the positions.
        events : sequence of (float, str)
            Values of the one parameter at which something happens, and what, as
            `Critical.marks` gives them.

        Raises
        ------
        LoadshareError
            If there is no such variable, name or position.
        """
        drawn: Figure = picture(self, show, names=names, position=position, events=events)
        return drawn

    def to_frame(self) -> pd.DataFrame:
        """Torques and coefficients as a table, one row per point, position and mesh."""
        from loadshare.study.tables import sweep_frame

        return sweep_frame(self)

    def to_dataframe(self) -> pd.DataFrame:
        """The table of `to_frame`, with the unit of every column in ``attrs["units"]``."""
        from loadshare.results.dataset import with_units

        return with_units(self.to_frame(), self.dataset)

    def to_xarray(self) -> xr.Dataset:
        """The labelled arrays, `dataset`."""
        return self.dataset

    def _view(self) -> View:
        from loadshare.study.views import sweep_view

        return sweep_view(self)

    def to_netcdf(self, path: str | FilePath) -> None:
        """Write the labelled arrays to a netCDF file."""
        write_whole(FilePath(path), netcdf_of(self.dataset))

    def to_csv(self, path: str | FilePath) -> None:
        """Write the table to a CSV file."""
        write_whole(FilePath(path), csv_of(self.to_frame()))


def sweep(
    case: Case | str | FilePath,
    parameters: Mapping[Any, object],
    *,
    positions: Sequence[int] | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Solve a case at every point of a grid, each from the one before.

    Parameters
    ----------
    case : Case or path
    parameters : mapping of key to values
        One or two. A key is a dotted path such as ``"rings.4.float"``, a pattern such as
        ``"rings.*.float"``, or a tuple of keys; all keys of a parameter take the same value. The
        values are a text ``"0 um:12 um:61"`` (first, last, how many) or a list of values.
    positions : sequence of int, optional
        1-based positions; all by default.
    progress : Progress, optional
        Called after every point.

    Returns
    -------
    Sweep
        A point without an answer keeps its message and does not end the sweep.

    Raises
    ------
    CaseError
        If a key, its values, or the number of parameters cannot be used.
    ValueError
        If a position does not exist.

    Examples
    --------
    >>> import loadshare as ls
    >>> found = ls.sweep("cases/fgfbstts/limit_ring.toml", {"rings.*.float": "0 um:10 um:3"},
    ...                  positions=[1])
    >>> found.dataset["pair_omega"].sel(stage="II").values.round(4).tolist()
    [1.0471, 1.0189, 1.0]
    """
    case = loaded(case)
    if not 1 <= len(parameters) <= MOST:
        message = f"a sweep has 1 or {MOST} parameters, not {len(parameters)}"
        raise CaseError([Problem(STUDY, "sweep", "", message, "keys joined by = count as one")])
    chosen, grids = [], []
    for key, given in parameters.items():
        values, unit = grid(given, named(key))
        chosen.append(read_parameter(case, key, unit))
        grids.append(values)
    _check_apart(chosen)
    total = prod(len(values) for values in grids)
    if total > ALLOWED.points:
        raise too_many("sweep", total)
    points: list[Point] = []
    unusable: list[CaseError] = []
    near: Case | None = None
    for values in product(*grids):
        try:
            changed = applied(case, chosen, values)
            points.append(_solved(changed, values, positions, near))
            near = changed
        except CaseError as error:
            unusable.append(error)
            points.append(Point(values, INVALID, str(error), None))
        if progress is not None:
            progress(len(points), total)
    if len(unusable) == len(points):
        # No point makes a case: the keys themselves are wrong.
        raise unusable[0]
    return Sweep(case.name, tuple(chosen), tuple(grids), _count(case, points), tuple(points))


def _check_apart(parameters: Sequence[Parameter]) -> None:
    seen: dict[str, str] = {}
    for parameter in parameters:
        for key in parameter.keys:
            if key in seen:
                message = f"is set by {seen[key]} and by {parameter.name}"
                raise CaseError([Problem(STUDY, key, "", message, "one parameter for each key")])
            seen[key] = parameter.name


def _count(case: Case, points: Sequence[Point]) -> int:
    found = [len(p.result.positions) for p in points if p.result is not None]
    return max(found, default=build_train(case).count)


def _solved(
    case: Case, values: tuple[float, ...], positions: Sequence[int] | None, near: Case | None
) -> Point:
    try:
        result = solve(case, positions=positions, near=near)
    except Refused as refusal:
        partial = refusal.partial
        return Point(values, PARTLY if partial else REFUSED, str(refusal), partial)
    return Point(values, CERTIFIED, "", result)
