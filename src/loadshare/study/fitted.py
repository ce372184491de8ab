"""What a fit found: the inputs, how well they are known, and how far the figures are."""

from __future__ import annotations

from dataclasses import dataclass

from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.libraries import pd
from loadshare.pictures import Figure, picture
from loadshare.study.compare import Comparison
from loadshare.study.parameter import Parameter
from loadshare.view import View, Viewed


@dataclass(frozen=True, slots=True)
class Unknown:
    """A fitted input.

    Attributes
    ----------
    parameter : Parameter
    low, high, start, value : float
        In the parameter's unit.
    deviation : float
        Standard deviation; infinite where the data do not determine it.
    at_bound : bool
    """

    parameter: Parameter
    low: float
    high: float
    start: float
    value: float
    deviation: float
    at_bound: bool


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Viewed):
    """Inputs fitted to measured figures.

    Attributes
    ----------
    case : Case
        With the fitted values.
    unknowns : tuple of Unknown
    covariance, correlation : ndarray, shape (n, n)
        In the parameters' units; from the stated uncertainties. Infinite (covariance) or NaN
        (correlation) where the data do not determine an input.
    singular_values : ndarray, shape (min(m, n),)
        Of the sensitivities, measured in standard deviations over the range of each unknown.
    warnings : tuple of str
        Which inputs the data cannot determine separately, which are at a bound, and whether the
        figures are too far from the measured ones for their uncertainties.
    comparison : Comparison
        Measured against computed at the fitted values, certified.
    starts : tuple of float
        χ² reached from every starting point; NaN where one failed.
    evaluations : int
        Sets of equilibria solved.
    """

    case: Case
    unknowns: tuple[Unknown, ...]
    covariance: Array
    correlation: Array
    singular_values: Array
    warnings: tuple[str, ...]
    comparison: Comparison
    starts: tuple[float, ...]
    evaluations: int

    @property
    def chi_square(self) -> float:
        """Sum of the squared deviations, in standard deviations."""
        return self.comparison.chi_square

    @property
    def freedom(self) -> int:
        """Figures less unknowns."""
        return len(self.comparison.deviations) - len(self.unknowns)

    @property
    def values(self) -> dict[str, str | float]:
        """Fitted values by parameter, as a case file says them."""
        return {u.parameter.name: u.parameter.text(u.value) for u in self.unknowns}

    def to_dataframe(self) -> pd.DataFrame:
        """The fitted inputs as a table, one row each, in the unit given next to them."""
        rows = [
            {"input": u.parameter.name, "value": u.value, "deviation": u.deviation}
            | {"unit": u.parameter.unit or "1", "low": u.low, "high": u.high}
            | {"start": u.start, "at_bound": u.at_bound}
            for u in self.unknowns
        ]
        return pd.DataFrame(rows)

    def plot(self) -> Figure:
        """Picture of how far every figure, computed at the fitted values, is from the measured."""
        return picture(self)

    def _view(self) -> View:
        """Show the fitted inputs, how well they fit, and what the data leave open."""
        degrees = "1 degree" if self.freedom == 1 else f"{self.freedom} degrees"
        facts = (
            ("χ²", f"{self.chi_square:.4g}, {degrees} of freedom"),
            ("starts", f"{len(self.starts)}, {self.evaluations} sets of equilibria"),
            ("mind", " ".join(self.warnings)),
        )
        rows = tuple(
            (
                u.parameter.name,
                f"{u.value:.5g} ± {u.deviation:.2g} {u.parameter.unit}".rstrip(),
                f"{u.low:g} to {u.high:g}",
            )
            for u in self.unknowns
        )
        return View(f"Fit of {self.case.name}", facts, ("input", "value", "between"), rows)
