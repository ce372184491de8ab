"""Unknown inputs fitted to what was measured: least squares with exact sensitivities."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from loadshare.arguments import check_mapping, whole
from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.case.reader import opened
from loadshare.case.words import count
from loadshare.errors import CaseError, Problem, Refused
from loadshare.job import solve
from loadshare.libraries import optimize, pd, qmc, special
from loadshare.pictures import Figure, picture
from loadshare.results import Result
from loadshare.settings import FIT
from loadshare.study.compare import Comparison, Deviation, Target, computed, needed, slope, targets
from loadshare.study.parameter import (
    RANGE,
    STUDY,
    Parameter,
    applied,
    check_apart,
    check_smooth,
    grid,
    named,
    read_parameter,
    read_value,
)
from loadshare.study.positions import loaded, paths_of
from loadshare.study.sensitivity import Sensitivity, sensitivity
from loadshare.study.sensitivity.inputs import twin_of
from loadshare.tooth import with_own_laws
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
        degrees = count(max(self.freedom, 0), "degree")
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


def fit(
    case: Case | str | FilePath,
    unknowns: Mapping[Any, Sequence[object] | str],
    *,
    starts: int = 1,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> Fit:
    """Fit inputs of a case to what was measured.

    Parameters
    ----------
    case : Case or path
        With measurements, ``[measured.NAME]``.
    unknowns : mapping of key to (low, high)
        Bounds, also as a text "LOW:HIGH", by dotted key path, pattern or tuple of keys (which take
        the same value). The case's own value is the first starting point if it lies between, else
        the middle.
    starts : int
        Starting points; the further ones are Sobol points between the bounds.
    seed : int
        Of those points.
    progress : callable, optional
        Called with the number of starting points that are done, and of all.

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
        If `starts` is no whole number from 1 on.

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
    problem = _Problem(opened(case), unknowns)
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
        raise problem.of_bounds() or refusal
    _, best = min(reached, key=lambda r: r[0])
    return problem.fitted(best, tuple(chis))


