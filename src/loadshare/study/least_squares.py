"""The least-squares problem of a fit, with exact sensitivities."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.case.keys import look_up, parse
from loadshare.errors import CaseError, Problem
from loadshare.job import solve
from loadshare.libraries import optimize, qmc
from loadshare.results import Result
from loadshare.settings import FIT
from loadshare.study.compare import Target, computed, needed, slope, targets
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
from loadshare.study.sensitivity import SIDES, Sensitivity, sensitivity
from loadshare.study.sensitivity.inputs import twin_of
from loadshare.tooth import with_own_laws


class LeastSquares:
    """The least-squares problem of a fit, with unknowns scaled to [0, 1] between their bounds."""

    def __init__(self, case: Case, unknowns: Mapping[Any, Sequence[object] | str]) -> None:
        names = list(map(named, unknowns))
        # Laws that no unknown affects are computed once; in the fitted case they remain computed
        # from the teeth.
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
                raise CaseError([Problem(STUDY, named(key), given, "is not a range", RANGE)])
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

    def bounds_error(self) -> CaseError | None:
        """Return an error that names every bound which on its own gives no valid case, or None."""
        problems: list[Problem] = []
        for parameter, *ends in zip(self.parameters, self.low, self.high, strict=True):
            for end in map(float, ends):
                try:
                    applied(self.case, [parameter], [end])
                except CaseError as error:
                    hint = f"The bound {parameter.text(end)} of the fit does not give a valid case."
                    problems += [replace(p, hint=p.hint or hint) for p in error.problems]
        return CaseError(problems) if problems else None

    def starting_points(self, count: int, seed: int) -> list[Array]:
        """Return the scaled values of `own`, then Sobol points."""
        points = [(self.own() - self.low) / (self.high - self.low)]
        if count > 1:
            power = math.ceil(math.log2(count))
            sampler = qmc.Sobol(len(self.parameters), seed=seed)
            points += list(sampler.random_base2(power))[: count - 1]
        return points

    def own(self) -> Array:
        """Return the case's own values; the middle of the bounds if one is not between them."""
        data, found = self.case.to_dict(), np.array((self.low + self.high) / 2)
        for k, parameter in enumerate(self.parameters):
            value = read_value(look_up(data, parse(parameter.keys[0])))
            with suppress(ValueError):
                number = math.nan if value is None else value.in_unit(parameter.unit).number
                found[k] = number if self.low[k] <= number <= self.high[k] else found[k]
        return found

    def numbers(self, u: Array) -> Array:
        """Return the values of the unknowns at a scaled point."""
        return np.asarray(self.low + np.clip(u, 0.0, 1.0) * (self.high - self.low))

    def solved(self, u: Array) -> tuple[Case, Result]:
        """Return the case and its certified result at a point; the last ones are kept."""
        key = u.tobytes()
        if self._last is None or self._last[0] != key:
            case = applied(self.case, self.parameters, self.numbers(u))
            self._last = (key, case, solve(case, positions=self.positions))
            self.evaluations += 1
        return self._last[1], self._last[2]

    def residual(self, u: Array) -> Array:
        """Return computed less measured figures, in standard deviations."""
        _, result = self.solved(u)
        found = np.array(computed(self.case, self.targets, result))
        return np.asarray((found - self.measured) / self.spread)

    def jacobian(self, u: Array) -> Array:
        """Return the derivative of the residual with respect to the scaled unknowns.

        At a kink it is the mean of both sides.
        """
        return np.asarray(self.slopes(u).mean(axis=0))

    def slopes(self, u: Array) -> Array:
        """Return the derivatives for falling and for rising unknowns, which differ at a kink.

        Where the derivative to one side does not exist, that to the other stands in its place.
        """
        case, result = self.solved(u)
        # An entry of a support varies with its twin, so one of the two is enough.
        keys = [
            [key for n, key in enumerate(p.keys) if twin_of(key) not in p.keys[:n]]
            for p in self.parameters
        ]
        rates = sensitivity(case, [k for some in keys for k in some], positions=self.positions)
        sides = [
            [sum(self._column(rates, result, key, side) for key in some) for some in keys]
            for side in SIDES
        ]
        scale = self.high - self.low
        return np.asarray(np.array(sides).swapaxes(1, 2) / self.spread[:, None] * scale)

    def _column(self, rates: Sensitivity, result: Result, key: str, side: str) -> Array:
        """Return the derivatives of the figures with respect to one key, per unit of its value."""
        factor = next(item.value.factor for item in rates.inputs if item.key == key)
        rate = partial(_rates, rates, key, side)
        return factor * np.array([slope(t, result, rate) for t in self.targets])

    def descend(self, start: Array) -> tuple[float, Array]:
        """Minimise from a starting point; return the χ² and the point reached."""
        # The method stays strictly inside the bounds and would move a start on a bound anyway.
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
        # Values that it left just inside a bound are on it.
        u = np.where(found.x < FIT.at_bound, 0.0, found.x)
        return 2.0 * float(found.cost), np.where(u > 1.0 - FIT.at_bound, 1.0, u)


def _ends(bounds: object) -> list[object]:
    """Return the ends of a range, which may be a text as on the command line, "0 um:100 um"."""
    if isinstance(bounds, str):
        return [*bounds.split(":")]
    return list(bounds) if isinstance(bounds, Iterable) else [bounds]


def _rates(rates: Sensitivity, key: str, side: str, position: int, kind: str) -> dict[str, float]:
    """Return derivatives by mesh to one side, or to the other where that does not exist, or 0."""
    own, other = (
        getattr(rates.rates[position, key, s], kind) for s in (side, *(set(SIDES) - {side}))
    )
    found = {}
    for mesh, here in own.items():
        known = other[mesh] if math.isnan(here) else here
        found[mesh] = 0.0 if math.isnan(known) else known
    return found
