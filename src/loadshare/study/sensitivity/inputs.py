"""Inputs with respect to which a case can be differentiated: its numbers except counts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from loadshare.case import Case
from loadshare.case.counts import takes_count
from loadshare.case.keys import Path, dotted, look_up, parse
from loadshare.case.revise import nearest
from loadshare.case.words import did_you_mean
from loadshare.errors import CaseError, Problem
from loadshare.study.parameter import STUDY, Value, leaves, matches, read_value, split_outside
from loadshare.study.sensitivity.result import Input

KEY = "an input that the case gives"


def inputs_of(case: Case, wanted: str | Sequence[str] | None) -> list[Input]:
    """Return the inputs asked for; by default all numbers except counts.

    Parameters
    ----------
    case : Case
    wanted : str or sequence of str, optional
        Key paths or patterns, as `sensitivity` takes them.

    Raises
    ------
    CaseError
        If an input matches nothing in the case; all problems are listed.
    """
    data = case.to_dict()
    if wanted is None:
        return _without_twins(_below(data, ()))
    inputs: list[Input] = []
    problems = []
    one = isinstance(wanted, str) or not isinstance(wanted, Iterable)
    for pattern in [wanted] if one else wanted:
        if not isinstance(pattern, str) or len(split_outside(pattern, "=")) > 1:
            hint = "Derivatives by several keys with the same value add up."
            problems.append(Problem(STUDY, str(pattern), "", "is not one key", KEY, hint))
            continue
        keys = matches(case, pattern)
        found = [item for key in keys for item in _numbers_at(data, key)]
        if not found:
            there = [value for key in keys if (value := look_up(data, parse(key))) is not None]
            counts = there and all(takes_count(parse(key)) for key in keys)
            what = "is not a number with a unit" if there else "is not in the case"
            what = "is a count: it has no derivatives" if counts else what
            shown = str(there[0]) if len(keys) == 1 and there else ""
            hint = did_you_mean(pattern, (item.key for item in _below(data, ())))
            if not there and "*" not in pattern:
                hint = hint or nearest(data, parse(pattern))
            problems.append(Problem(STUDY, pattern, shown, what, KEY, hint))
        inputs += found
    if problems:
        raise CaseError(problems)
    return _without_twins(dict.fromkeys(inputs))


def twin_of(key: str) -> str | None:
    """Return the key of the entry across the diagonal of a support, which must be the same.

    Parameters
    ----------
    key : str
        Of a number.
    """
    match parse(key):
        case ("gears", name, "support", int(row), int(column)) if row != column:
            return dotted(("gears", name, "support", column, row))
    return None


def _without_twins(inputs: Iterable[Input]) -> list[Input]:
    """Leave out inputs that vary with an earlier one."""
    found: dict[str, Input] = {}
    for item in inputs:
        if twin_of(item.key) not in found:
            found[item.key] = item
    return list(found.values())


def _numbers_at(data: object, key: str) -> list[Input]:
    """Return the number at a key, or all numbers below it."""
    path = parse(key)
    given = look_up(data, path)
    if isinstance(given, dict | list):
        return _below(given, path)
    value = _number(given)
    return [] if value is None else [Input(key, value)]


def _below(data: object, above: Path) -> list[Input]:
    """Return all numbers of a table or list except counts."""
    found = []
    for path in leaves(data):
        value = _number(look_up(data, path))
        if value is not None:
            found.append(Input(dotted((*above, *path)), value))
    return found


def _number(given: object) -> Value | None:
    """Return a physical value or a plain number; None for counts and names."""
    if isinstance(given, int):
        return None
    value = read_value(given)
    return None if value is None or (isinstance(given, str) and not value.unit) else value
