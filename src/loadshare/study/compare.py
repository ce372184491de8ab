"""Comparison of measured and computed figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np

from loadshare.case import Case
from loadshare.case.keys import dotted
from loadshare.case.measured import COEFFICIENTS, Measurement
from loadshare.errors import CaseError
from loadshare.job import solve
from loadshare.libraries import pd
from loadshare.numbers import counted
from loadshare.pictures import Figure, picture
from loadshare.progress import Progress
from loadshare.results import Position, Result
from loadshare.study.positions import loaded
from loadshare.table import text_table
from loadshare.view import View, Viewed

MEANS = ("torque", "share", "pair_share")
"""Quantities of a mesh; if no position is given, their mean over all positions is used."""


@dataclass(frozen=True, slots=True)
class Target:
    """One measured figure.

    Attributes
    ----------
    measurement : str
    quantity : str
        "torque", "share", "pair_share", "omega" or "pair_omega".
    where : str
        Mesh or stage.
    position : int or None
    value, uncertainty : float
        [N·m] or [-].
    """

    measurement: str
    quantity: str
    where: str
    position: int | None
    value: float
    uncertainty: float

    @property
    def unit(self) -> str:
        """SI unit."""
        return "N·m" if self.quantity == "torque" else ""

    @property
    def key(self) -> str:
        """Key of the figure in the case."""
        return dotted(("measured", self.measurement, self.quantity, self.where))


@dataclass(frozen=True, slots=True)
class Deviation:
    """A measured figure and its computed counterpart.

    Attributes
    ----------
    target : Target
    computed : float
        [N·m] or [-].
    """

    target: Target
    computed: float

    @property
    def difference(self) -> float:
        """Computed less measured."""
        return self.computed - self.target.value

    @property
    def deviations(self) -> float:
        """The difference in standard deviations of the measurement."""
        return self.difference / self.target.uncertainty


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Viewed):
    """All measured figures of a case, compared with the computed ones.

    Attributes
    ----------
    deviations : tuple of Deviation
    result : Result
        The certified result.
    """

    deviations: tuple[Deviation, ...]
    result: Result

    @property
    def chi_square(self) -> float:
        """Sum of the squared deviations, in standard deviations."""
        return math.fsum(d.deviations**2 for d in self.deviations)

    def to_frame(self) -> pd.DataFrame:
        """Return the comparison as a table."""
        of_target = ("measurement", "quantity", "where", "position")
        rows = [
            {name: getattr(d.target, name) for name in of_target}
            | {"measured": d.target.value, "uncertainty": d.target.uncertainty}
            | {name: getattr(d, name) for name in ("computed", "difference", "deviations")}
            for d in self.deviations
        ]
        return pd.DataFrame(rows).astype({"position": "Int64"})

    def to_dataframe(self) -> pd.DataFrame:
        """Return the table of `to_frame`, with the unit of each figure next to it."""
        table = self.to_frame()
        return table.assign(unit=[d.target.unit or "1" for d in self.deviations])

    def plot(self) -> Figure:
        """Plot how far every computed figure is from the measured one."""
        return picture(self)

    def _view(self) -> View:
        """Show the measured figures next to the computed ones."""
        rows = (
            (
                d.target.measurement,
                f"{d.target.quantity} {d.target.where}"
                + (f" [{d.target.unit}]" if d.target.unit else ""),
                "all" if d.target.position is None else str(d.target.position),
                f"{d.target.value:.6g}",
                f"{d.target.uncertainty:.3g}",
                f"{d.computed:.6g}",
                f"{d.difference:+.3g}",
                f"{d.deviations:+.2f}",
            )
            for d in self.deviations
        )
        words = ("measured", "of", "at")
        heads = (*words, "figure", "±", "computed", "difference", "in ±")
        title = "Measured against computed"
        chi = f"χ² = {self.chi_square:.4g} over {counted(len(self.deviations), 'figure')}"
        made = text_table(title, heads, rows, words, [chi])
        return View(title, (("case", self.result.stamp.case),), (made,))


def compare(case: Case | str | FilePath, *, progress: Progress | None = None) -> Comparison:
    """Compare the measurements in a case with computed figures.

    Parameters
    ----------
    case : Case or path
        With at least one table ``[measured.NAME]``.
    progress : Progress, optional
        Called after every position.

    Returns
    -------
    Comparison

    Raises
    ------
    CaseError
        If the case cannot be used, holds no measurement, or holds one of an element without load.
    Refused
        If a position has no certified equilibrium.

    Examples
    --------
    >>> import loadshare as ls
    >>> case = ls.load_case("cases/fgfbstts/both_errors.toml")
    >>> printed = {"6-10": 0.933, "7-10": 1.067}
    >>> measured = {"position": 1, "pair_share": printed, "uncertainty": 0.002}
    >>> found = ls.compare(case.replace({"measured.fig10": measured}))
    >>> [f"{d.target.where}: {d.difference:+.4f}" for d in found.deviations]
    ['6-10: +0.0011', '7-10: -0.0011']
    """
    case = loaded(case)
    wanted = targets(case)
    result = solve(case, positions=needed(wanted), progress=progress)
    found = zip(wanted, computed(case, wanted, result), strict=True)
    return Comparison(tuple(Deviation(t, value) for t, value in found), result)


def targets(case: Case) -> list[Target]:
    """Return all measured figures of a case.

    Raises
    ------
    CaseError
        If there is none.
    """
    found = [t for name, m in case.measured.items() for t in _targets(name, m)]
    if not found:
        message = "contains no measurement"
        raise CaseError([case.problem("measured", message, "tables [measured.NAME]")])
    return found


def _targets(name: str, measurement: Measurement) -> list[Target]:
    at = measurement.position
    found = []
    if measurement.torque and measurement.torque_uncertainty:
        spread = measurement.torque_uncertainty.si
        found += [
            Target(name, "torque", m, at, t.si, spread) for m, t in measurement.torque.items()
        ]
    for quantity in COEFFICIENTS:
        figures: dict[str, float] = getattr(measurement, quantity) or {}
        spread = measurement.uncertainty or 0.0
        found += [Target(name, quantity, key, at, v, spread) for key, v in figures.items()]
    return found


def needed(wanted: list[Target]) -> list[int] | None:
    """Return the positions that the figures need; None for all."""
    positions = [t.position for t in wanted if t.position is not None]
    return sorted(set(positions)) if len(positions) == len(wanted) else None


def computed(case: Case, wanted: Iterable[Target], result: Result) -> list[float]:
    """Return the computed counterparts of measured figures [N·m] or [-].

    Raises
    ------
    CaseError
        If a measured figure has no computed counterpart.
    """
    found = {target: _computed(target, result) for target in wanted}
    message = "has no computed counterpart: its mesh or stage carries no load"
    hint = "Give a position at which it does, or leave the figure out."
    problems = [case.problem(t.key, message, hint=hint) for t, v in found.items() if math.isnan(v)]
    if problems:
        raise CaseError(problems)
    return list(found.values())


def _computed(target: Target, result: Result) -> float:
    """Return the computed counterpart of one figure; NaN if there is none."""
    values = [getattr(p, kind)[mesh] for p, kind, mesh in _of_meshes(target, result)]
    if target.quantity in MEANS:
        return float(np.mean([np.nan if v is None else v for v in values]))
    return max((s for s in values if s is not None), default=np.nan)


def _of_meshes(target: Target, result: Result) -> list[tuple[Position, str, str]]:
    """Return the positions, quantities and meshes over which a figure is the mean or maximum."""
    at = [p for p in result.positions if target.position in (None, p.position)]
    if target.quantity in MEANS:
        return [(p, target.quantity, target.where) for p in at]
    kind = "pair_share" if target.quantity == "pair_omega" else "share"
    meshes = [m for s, own in result.stages.items() if target.where in (s, "system") for m in own]
    return [(p, kind, mesh) for p in at for mesh in meshes]


def slope(target: Target, result: Result, rate: Callable[[int, str], Mapping[str, float]]) -> float:
    """Return the derivative of a computed figure.

    Parameters
    ----------
    target : Target
    result : Result
    rate : callable
        Derivatives by mesh of a quantity ("torque", "share", "pair_share") at a position.
    """
    found = _of_meshes(target, result)
    if target.quantity in MEANS:
        return float(np.mean([rate(p.position, kind)[mesh] for p, kind, mesh in found]))
    largest = [(getattr(p, kind)[m] or 0.0, p.position, kind, m) for p, kind, m in found]
    _, position, kind, mesh = max(largest)
    return float(rate(position, kind)[mesh])
