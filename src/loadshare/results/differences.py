"""Comparison of two documents leaf by leaf: a file with what was computed again."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from loadshare.case.keys import Path
from loadshare.case.words import as_given

ROUND_OFF = 1e-12
"""Difference, over the largest figure of its kind, that another processor or library may cause:
some thousand times the last digit, for figures that are sums of larger ones."""
DIGITS = 1e-9
"""Difference, over the figure itself, that counts as round-off: figures far below the largest of
their kind have lost some digits, but not nine."""
JUDGED = ("certificate", "residuals")
"""Figures of a certificate, which are themselves round-off and differ on another machine: those in
a file are for readers only, and those computed again take their place."""


def differences(
    expected: Any,
    found: Any,
    names: frozenset[str] = frozenset(),
    least: Mapping[Path, float] | None = None,
) -> Iterator[tuple[Path, str, str, str]]:
    """Yield where two documents differ by more than round-off.

    Parameters
    ----------
    expected, found : plain data
        Tables, lists, texts, numbers, truth values, None.
    names : frozenset of str
        Keys that name elements: figures under such keys are of one kind.
    least : mapping of key path to float, optional
        Sizes of the figures from which those of a kind are computed; the latter may be smaller.

    Yields
    ------
    tuple of (key path, str, str, str)
        The key, what was found there, what is wrong with it, what was expected.
    """
    # On the machine that wrote a file every digit agrees, and comparing text is faster.
    if json.dumps(expected) == json.dumps(found):
        return
    sizes = dict(least or {})
    _measure(expected, (), names, sizes)
    yield from _compare(expected, found, (), names, sizes)


def _kind(path: Path, names: frozenset[str]) -> Path:
    return tuple(step for step in path if isinstance(step, str) and step not in names)


def _measure(data: Any, path: Path, names: frozenset[str], sizes: dict[Path, float]) -> None:
    """Record the largest figure of every kind in `sizes`."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            _measure(value, (*path, key), names, sizes)
    elif isinstance(data, list):
        for at, value in enumerate(data):
            _measure(value, (*path, at), names, sizes)
    elif isinstance(data, float):
        kind = _kind(path, names)
        sizes[kind] = max(abs(data), sizes.get(kind, 0.0))


def _compare(
    expected: Any, found: Any, path: Path, names: frozenset[str], sizes: dict[Path, float]
) -> Iterator[tuple[Path, str, str, str]]:
    if isinstance(expected, Mapping) and isinstance(found, Mapping):
        for key, value in expected.items():
            if key in found:
                yield from _compare(value, found[key], (*path, key), names, sizes)
            else:
                yield (*path, key), "", "is missing", _text(value)
        for key in found:
            if key not in expected:
                yield (*path, key), "", "is not known", ""
    elif isinstance(expected, list) and isinstance(found, list):
        if len(expected) != len(found):
            yield path, f"{len(found)} entries", "does not agree", f"{len(expected)} entries"
        for at, (one, other) in enumerate(zip(expected, found, strict=False)):
            yield from _compare(one, other, (*path, at), names, sizes)
    elif not _agree(expected, found, path, names, sizes):
        message = "does not follow from the case and the claims of this file"
        yield path, _text(found), message, _text(expected)


def _agree(
    expected: Any, found: Any, path: Path, names: frozenset[str], sizes: dict[Path, float]
) -> bool:
    if isinstance(expected, float) and isinstance(found, int | float):
        if isinstance(found, bool):
            return False
        if _is_judged(path):
            return True
        allowed = DIGITS * abs(expected) + ROUND_OFF * sizes[_kind(path, names)]
        # A difference to a whole number beyond the range of doubles would overflow.
        return expected - allowed <= found <= expected + allowed
    if isinstance(expected, str) and isinstance(found, str) and _is_judged(path):
        return True
    return type(expected) is type(found) and bool(expected == found)


def _is_judged(path: Path) -> bool:
    return len(path) > 2 and path[0] == "positions" and path[2] in JUDGED


def _text(value: Any) -> str:
    if value is None:
        return "null"
    return "a table" if isinstance(value, Mapping) else as_given(value)
