"""Questions of a page to workers: read, limited, and cut into parts that are answered in turn."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from loadshare.case import Case
from loadshare.explore.answer import setting_of
from loadshare.explore.inputs import PageInputs
from loadshare.explore.request import RequestError, number, setting, text
from loadshare.settings import ALLOWED, EXPLORE


class Along(NamedTuple):
    """A stretch of an input, at a setting.

    Attributes
    ----------
    case : Case
    keys : tuple of str
        Inputs that take one value.
    low, high : float
        In `unit`.
    unit : str
    points : int
        Number of points of a sweep.
    position : int
        1-based.
    """

    case: Case
    keys: tuple[str, ...]
    low: float
    high: float
    unit: str
    points: int
    position: int

    def text(self, number: float) -> str | float:
        """Return a value as written in a case file."""
        return f"{number!r} {self.unit}" if self.unit else number

    def stretches(self, at: float) -> list[Along]:
        """Return its parts, those around a value first: what happens there is of most interest."""
        count = EXPLORE.stretches
        ends = [self.low + (self.high - self.low) * (k / count) for k in range(count)] + [self.high]
        parts = [self._replace(low=a, high=b) for a, b in pairwise(ends)]
        return sorted(parts, key=lambda part: abs(0.5 * (part.low + part.high) - at))


class Slopes(NamedTuple):
    """Inputs by which a setting is differentiated.

    Attributes
    ----------
    case : Case
    keys : tuple of str
    reaches : tuple of float
        Changes of the inputs by which their effects are compared, in their own units.
    position : int
        1-based.
    """

    case: Case
    keys: tuple[str, ...]
    reaches: tuple[float, ...]
    position: int

    def batches(self) -> Iterator[Slopes]:
        """Yield its parts, in the order in which the page asks."""
        for first in range(0, len(self.keys), EXPLORE.batch):
            part = slice(first, first + EXPLORE.batch)
            yield self._replace(keys=self.keys[part], reaches=self.reaches[part])


def along(inputs: PageInputs, body: Mapping[str, Any]) -> Along:
    """Return the stretch of an input that a page asks for.

    Raises
    ------
    RequestError
        If the request does not give one.
    CaseError
        If a key or the setting cannot be used.
    """
    keys = inputs.keys(text(body, "name"))
    low, high = (finite(body, end) for end in ("low", "high"))
    if not 0.0 < high - low < math.inf:
        raise RequestError(400, f"low {low:g} and high {high:g} are not the ends of a range")
    return Along(
        with_keys_written(inputs, keys, setting(body)),
        keys,
        low,
        high,
        inputs.every[keys[0]].unit,
        number(body, "points", EXPLORE.points, 2, EXPLORE.most_points),
        place(body),
    )


def slopes(inputs: PageInputs, body: Mapping[str, Any]) -> Slopes:
    """Return the inputs by which a page wants to differentiate; raises as `along` does."""
    wanted = body.get("keys")
    if not isinstance(wanted, list) or not 0 < len(wanted) <= EXPLORE.keys:
        raise RequestError(400, f"keys is not a list of 1 to {EXPLORE.keys} inputs")
    keys = tuple(dict.fromkeys(key for name in wanted for key in inputs.keys(str(name))))
    reaches = tuple(0.1 * (inputs.every[key].high - inputs.every[key].low) for key in keys)
    return Slopes(with_keys_written(inputs, keys, setting(body)), keys, reaches, place(body))


def with_keys_written(inputs: PageInputs, keys: Sequence[str], given: Mapping[str, object]) -> Case:
    """Return the case of a setting with some keys written out, so that they can be varied.

    An error that the case lacks, or gives by components, has no size and direction until then.
    """
    return setting_of(inputs, {key: inputs.every[key].text for key in keys} | {**given})


def place(body: Mapping[str, Any]) -> int:
    """Return the position of a request."""
    return number(body, "position", 1, 1, ALLOWED.positions)


def finite(body: Mapping[str, Any], name: str, default: float = math.nan) -> float:
    """Return a number of a request."""
    given = body.get(name, default)
    if isinstance(given, bool) or not isinstance(given, int | float) or not math.isfinite(given):
        raise RequestError(400, f"{name} is not a number")
    return float(given)
