"""Inputs of a case that a study varies: which keys, in which unit, over which values."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from loadshare.array_types import Array
from loadshare.case import Case
from loadshare.case.content import ABOUT
from loadshare.case.counts import takes_count
from loadshare.case.keys import Path, dotted, look_up, parse, with_unit
from loadshare.case.quantity import NUMBER, Dimension, as_text
from loadshare.case.units import si_factor
from loadshare.case.words import did_you_mean
from loadshare.errors import CaseError, Problem
from loadshare.settings import ALLOWED

STUDY = "study"
GRID = 'a grid "0 um:12 um:61" (first, last, number), or a list of values with units'
"""The values that a sweep allows, as messages state them."""
RANGE = 'lowest and highest value, as ("0 um", "100 um")'
"""The ends that an interval allows, likewise."""
NO_COUNT = "an input that is not a count"
"""The keys allowed where an input must vary smoothly, likewise."""
OF_COUNTS = "A sweep accepts counts, as a list of values."
"""Hint for a count, where it is not allowed."""
_QUANTITY = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*", re.DOTALL)


@dataclass(frozen=True, slots=True)
class Value:
    """A number and its unit, as a case file writes them.

    Attributes
    ----------
    number : float
        In `unit`.
    unit : str
        As written; empty for a plain number.
    """

    number: float
    unit: str

    @property
    def text(self) -> str | float:
        """The value as a case file writes it; plain whole numbers as integers, as counts are."""
        if self.unit:
            return f"{self.number!r} {self.unit}"
        return int(self.number) if self.number.is_integer() else self.number

    @property
    def si_unit(self) -> str:
        """SI unit of its kind; empty for a plain number."""
        return _si_unit(self.unit)

    @property
    def factor(self) -> float:
        """SI value of one `unit`."""
        return (si_factor(self.unit, self.si_unit) or 1.0) if self.unit else 1.0

    @property
    def si(self) -> float:
        """Value in SI units."""
        return self.number * self.factor

    def at(self, number: float) -> Value:
        """Return another number in the same unit."""
        return Value(float(number), self.unit)

    def in_unit(self, unit: str) -> Value:
        """Return the same value in another unit of its kind.

        Raises
        ------
        ValueError
            If the unit is of another kind.
        """
        if unit == self.unit:
            return self
        factor = si_factor(self.unit, unit) if self.unit and unit else None
        if factor is None:
            raise ValueError(f"{self.text} cannot be expressed in {unit or 'a plain number'}")
        return Value(self.number * factor, unit)


def read_value(given: object) -> Value | None:
    """Return a physical value or a plain number; None if it is neither.

    Parameters
    ----------
    given : object
        A number, a text with a unit, a pint quantity or a `Quantity`.
    """
    given = as_text(given)
    if isinstance(given, bool):
        return None
    if isinstance(given, int | float):
        return Value(float(given), "")
    match = _QUANTITY.fullmatch(given) if isinstance(given, str) else None
    if match is None:
        return None
    number, unit = float(match[1].replace("−", "-")), match[2]
    if not math.isfinite(number):
        return None
    try:
        return Value(number, unit) if not unit or _si_unit(unit) else None
    except ValueError:
        return None


@cache
def _si_unit(unit: str) -> str:
    """Return the SI unit of the kind that `unit` measures; empty if no input is of that kind."""
    from loadshare.case import quantity

    if not unit:
        return ""
    known = [d.unit for d in vars(quantity).values() if isinstance(d, Dimension)]
    return next((si for si in known if si_factor(unit, si) is not None), "")


@dataclass(frozen=True, slots=True)
class Parameter:
    """An input that takes one number at one or more keys of a case.

    Attributes
    ----------
    name : str
        As the user named it.
    keys : tuple of str
        Dotted key paths, all of which take the value.
    unit : str
        Unit of its values; empty for a plain number.
    """

    name: str
    keys: tuple[str, ...]
    unit: str

    @property
    def column(self) -> str:
        """The name with the unit in brackets."""
        return with_unit(self.name, self.unit)

    def text(self, number: float) -> str | float:
        """Return one of its values as a case file writes it."""
        return Value(float(number), self.unit).text

    def changes(self, number: float) -> dict[str, Any]:
        """Return one of its values as the changes that `Case.replace` takes."""
        return dict.fromkeys(self.keys, self.text(number))


def check_apart(parameters: Iterable[Parameter]) -> None:
    """Refuse parameters of a study that set one key twice.

    Raises
    ------
    CaseError
        With the first such key.
    """
    seen: dict[str, str] = {}
    for parameter in parameters:
        for key in parameter.keys:
            if key in seen:
                message = f"is set by {seen[key]} and by {parameter.name}"
                raise _unusable(key, message, "one parameter for each key")
            seen[key] = parameter.name


def check_smooth(parameter: Parameter) -> None:
    """Refuse a parameter that sets a count, for studies that need values in between.

    Raises
    ------
    CaseError
        With the first such key.
    """
    for key in parameter.keys:
        if takes_count(parse(key)):
            message = "is a count: it has no values in between"
            raise _unusable(key, message, NO_COUNT, OF_COUNTS)


def applied(case: Case, parameters: Iterable[Parameter], numbers: Iterable[float]) -> Case:
    """Return the case with the values of several parameters.

    Raises
    ------
    CaseError
        If the case cannot be used with them.
    """
    return case.replace(changes_of(parameters, numbers))


def changes_of(parameters: Iterable[Parameter], numbers: Iterable[float]) -> dict[str, Any]:
    """Return the values of several parameters as the changes that `Case.replace` takes."""
    pairs = zip(parameters, numbers, strict=True)
    return {key: value for p, number in pairs for key, value in p.changes(number).items()}


def table_of(parameters: Iterable[Parameter], values: Array) -> dict[str, Array]:
    """Return values, shape (S, parameters), as `loadshare.solve_many` takes them."""
    columns = zip(parameters, values.T, strict=True)
    return {with_unit(key, p.unit): column for p, column in columns for key in p.keys}


def read_parameter(case: Case, key: str | Sequence[str], unit: str) -> Parameter:
    """Return the parameter that a key, a pattern or several of these stand for.

    Parameters
    ----------
    case : Case
    key : str or sequence of str
        A dotted key path, a pattern in which a star matches any name, keys joined by ``=``, or
        several of these: all the keys take the same value.
    unit : str
        Unit of the values.

    Raises
    ------
    CaseError
        If a text is not a key path, or a pattern matches nothing.
    """
    parts = split_outside(named(key), "=")
    keys = tuple(dict.fromkeys(found for part in parts for found in matches(case, part)))
    return Parameter("=".join(parts), keys, unit)


def named(key: str | Sequence[str]) -> str:
    """Return the name of a parameter with one key or several.

    Raises
    ------
    CaseError
        If it is neither.
    """
    keys = [key] if isinstance(key, str) or not isinstance(key, Iterable) else [*key]
    if not all(isinstance(each, str) for each in keys):
        raise _unusable(str(key), "is not a key path", "a text such as rings.4.float, or several")
    return "=".join(keys)


def matches(case: Case, pattern: str) -> tuple[str, ...]:
    """Return the keys of a case that a pattern matches; a key without a star stands for itself.

    Raises
    ------
    CaseError
        If the text is not a key path, or the pattern matches nothing.
    """
    allowed = "a text such as rings.4.float"
    try:
        wanted = parse(pattern.strip())
    except ValueError:
        raise _unusable(pattern, "is not a key path", allowed) from None
    if " [" in str(wanted[-1]):
        raise _unusable(pattern, "has a unit in its name", "the key alone, and values such as 4 um")
    if wanted[0] in ABOUT:
        raise _unusable(pattern, "describes the case and is not an input", allowed)
    if not any("*" in str(step) for step in wanted):
        return (dotted(wanted),)
    data = case.to_dict()
    found = tuple(dotted(path) for path in _matching(data, wanted, ()))
    if not found:
        known = [dotted(path) for path in leaves(data)]
        raise _unusable(pattern, "matches no key of the case", "", did_you_mean(pattern, known))
    return found


def _matching(data: Any, wanted: Path, above: Path) -> Iterator[Path]:
    """Yield the paths that a pattern matches; a last step without a star need not exist."""
    if len(above) == len(wanted):
        yield above
        return
    here, step = look_up(data, above), wanted[len(above)]
    if "*" not in str(step):
        last = len(above) + 1 == len(wanted)
        if look_up(here, (step,)) is not None or (last and isinstance(here, dict)):
            yield from _matching(data, wanted, (*above, step))
        return
    names: Iterable[str | int] = here if isinstance(here, dict) else ()
    for name in names:
        if fnmatchcase(str(name), str(step)):
            yield from _matching(data, wanted, (*above, name))


def leaves(data: Any, above: Path = ()) -> Iterator[Path]:
    """Yield the path of every value in a case, down to those in tables and lists."""
    if isinstance(data, dict):
        for key, item in data.items():
            if above or key not in ABOUT:
                yield from leaves(item, (*above, key))
    elif isinstance(data, list):
        for number, item in enumerate(data):
            yield from leaves(item, (*above, number))
    else:
        yield above


def grid(given: object, place: str, allowed: str = GRID) -> tuple[tuple[float, ...], str]:
    """Read the values of a parameter.

    Parameters
    ----------
    given : object
        ``"0 um:12 um:61"`` (first, last, how many), or values: physical ones or plain numbers. The
        unit is that of the first value that has one.
    place, allowed : str
        Which key is read, and which values are allowed; for messages.

    Returns
    -------
    tuple of float
        In the unit.
    str
        The unit; empty for plain numbers.

    Raises
    ------
    CaseError
        If the values cannot be read or differ in kind.
    """
    count = 0
    if isinstance(given, str) and ":" in given:
        first, last, *rest = given.split(":")
        items: list[object] = [first, last]
        points = rest[0].strip() if len(rest) == 1 else ""
        if points.isdecimal() and len(points) > len(str(ALLOWED.points)):
            raise too_many(place, points)
        count = int(points) if points.isdecimal() else 0
        if count < 2:
            raise _unusable(place, "needs a number of points of at least 2", allowed, given=given)
    elif isinstance(given, str):
        items = list(given.split(","))
    else:
        unit = getattr(given, "units", None)
        listed = as_text(given) if unit is not None else given
        items = list(listed) if isinstance(listed, Iterable) else [listed]
    shown = given if isinstance(given, str) else ", ".join(map(str, items))
    known: list[Value] = []
    for item in items:
        value = read_value(item)
        if value is None:
            message = f'"{item}" cannot be read: it is not a number with a unit of an input'
            raise _unusable(place, message, allowed, given=shown)
        known.append(value)
    if not known:
        raise _unusable(place, "contains no value", allowed)
    unit = next((v.unit for v in known if v.unit), "")
    if unit and not all(v.unit for v in known):
        bare = next(v for v in known if not v.unit)
        raise _unusable(place, f"{bare.number:g} has no unit", allowed, given=shown)
    try:
        numbers = [v.in_unit(unit).number for v in known]
    except ValueError as error:
        raise _unusable(place, str(error), allowed, given=shown) from None
    if count:
        low, high = numbers
        numbers = [low + (high - low) * k / (count - 1) for k in range(count - 1)] + [high]
    return tuple(numbers), unit


def too_many(place: str, points: object) -> CaseError:
    """Return the error for a grid with more points than a sweep may have."""
    most = f"up to {ALLOWED.points:,} points in all"
    hint = "solve_many and [study] of kind tolerance take any number of samples but keep less"
    return _unusable(place, "is too fine", most, hint, f"{points} points")


def split_outside(text: str, sign: str) -> list[str]:
    """Split a text at a sign outside quotes; the parts are stripped."""
    parts, quote = [""], ""
    for letter in text:
        if letter in "\"'" and quote in ("", letter):
            quote = "" if quote else letter
        if letter == sign and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def _unusable(
    key: str, message: str, allowed: str = "", hint: str = "", given: str = ""
) -> CaseError:
    return CaseError([Problem(STUDY, key, given, message, allowed, hint)])
