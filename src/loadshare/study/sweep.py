"""Sweeps: a case solved over a grid of one or two parameters."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import product
from math import prod
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from loadshare.arguments import check_mapping, one_of, whole
from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.equality import Comparable
from loadshare.errors import CaseError, Problem
from loadshare.job.answered import SampleAnswers, answer_samples
from loadshare.later import known
from loadshare.libraries import pd, xr
from loadshare.numbers import counted, omega
from loadshare.output import csv_of, netcdf_of, write_whole
from loadshare.pictures import Figure, picture
from loadshare.progress import Progress
from loadshare.results import Result
from loadshare.results.dataset import unchanging, with_units
from loadshare.results.share import NO_STAGES
from loadshare.settings import ALLOWED
from loadshare.study.parameter import (
    STUDY,
    Parameter,
    applied,
    check_apart,
    grid,
    named,
    read_parameter,
    table_of,
    too_many,
)
from loadshare.study.positions import loaded
from loadshare.study.tables import largest_shares, sweep_dataset, sweep_frame
from loadshare.table import Cell, Table, text_table
from loadshare.train import build_train
from loadshare.view import View, Viewed

CERTIFIED, PARTLY, REFUSED, INVALID = "certified", "partly refused", "refused", "invalid"
MOST = 2
"""Largest number of parameters of a sweep."""
MEANS = {"stage": "omega", "group": "pair_omega"}
"""Variables of the largest Ω, by whose mean it is over."""


@dataclass(frozen=True, eq=False)
class Point(Comparable):
    """The outcome at one point of a sweep.

    Attributes
    ----------
    values : tuple of float
        Of the parameters, in their units.
    status : str
        "certified", "partly refused" (some positions), "refused", or "invalid" (no usable case).
    message : str
        Why the point is not certified, if it is not.
    find : callable
        Returns `result`.
    """

    values: tuple[float, ...]
    status: str
    message: str
    find: Callable[[], Result | None] = field(repr=False, compare=False)

    @cached_property
    def result(self) -> Result | None:
        """Result of the certified positions; None if there are none."""
        return self.find()


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Viewed):
    """A case solved over a grid.

    Attributes
    ----------
    case : str
        Name of the case.
    title : str
    parameters : tuple of Parameter
    grids : tuple of tuple of float
        Values of each parameter, in its unit.
    count : int
        Number of positions.
    points : tuple of Point
        The last parameter varies fastest.
    answered : SampleAnswers
        The answers at all points that were solved.
    usable : tuple of int
        Numbers of the points that were solved.
    """

    case: str
    title: str
    parameters: tuple[Parameter, ...]
    grids: tuple[tuple[float, ...], ...]
    count: int
    points: tuple[Point, ...]
    answered: SampleAnswers = field(repr=False, compare=False)
    usable: tuple[int, ...] = field(repr=False)

    def _said(self) -> Any:
        arrays = {name: array.values for name, array in self.dataset.variables.items()}
        return super()._said() | arrays

    @property
    def passed(self) -> bool:
        """Whether every point is certified."""
        return all(p.status == CERTIFIED for p in self.points)

    @cached_property
    def dataset(self) -> xr.Dataset:
        """All results as labelled arrays: one dimension per parameter, then position."""
        return unchanging(sweep_dataset(self))

    def largest(self, kind: str, point: int) -> dict[str, float | None]:
        """Return the largest Ω of every stage and of the system at a point, given by its number.

        Parameters
        ----------
        kind : {"omega", "pair_omega"}
            Over the mean of the stage or of the group.
        point : int
        """
        one_of("kind", kind, self.shares)
        point = whole("point", point, 0)
        every = {stage: float(values[point]) for stage, values in self.shares[kind].items()}
        return {stage: None if math.isnan(value) else value for stage, value in every.items()}

    @cached_property
    def shares(self) -> dict[str, dict[str, Array]]:
        """Largest Ω at all points, by kind and stage; NaN where there is none."""
        return largest_shares(self)

    def plot(
        self,
        show: str = "omega",
        *,
        names: Sequence[str] | None = None,
        position: int | None = None,
        events: Sequence[tuple[float, str]] = (),
    ) -> Figure:
        """Plot a variable over the grid: lines over one parameter, maps over two.

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
            Values of a single parameter at which something happens, with a label, as
            `Critical.marks` returns them.

        Raises
        ------
        LoadshareError
            If there is no such variable, name or position.
        """
        return picture(self, show, names=names, position=position, events=events)

    def to_frame(self) -> pd.DataFrame:
        """Return torques and coefficients as a table, one row per point, position and mesh."""
        return sweep_frame(self)

    def to_dataframe(self) -> pd.DataFrame:
        """Return the table of `to_frame`, with the unit of every column in ``attrs["units"]``."""
        return with_units(self.to_frame(), self.dataset)

    def to_xarray(self) -> xr.Dataset:
        """Return the labelled arrays, `dataset`."""
        return self.dataset

    def _view(self) -> View:
        """Show the grid, the status of its points, and the largest Ω at each."""
        facts = []
        for p, values in zip(self.parameters, self.grids, strict=True):
            ends = f"{values[0]:g} to {values[-1]:g} {p.unit}".rstrip()
            facts.append((p.name, f"{ends}, {counted(len(values))}"))
        counts = Counter(p.status for p in self.points)
        facts.append(("points", ", ".join(f"{count} {status}" for status, count in counts.items())))
        facts.append(("mind", " ".join(self._left_open())))
        tables = [self._table(mean, kind) for mean, kind in MEANS.items()]
        if tables[0].texts == tables[1].texts:
            tables = [self._table("stage and group alike", MEANS["stage"])]
        return View(f"Sweep of {self.case}", tuple(facts), tuple(tables))

    def _table(self, mean: str, kind: str) -> Table:
        """Return the largest Ω of every stage at every point."""
        stages = self.largest(kind, 0)
        # Where every point is certified, a column that says so would only take room.
        status = [] if self.passed else ["status"]
        rows = (
            (
                *(Cell(f"{value:.6g}", value) for value in point.values),
                *(Cell(omega(value), value) for value in self.largest(kind, k).values()),
                *([Cell(point.status)] if status else []),
            )
            for k, point in enumerate(self.points)
        )
        heads = [*(p.column for p in self.parameters), *(f"Ω {stage}" for stage in stages), *status]
        made = text_table(f"Sweep of {self.case}: largest Ω, by {mean}", heads, rows, status)
        if list(stages) == ["system"]:
            made.notes.append(NO_STAGES)
        return made

    def _left_open(self) -> list[str]:
        failed = [p for p in self.points if p.status != CERTIFIED]
        if not failed:
            return []
        reasons = dict.fromkeys(f"{p.status}: {p.message.splitlines()[0]}" for p in failed)
        return [*reasons, f"{counted(len(failed), 'point')} of {len(self.points)} not certified."]

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
    """Solve a case at every point of a grid.

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
        Called from time to time with the number of points done and the number of all.

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
    TypeError
        If `parameters` is not a mapping.

    Examples
    --------
    >>> import loadshare as ls
    >>> found = ls.sweep("cases/fgfbstts/limit_ring.toml", {"rings.*.float": "0 um:10 um:3"},
    ...                  positions=[1])
    >>> found.dataset["pair_omega"].sel(stage="II").values.round(4).tolist()
    [1.0471, 1.0189, 1.0]
    """
    case, chosen, grids = _grids(case, parameters)
    total = prod(len(values) for values in grids)
    if total > ALLOWED.points:
        raise too_many("sweep", total)
    points = np.array(list(product(*grids)))
    refused: dict[int, CaseError] = {}
    try:
        _check_corners(case, chosen, points)
        answered = answer_samples(case, table_of(chosen, points), positions, progress)
    except CaseError as error:
        refused = _unusable(case, chosen, points)
        if len(refused) in (0, total):
            # If no point gives a valid case, the keys themselves are wrong.
            raise refused.get(0, error) from None
        some = np.delete(points, list(refused), axis=0)
        answered = answer_samples(case, table_of(chosen, some), positions, progress)
    usable = tuple(k for k in range(total) if k not in refused)
    found = {k: _point(tuple(points[k].tolist()), answered, s) for s, k in enumerate(usable)}
    for k, why in refused.items():
        found[k] = Point(tuple(points[k].tolist()), INVALID, str(why), known(None))
    return Sweep(
        case=case.name,
        title=case.title,
        parameters=tuple(chosen),
        grids=tuple(grids),
        count=len(answered.positions),
        points=tuple(found[k] for k in range(total)),
        answered=answered,
        usable=usable,
    )


def _grids(
    case: Case | str | FilePath, parameters: Mapping[Any, object]
) -> tuple[Case, list[Parameter], list[tuple[float, ...]]]:
    """Return the case of a sweep, its parameters, and the values of each."""
    check_mapping("inputs by key path", "{'rings.4.float': '0 um:12 um:61'}", parameters)
    case = loaded(case, map(named, parameters))
    if not 1 <= len(parameters) <= MOST:
        message = f"a sweep has 1 or {MOST} parameters, not {len(parameters)}"
        raise CaseError([Problem(STUDY, "sweep", "", message, "keys joined by = count as one")])
    chosen, grids = [], []
    for key, given in parameters.items():
        values, unit = grid(given, named(key))
        chosen.append(read_parameter(case, key, unit))
        grids.append(values)
    check_apart(chosen)
    return case, chosen, grids


def _check_corners(case: Case, chosen: Sequence[Parameter], values: Array) -> None:
    """Run the checks of the case at the corners of the grid that those of samples leave out."""
    low, high = values.min(axis=0), values.max(axis=0)
    if len(chosen) > 1:
        applied(case, chosen, (low[0], high[1]))
        applied(case, chosen, (high[0], low[1]))


def _unusable(case: Case, chosen: Sequence[Parameter], values: Array) -> dict[int, CaseError]:
    """Return the error of every point that has no usable case, by number."""
    found = {}
    for number, at in enumerate(values.tolist()):
        try:
            build_train(applied(case, chosen, at))
        except CaseError as error:
            found[number] = error
    return found


def _point(values: tuple[float, ...], answered: SampleAnswers, sample: int) -> Point:
    """Return the outcome at a point."""
    refused = answered.refused(sample)
    whole = len(refused) == len(answered.asked(sample))
    status = REFUSED if whole else PARTLY if refused else CERTIFIED
    if any(isinstance(error, CaseError) for error in refused):
        status = INVALID
    message = "\n".join(map(str, refused))
    return Point(values, status, message, partial(answered.result, sample))
