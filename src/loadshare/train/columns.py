"""A table of samples as the user gives it: columns of values by key path."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from loadshare.array_types import Array
from loadshare.case.keys import Path, dotted, parse, with_unit
from loadshare.case.quantity import as_text
from loadshare.case.units import si_factor
from loadshare.case.words import as_given
from loadshare.errors import CaseError, Problem
from loadshare.numbers import counted

_UNIT = re.compile(r"(?P<key>.*\S)\s+\[(?P<unit>[^\]]*)\]")


class SampleTable(Protocol):
    """Anything with named columns: a mapping or a data frame."""

    def items(self) -> Iterable[tuple[Any, Any]]:
        """Return names and values."""


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """Values of one key.

    Attributes
    ----------
    path : tuple of str or int
        The key.
    unit : str
        Unit of the values; empty for bare numbers.
    values : ndarray, shape (S,)
        Numbers, or texts for a key that takes words.
    """

    path: Path
    unit: str
    values: NDArray[np.generic]

    @property
    def key(self) -> str:
        """The key with the unit, as a table of samples has it."""
        return with_unit(dotted(self.path), self.unit)

    @property
    def has_numbers(self) -> bool:
        """Whether the values are numbers, not texts."""
        return self.values.dtype.kind in "fiu"

    @property
    def is_positive(self) -> bool:
        """Whether the values are numbers, and all above zero."""
        return self.has_numbers and bool((self.values.astype(np.float64) > 0.0).all())

    def text(self, sample: int) -> str | float:
        """Return a sample's value as a case file has it, a whole number as an integer."""
        value = self.values[sample].item()
        if self.unit:
            return f"{value!r} {self.unit}"
        # From 2⁵³ on every float is whole, which then does not suggest a count.
        count = isinstance(value, float) and value.is_integer() and abs(value) < 2.0**53
        return int(value) if count else value

    def in_si(self, unit: str) -> Array:
        """Return the values (S,) in an SI unit; an empty unit is that of bare numbers.

        Raises
        ------
        CaseError
            If a text is not a value with a unit of that kind.
        """
        if self.has_numbers:
            factor = si_factor(self.unit, unit) if unit else 1.0
            assert factor is not None
            return self.values.astype(np.float64) * factor
        from pydantic_core import PydanticCustomError

        from loadshare.case.quantity import Dimension

        reader = Dimension(unit, f"a value in {unit}", f"1 {unit}")
        found = np.empty(len(self.values))
        for sample, text in enumerate(map(str, self.values)):
            try:
                found[sample] = reader.read(text)
            except PydanticCustomError as error:
                about = error.context or {}
                message, allowed = about.get("message", str(error)), about.get("allowed", "")
                problem = Problem("samples", dotted(self.path), as_given(text), message, allowed)
                raise CaseError([problem]) from error
        return found


def columns_of(samples: SampleTable) -> list[Column]:
    """Read a table of samples.

    Parameters
    ----------
    samples : mapping of str to array_like, or data frame
        Values by key path, all of one length. The unit is in brackets after the key, as in
        ``"rings.4.float [um]"``; texts with their units, as in a case file, are allowed as well.

    Raises
    ------
    CaseError
        If lengths differ, or a key is not a key path or is given twice; all problems are listed.
    """
    columns: list[Column] = []
    problems = []
    if not hasattr(samples, "items"):
        message, allowed = "is not a table of values by key", "a mapping or a data frame"
        raise CaseError([Problem("samples", "", "", message, allowed)])
    for name, given in samples.items():
        key = str(name)
        match = _UNIT.fullmatch(key)
        text, unit = (match["key"], match["unit"]) if match else (key, "")
        try:
            path = parse(text)
        except ValueError:
            problems.append(Problem("samples", key, "", "is not a key path"))
            continue
        column = Column(path, unit, _values(given))
        fault = _fault(column, columns)
        if fault:
            problems.append(Problem("samples", key, "", fault))
        else:
            columns.append(column)
    if not columns and not problems:
        problems.append(Problem("samples", "", "", "there is no key", "at least one key"))
    if problems:
        raise CaseError(problems)
    return columns


def _values(given: object) -> NDArray[np.generic]:
    """Return values as an array of numbers or of texts, or of objects if they are neither."""
    if isinstance(given, np.ma.MaskedArray | Iterator):
        # NumPy would take the masked values of a masked array; `tolist` makes them None.
        given = given.tolist() if isinstance(given, np.ma.MaskedArray) else list(given)
    if isinstance(given, list | tuple) and not all(isinstance(v, int | float | str) for v in given):
        given = [as_text(value) for value in given]
    try:
        values = np.atleast_1d(np.asarray(as_text(given)))
        if values.dtype.kind == "O" and values.ndim == 1:
            # Numbers mixed with texts, as a data frame may hold them, or physical values.
            return np.array([as_text(value) for value in values])
    except ValueError:
        # Lists of different lengths.
        return np.array([[]], dtype=object)
    return values.astype(np.float64) if values.dtype.kind == "f" else values


def _fault(column: Column, before: list[Column]) -> str:
    """Return what is wrong with a column, given those before it; empty if nothing is."""
    values = column.values
    if values.ndim != 1:
        number = f"{dotted(column.path)}[0]"
        return f"is not a list of values; in a list, each number has its own key, as in {number}"
    if not len(values):
        return "contains no value"
    if before and len(values) != len(before[0].values):
        return f"has {counted(len(values))}, but the keys before it have {len(before[0].values)}"
    if any(other.path == column.path for other in before):
        return "is given twice"
    if values.dtype.kind not in "fiubU":
        return "contains something that is neither a number nor a text"
    if column.unit and not column.has_numbers:
        return "has a unit, but its values are not numbers"
    if column.has_numbers and not np.isfinite(values.astype(float)).all():
        return "contains a value that is not finite"
    return ""
