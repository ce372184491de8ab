"""Fits of unknown inputs to measured figures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from loadshare.arguments import check_mapping, whole
from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.case.reader import opened
from loadshare.errors import CaseError, Refused
from loadshare.libraries import pd, special
from loadshare.numbers import counted
from loadshare.pictures import Figure, picture
from loadshare.progress import Progress
from loadshare.settings import FIT
from loadshare.study.compare import Comparison, Deviation, computed
from loadshare.study.least_squares import LeastSquares
from loadshare.study.parameter import Parameter, applied
from loadshare.table import text_table
from loadshare.view import View, Viewed, figure


@dataclass(frozen=True, slots=True)
class Unknown:
    """A fitted input.

    Attributes
    ----------
    parameter : Parameter
    low, high, start, value : float
        In the parameter's unit.
    deviation : float
        Standard deviation, at a kink that to the side to which the figures change less; infinite
        where the data do not determine it.
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
        Of the sensitivities, in standard deviations of the figures per range of each unknown.
    warnings : tuple of str
        Which inputs the data cannot determine separately, which are at a bound, and whether the
        figures are too far from the measured ones for their uncertainties.
    comparison : Comparison
        Measured figures and those computed at the fitted values, certified.
    starts : tuple of float
        χ² reached from every starting point; NaN where one failed.
    evaluations : int
        Number of sets of equilibria that were solved.
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
        """Degrees of freedom: figures less unknowns."""
        return len(self.comparison.deviations) - len(self.unknowns)

    @property
    def values(self) -> dict[str, str | float]:
        """Fitted values by parameter, as a case file writes them."""
        return {u.parameter.name: u.parameter.text(u.value) for u in self.unknowns}

    def to_dataframe(self) -> pd.DataFrame:
        """Return the fitted inputs as a table, one row each, with their units."""
        rows = [
            {"input": u.parameter.name, "value": u.value, "deviation": u.deviation}
            | {"unit": u.parameter.unit or "1", "low": u.low, "high": u.high}
            | {"start": u.start, "at_bound": u.at_bound}
            for u in self.unknowns
        ]
        return pd.DataFrame(rows)

    def plot(self) -> Figure:
        """Plot how far every figure computed at the fitted values is from the measured one."""
        return picture(self)

    def _view(self) -> View:
        """Show the fitted inputs, how well they fit, and what the data leave open."""
        degrees = counted(max(self.freedom, 0), "degree")
        facts = (
            ("χ²", f"{self.chi_square:.4g}, {degrees} of freedom"),
            ("starts", f"{len(self.starts)}, {self.evaluations} sets of equilibria"),
            ("mind", " ".join(self.warnings)),
        )
        rows = (
            (
                u.parameter.name,
                u.parameter.unit,
                f"{u.start:.6g}",
                f"{u.value:.6g}",
                "not determined" if math.isinf(u.deviation) else f"{u.deviation:.3g}",
                f"{u.low:g} … {u.high:g}",
            )
            for u in self.unknowns
        )
        heads: tuple[str, ...] = ("unknown", "unit", "start", "fitted", "±", "bounds")
        notes = []
        if len(self.starts) > 1:
            reached = ", ".join(f"{chi:.4g}" if chi == chi else "failed" for chi in self.starts)
            notes = [f"χ² from each starting point: {reached}"]
        tables = [text_table("Fitted inputs", heads, rows, heads[:2], notes)]
        if len(self.unknowns) > 1:
            names = [u.parameter.name for u in self.unknowns]
            correlations = (
                (name, *(figure(c, "+.3f") for c in row))
                for name, row in zip(names, self.correlation, strict=True)
            )
            heads = ("correlation", *names)
            tables.append(text_table("Correlations", heads, correlations, heads[:1]))
        return View(f"Fit of {self.case.name}", facts, (*tables, *self.comparison._view().tables))


def fit(
    case: Case | str | FilePath,
    unknowns: Mapping[Any, Sequence[object] | str],
    *,
    starts: int = 1,
    seed: int = 0,
    progress: Progress | None = None,
) -> Fit:
    """Fit inputs of a case to measured figures.

    Parameters
    ----------
    case : Case or path
        With measurements, ``[measured.NAME]``.
    unknowns : mapping of key to (low, high)
        Bounds, also as a text "LOW:HIGH", by dotted key path, pattern or tuple of keys (which take
        the same value). The first starting point is the case's own value if it lies between the
        bounds, else their middle.
    starts : int
        Number of starting points; those after the first are Sobol points between the bounds.
    seed : int
        Of the Sobol points.
    progress : callable, optional
        Called with the number of starting points that are done and the number of all.

    Returns
    -------
    Fit
        The best of all starting points.

    Raises
    ------
    CaseError
        If the case holds no measurement, or an unknown or its bounds cannot be used.
    Refused
        If no starting point leads to a certified answer.
    ValueError
        If `starts` is not a whole number of at least 1.

    Examples
    --------
    >>> import loadshare as ls
    >>> case = ls.load_case("cases/fgfbstts/installation_error.toml")
    >>> case = case.replace({"measured.bench": {
    ...     "position": 1, "pair_share": {"6-10": 0.80}, "uncertainty": 0.01}})
    >>> found = ls.fit(case, {"errors.6.installation[0]": ("0 um", "100 um")})
    >>> f"{found.unknowns[0].value:.2f} ± {found.unknowns[0].deviation:.2f} um"
    '40.57 ± 1.98 um'
    """
    check_mapping("bounds by key path", "{'rings.4.float': ('0 um', '9 um')}", unknowns)
    starts, seed = whole("starts", starts), whole("seed", seed, 0)
    problem = LeastSquares(opened(case), unknowns)
    reached: list[tuple[float, Array]] = []
    chis: list[float] = []
    refusal: Exception | None = None
    for number, start in enumerate(problem.starting_points(starts, seed), start=1):
        try:
            chi, found = problem.descend(start)
        except (Refused, CaseError) as error:
            refusal = refusal or error
            chis.append(math.nan)
        else:
            reached.append((chi, found))
            chis.append(chi)
        if progress is not None:
            progress(number, starts)
    if not reached:
        assert refusal is not None
        raise problem.bounds_error() or refusal
    _, best = min(reached, key=lambda r: r[0])
    return _fitted(problem, best, tuple(chis))


