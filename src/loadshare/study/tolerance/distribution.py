"""How inputs scatter: distributions by their quantile functions, and the Gaussian copula."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from loadshare.array_types import Array
from loadshare.case.element import Rule
from loadshare.case.study import NUMBERS, Spread
from loadshare.libraries import special, stats
from loadshare.settings import TOLERANCE
from loadshare.study.parameter import Value, read_value

PHASE = "uniform phase"
TURN = Value(360.0, "deg")


@dataclass(frozen=True)
class Distribution:
    """The distribution of one input.

    Attributes
    ----------
    kind : str
        "normal", "truncated normal", "uniform", "rayleigh" or "uniform phase".
    numbers : mapping of str to float
        Parameters of the kind, in `unit`.
    unit : str
        Of its values; empty for a plain number.
    """

    kind: str
    numbers: Mapping[str, float]
    unit: str

    @cached_property
    def frozen(self) -> Any:
        """The distribution as an object of scipy.stats."""
        of: dict[str, Callable[..., Any]] = {
            "normal": lambda mean, deviation: stats.norm(mean, deviation),
            "truncated normal": lambda mean, deviation, low, high: stats.truncnorm(
                (low - mean) / deviation, (high - mean) / deviation, mean, deviation
            ),
            "uniform": lambda low, high: stats.uniform(low, high - low),
            "rayleigh": lambda scale: stats.rayleigh(scale=scale),
            PHASE: lambda: stats.uniform(0.0, TURN.number),
        }
        return of[self.kind](**self.numbers)

    def at(self, probability: Array) -> Array:
        """Return the quantiles of the probabilities."""
        return np.asarray(self.frozen.ppf(probability))

    @property
    def periodic(self) -> bool:
        """Whether its two ends are the same state of the machine."""
        return self.kind == PHASE

    def ends(self, tail: float = TOLERANCE.tail) -> tuple[float, float]:
        """Return both ends; in place of an infinite one, the quantile that leaves `tail` beyond."""
        low, high = (float(end) for end in self.frozen.support())
        inner = self.at(np.array([tail, 1.0 - tail]))
        return (
            low if np.isfinite(low) else float(inner[0]),
            high if np.isfinite(high) else float(inner[1]),
        )

    def __str__(self) -> str:
        numbers = ", ".join(f"{k} {v:.6g}" for k, v in self.numbers.items())
        return f"{self.kind} {numbers} {self.unit}" if numbers else self.kind


def read_distribution(spread: Spread) -> Distribution | list[Rule]:
    """Read a distribution from a case's table, or list what is wrong with it.

    Parameters
    ----------
    spread : Spread

    Returns
    -------
    Distribution or list of Rule
    """
    names = NUMBERS[spread.distribution]
    values: dict[str, Value] = {}
    wrong: list[Rule] = []
    for name in names:
        value = read_value(getattr(spread, name))
        if value is None:
            allowed = 'a value with its unit, as in "20 um"'
            wrong.append(Rule("cannot be read", (name,), allowed))
        else:
            values[name] = value
    if wrong:
        return wrong
    unit = next((v.unit for v in values.values() if v.unit), "" if names else TURN.unit)
    numbers: dict[str, float] = {}
    for name, value in values.items():
        try:
            numbers[name] = value.in_unit(unit).number
        except ValueError as error:
            wrong.append(Rule(str(error), (name,)))
    found = Distribution(spread.distribution, numbers, unit)
    return wrong or list(_unsound(found)) or found


def _unsound(found: Distribution) -> Iterator[Rule]:
    numbers = found.numbers
    for name in ("deviation", "scale"):
        if name in numbers and not numbers[name] > 0.0:
            yield Rule("is not positive", (name,))
            return
    if "low" in numbers and not numbers["low"] < numbers["high"]:
        yield Rule("is not above low", ("high",))
    elif found.kind == "truncated normal":
        # Far out in a tail the quantile function has no digits left.
        nearest = max(numbers["low"] - numbers["mean"], numbers["mean"] - numbers["high"], 0.0)
        if nearest > 8.0 * numbers["deviation"]:
            allowed = "limits that include some of the distribution within 8 deviations of the mean"
            yield Rule("has its limits too far from its mean", allowed=allowed)
        elif numbers["high"] - numbers["low"] < 1e-9 * numbers["deviation"]:
            # The share of the normal distribution between them has no digits left.
            allowed = "at least 1e-9 deviations apart; or a uniform distribution, which is the same"
            yield Rule("has its limits too close together for its deviation", allowed=allowed)


@dataclass(frozen=True, eq=False)
class Copula:
    """Inputs whose normal scores are correlated.

    Each input keeps its own distribution. For two normal inputs the correlation of the scores is
    that of the inputs; in general their rank correlation is 6/π asin(ρ/2).

    Attributes
    ----------
    members : tuple of int
        Numbers of the inputs.
    matrix : ndarray, shape (n, n)
        Correlations of the scores, positive definite.
    """

    members: tuple[int, ...]
    matrix: Array

    @cached_property
    def factor(self) -> Array:
        """Lower Cholesky factor."""
        return np.asarray(np.linalg.cholesky(self.matrix), dtype=float)

    def applied(self, uniforms: Array) -> Array:
        """Return uniforms, shape (S, inputs), with those of the members correlated."""
        columns = list(self.members)
        scores = special.ndtri(uniforms[:, columns])
        # Term by term: a product of matrices could round differently for another number of rows.
        mixed = np.zeros_like(scores)
        for i in range(len(columns)):
            for j in range(i + 1):
                mixed[:, i] += self.factor[i, j] * scores[:, j]
        result = uniforms.copy()
        result[:, columns] = special.ndtr(mixed)
        return result


def correlation_matrix(given: float | Sequence[Sequence[float]], size: int) -> Array | str:
    """Return a correlation matrix, or what is wrong with it.

    Parameters
    ----------
    given : float or rows of floats
        One correlation for all pairs, or the matrix.
    size : int
        Number of inputs.

    Returns
    -------
    ndarray, shape (size, size), or str
    """
    if size < 2:
        return "refers to a single input, but a correlation needs two"
    if isinstance(given, int | float):
        matrix = np.full((size, size), float(given))
        np.fill_diagonal(matrix, 1.0)
    else:
        if [len(row) for row in given] != [size] * size:
            return f"is not a matrix of {size} rows with {size} numbers each"
        matrix = np.array(given, dtype=float)
        if not np.array_equal(matrix, matrix.T):
            return "is not symmetric"
        if not (np.diag(matrix) == 1.0).all():
            return "does not have ones on its diagonal"
    smallest = float(np.linalg.eigvalsh(matrix)[0])
    if smallest < TOLERANCE.definite:
        return f"is not positive definite: its smallest eigenvalue is {smallest:.3g}"
    return matrix