class _Problem:
    """The least-squares problem, its unknowns scaled to [0, 1] between their bounds."""

    def __init__(self, case: Case, unknowns: Mapping[Any, Sequence[object] | str]) -> None:
        names = list(map(named, unknowns))
        # Laws that no unknown touches are computed once, but stay the teeth's in what is found.
        self.written, self.case = with_own_laws(case, paths_of(names)), loaded(case, names)
        self.targets: list[Target] = targets(case)
        self.positions = needed(self.targets)
        if not unknowns:
            raise CaseError([Problem(STUDY, "fit", "", "has no unknown")])
        self.parameters: list[Parameter] = []
        ranges = []
        for key, bounds in unknowns.items():
            ends = _ends(bounds)
            numbers, unit = grid(ends, named(key), RANGE)
            if len(numbers) != 2 or not numbers[0] < numbers[1]:
                given = ", ".join(map(str, ends))
                raise CaseError([Problem(STUDY, named(key), given, "is no range", RANGE)])
            parameter = read_parameter(case, key, unit)
            check_smooth(parameter)
            self.parameters.append(parameter)
            ranges.append(numbers)
        check_apart(self.parameters)
        self.low, self.high = np.array(ranges).T
        self.spread = np.array([t.uncertainty for t in self.targets])
        self.measured = np.array([t.value for t in self.targets])
        self.evaluations = 0
        self._last: tuple[bytes, Case, Result] | None = None

    def of_bounds(self) -> CaseError | None:
        """Return which bounds make no case by themselves, if any does not."""
        problems: list[Problem] = []
        for parameter, *ends in zip(self.parameters, self.low, self.high, strict=True):
            for end in map(float, ends):
                try:
                    applied(self.case, [parameter], [end])
                except CaseError as error:
                    hint = f"The bound {parameter.text(end)} of the fit makes no case."
                    problems += [replace(p, hint=p.hint or hint) for p in error.problems]
        return CaseError(problems) if problems else None

    def starting_points(self, count: int, seed: int) -> list[Array]:
        """Return the values of `own`, then Sobol points."""
        points = [(self.own() - self.low) / (self.high - self.low)]
        if count > 1:
            power = math.ceil(math.log2(count))
            sampler = qmc.Sobol(len(self.parameters), seed=seed)
            points += list(sampler.random_base2(power))[: count - 1]
        return points

    def own(self) -> Array:
        """Values of the case itself; the middle of the bounds where it gives none between them."""
        from loadshare.case.keys import look_up, parse

        data, found = self.case.to_dict(), np.array((self.low + self.high) / 2)
        for k, parameter in enumerate(self.parameters):
            value = read_value(look_up(data, parse(parameter.keys[0])))
            with suppress(ValueError):
                number = math.nan if value is None else value.in_unit(parameter.unit).number
                found[k] = number if self.low[k] <= number <= self.high[k] else found[k]
        return found

    def numbers(self, u: Array) -> Array:
        """Values of the unknowns from their places between the bounds."""
        return np.asarray(self.low + np.clip(u, 0.0, 1.0) * (self.high - self.low))

    def solved(self, u: Array) -> tuple[Case, Result]:
        """Return the case and its certified result at a point; the last one is kept."""
        key = u.tobytes()
        if self._last is None or self._last[0] != key:
            case = applied(self.case, self.parameters, self.numbers(u))
            self._last = (key, case, solve(case, positions=self.positions))
            self.evaluations += 1
        return self._last[1], self._last[2]

    def residual(self, u: Array) -> Array:
        """Computed less measured figures, in standard deviations."""
        _, result = self.solved(u)
        found = np.array(computed(self.case, self.targets, result))
        return np.asarray((found - self.measured) / self.spread)

    def jacobian(self, u: Array) -> Array:
        """Derivative of the residual with respect to the scaled unknowns."""
        case, result = self.solved(u)
        # What has a twin varies with it.
        keys = [
            [key for n, key in enumerate(p.keys) if twin_of(key) not in p.keys[:n]]
            for p in self.parameters
        ]
        rates = sensitivity(case, [k for some in keys for k in some], positions=self.positions)
        columns = [sum(self._column(rates, result, key) for key in some) for some in keys]
        scale = self.high - self.low
        return np.asarray(np.array(columns).T / self.spread[:, None] * scale)

    def _column(self, rates: Sensitivity, result: Result, key: str) -> Array:
        """Derivatives of the figures with respect to one key, per unit of its value."""
        factor = next(item.value.factor for item in rates.inputs if item.key == key)
        rate = partial(_mean, rates, key)
        return factor * np.array([slope(t, result, rate) for t in self.targets])

    def descend(self, start: Array) -> tuple[float, Array]:
        """Return the χ² and the point to which a start leads."""
        # The method keeps strictly inside; a start on a bound would be moved by it anyway.
        found = optimize.least_squares(
            self.residual,
            np.clip(start, FIT.inside, 1.0 - FIT.inside),
            jac=self.jacobian,
            bounds=(0.0, 1.0),
            xtol=FIT.last,
            ftol=FIT.last,
            gtol=FIT.last,
            max_nfev=200,
        )
        return 2.0 * float(found.cost), self._snapped(np.asarray(found.x))

    def _snapped(self, u: Array) -> Array:
        """Put what the method left a hair inside a bound onto it."""
        return np.where(u < FIT.at_bound, 0.0, np.where(u > 1.0 - FIT.at_bound, 1.0, u))

    def fitted(self, u: Array, chis: tuple[float, ...]) -> Fit:
        """Return the fit at a point."""
        _, result = self.solved(u)
        values = computed(self.case, self.targets, result)
        comparison = Comparison(tuple(map(Deviation, self.targets, values)), result)
        too_far = _too_far(comparison, len(self.parameters))
        jacobian = self.jacobian(u)
        _, sizes, right = np.linalg.svd(jacobian, full_matrices=True)
        full = np.zeros(len(self.parameters))
        full[: len(sizes)] = sizes
        loose = full <= max(FIT.separable * float(full.max(initial=0.0)), FIT.felt)
        known = right[~loose]
        covariance = known.T @ np.diag(full[~loose] ** -2.0) @ known
        names = [p.name for p in self.parameters]
        groups = _groups(right[loose])
        # Elsewhere they may well depend on it: a start in a flat place goes nowhere.
        idle = "Where the search ended, the figures do not depend on" if too_far else ""
        warnings = [
            f"{idle or 'The data do not determine'} {names[group[0]]}."
            if len(group) == 1
            else f"The data cannot tell {', '.join(names[k] for k in group)} apart."
            for group in groups
        ]
        free = np.zeros(len(names), dtype=bool)
        free[[k for group in groups for k in group]] = True
        covariance[free, :] = covariance[:, free] = math.inf
        scale = self.high - self.low
        covariance = covariance * np.outer(scale, scale)
        spread = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore"):
            correlation = covariance / np.outer(spread, spread)
        columns = (self.low, self.high, self.own(), self.numbers(u), spread)
        at_bound = ((u <= 0.0) | (u >= 1.0)).tolist()
        figures = zip(*(column.tolist() for column in columns), at_bound, strict=True)
        unknowns = [Unknown(p, *of) for p, of in zip(self.parameters, figures, strict=True)]
        warnings += [f"{u.parameter.name} is at its bound." for u in unknowns if u.at_bound]
        warnings += too_far
        return Fit(
            case=applied(self.written, self.parameters, self.numbers(u)),
            unknowns=tuple(unknowns),
            covariance=covariance,
            correlation=correlation,
            singular_values=np.asarray(sizes),
            warnings=tuple(warnings),
            comparison=comparison,
            starts=chis,
            evaluations=self.evaluations,
        )