def _fitted(problem: LeastSquares, u: Array, chis: tuple[float, ...]) -> Fit:
    """Return the fit at a point."""
    _, result = problem.solved(u)
    values = computed(problem.case, problem.targets, result)
    comparison = Comparison(tuple(map(Deviation, problem.targets, values)), result)
    slopes = problem.slopes(u)
    change = np.linalg.norm(slopes, axis=1)
    # At a kink, such as where a mesh begins to carry, the data determine an input to one side only.
    less = np.argmin(change, axis=0)
    sizes, covariance, groups = _determined(np.where(less, slopes[1], slopes[0]))
    one_sided = set(np.flatnonzero(change.max(axis=0) > FIT.felt))
    scale = problem.high - problem.low
    covariance = covariance * np.outer(scale, scale)
    spread = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore"):
        correlation = covariance / np.outer(spread, spread)
    columns = (problem.low, problem.high, problem.own(), problem.numbers(u), spread)
    at_bound = ((u <= 0.0) | (u >= 1.0)).tolist()
    figures = zip(*(column.tolist() for column in columns), at_bound, strict=True)
    unknowns = [Unknown(p, *of) for p, of in zip(problem.parameters, figures, strict=True)]
    names, too_far = [p.name for p in problem.parameters], _too_far(comparison, len(unknowns))
    warnings = [
        _left_open([names[k] for k in group], bool(too_far), one_sided.issuperset(group))
        for group in groups
    ]
    warnings += [f"{u.parameter.name} is at its bound." for u in unknowns if u.at_bound]
    return Fit(
        case=applied(problem.written, problem.parameters, problem.numbers(u)),
        unknowns=tuple(unknowns),
        covariance=covariance,
        correlation=correlation,
        singular_values=sizes,
        warnings=(*warnings, *too_far),
        comparison=comparison,
        starts=chis,
        evaluations=problem.evaluations,
    )


def _determined(jacobian: Array) -> tuple[Array, Array, list[list[int]]]:
    """Return how well the data determine the scaled inputs.

    Returns
    -------
    ndarray, shape (min(m, n),)
        Singular values.
    ndarray, shape (n, n)
        Covariance; infinite for inputs that are left open.
    list of list of int
        These inputs, in groups whose members can compensate for one another.
    """
    _, sizes, right = np.linalg.svd(jacobian, full_matrices=True)
    full = np.zeros(len(right))
    full[: len(sizes)] = sizes
    loose = full <= max(FIT.separable * float(full.max(initial=0.0)), FIT.felt)
    known, groups = right[~loose], _groups(right[loose])
    covariance = known.T @ np.diag(full[~loose] ** -2.0) @ known
    free = [k for group in groups for k in group]
    covariance[free, :] = covariance[:, free] = math.inf
    return np.asarray(sizes), covariance, groups


def _left_open(names: list[str], elsewhere: bool, one_sided: bool) -> str:
    """Say that the data do not determine some inputs.

    With `elsewhere`, this is known of the point found only; with `one_sided`, they determine that
    an input does not change one way, but not that it does not change the other way.
    """
    if len(names) > 1:
        return f"The data cannot tell {', '.join(names)} apart."
    # From a start where the figures are flat the search does not move.
    who = "Where the search ended, the figures do not depend on" if elsewhere else ""
    to = " to one side of its value" if one_sided else ""
    return f"{who or 'The data do not determine'} {names[0]}{to}."


def _too_far(comparison: Comparison, unknowns: int) -> list[str]:
    """Warn if χ² exceeds what the stated uncertainties give in all but one case in a thousand."""
    freedom, chi = len(comparison.deviations) - unknowns, comparison.chi_square
    # Where all figures could be met, those missed because of a bound count as one.
    usual = float(special.chdtri(max(freedom, 1), FIT.improbable))
    if chi <= usual:
        return []
    return [
        f"χ² is {chi:.4g}, above {usual:.3g} for the stated uncertainties: the figures contradict "
        "the case or one another, or more starting points are needed. The standard deviations of "
        "the inputs are unreliable."
    ]


def _groups(loose: Array) -> list[list[int]]:
    """Group the inputs that the data leave open; members of a group can compensate for one another.

    Parameters
    ----------
    loose : ndarray, shape (k, n)
        Orthonormal directions that change no figure. Their projector, unlike the directions, does
        not depend on how they were chosen.
    """
    from scipy.sparse.csgraph import connected_components

    shared = np.abs(loose.T @ loose)
    # An input with any part in them, however small, is not determined: another can move it.
    left_open = np.flatnonzero(np.diag(shared) > FIT.separable**2)
    count, group = connected_components(
        shared[np.ix_(left_open, left_open)] > FIT.separable, directed=False
    )
    return sorted((left_open[group == g].tolist() for g in range(count)), key=max)