def _too_far(comparison: Comparison, unknowns: int) -> list[str]:
    """Say if χ² is larger than the stated uncertainties make it, but for one time in a thousand."""
    freedom, chi = len(comparison.deviations) - unknowns, comparison.chi_square
    # Where all could be met, what is not met at a bound counts as one figure.
    usual = float(special.chdtri(max(freedom, 1), FIT.improbable))
    if chi <= usual:
        return []
    return [
        f"χ² is {chi:.4g}, above {usual:.3g} for the stated uncertainties: the figures contradict "
        "the case or one another, or further starting points lead to better values. The deviations "
        "of the inputs mean little."
    ]


def _ends(bounds: object) -> list[object]:
    """Ends of a range, which a text may hold as a command takes it, "0 um:100 um"."""
    if isinstance(bounds, str):
        return [*bounds.split(":")]
    return list(bounds) if isinstance(bounds, Iterable) else [bounds]


def _mean(rates: Sensitivity, key: str, position: int, kind: str) -> dict[str, float]:
    """Derivatives by mesh; at a kink the mean of both sides, or the one that exists."""
    sides = [getattr(rates.rates[position, key, side], kind) for side in ("falling", "rising")]
    found = {}
    for mesh in sides[0]:
        known = [s[mesh] for s in sides if not math.isnan(s[mesh])]
        found[mesh] = sum(known) / len(known) if known else 0.0
    return found


def _groups(loose: Array) -> list[list[int]]:
    """Inputs that the data leave open, those together that can make up for each other.

    Parameters
    ----------
    loose : ndarray, shape (k, n)
        Orthonormal directions that change no figure. Their projector, unlike themselves, does not
        depend on how they were chosen.
    """
    from scipy.sparse.csgraph import connected_components

    shared = np.abs(loose.T @ loose)
    # However small its part, an input that has one is not determined: another can move it.
    left_open = np.flatnonzero(np.diag(shared) > FIT.separable**2)
    count, group = connected_components(
        shared[np.ix_(left_open, left_open)] > FIT.separable, directed=False
    )
    return sorted((left_open[group == g].tolist() for g in range(count)), key=max)
