"""What a page may change in a case: its numbers, and errors of gears by size and direction.

No key on the list names a file, so no path can come from a page.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from loadshare.case import Case
from loadshare.case.content import Content
from loadshare.case.counts import dimension_of
from loadshare.case.described import about
from loadshare.case.keys import Path, dotted, look_up, parse
from loadshare.errors import CaseError, Problem
from loadshare.settings import EXPLORE
from loadshare.study.parameter import Value, leaves, matches, read_value, split_outside
from loadshare.train import build_train
from loadshare.train.gear import Vector

PAGE = "page"
"""Stands in for the file in messages about what a page asks for."""
VECTORS = {
    "installation": ("amount", "direction"),
    "eccentricity": ("amount", "direction", "phase"),
}
"""Errors by size and direction, and the parts of each."""
ANGLES = ("direction", "phase")
"""Last steps of keys that are angles over a whole turn: they have a dial."""
ZERO = {"m": 1e-4, "N": 1e3, "N*m": 100.0, "rad": 1e-2, "K": 50.0}
"""Reach of a slider whose input is zero [SI], by unit; 1 in the input's own unit for others."""
FITTING = ("m", "rad", "")
"""SI units of the quantities that make gears fit."""
COARSE = 1e-3
"""Lengths from here on are geometry, which has to fit: their sliders have a small reach [m]."""


@dataclass(frozen=True, slots=True)
class PageInput:
    """One number that a page may change; a page is given its attributes in this order.

    Attributes
    ----------
    key : str
        Dotted key path.
    text : str or float or int
        As given in the case; for an error that it does not have, a value without effect.
    number : float
        Value in `unit`.
    unit : str
        Empty for a plain number.
    low, high, step : float
        Ends and step of its slider, in `unit`.
    whole : bool
        Whether it is a count.
    turning : bool
        Whether it is an angle over a whole turn, such as a direction.
    about : str
        Description.
    assumed : bool
    geometry : bool
        Whether it is a count or one of the lengths and angles that make the gears fit: no
        tolerance study varies it.
    """

    key: str
    text: str | float
    number: float
    unit: str
    low: float
    high: float
    step: float
    whole: bool
    turning: bool
    about: str
    assumed: bool
    geometry: bool


@dataclass(frozen=True)
class PageInputs:
    """All that a page may change in a case.

    Attributes
    ----------
    case : Case
    """

    case: Case

    @cached_property
    def data(self) -> dict[str, Any]:
        """The case as plain data."""
        return self.case.to_dict()

    @cached_property
    def every(self) -> dict[str, PageInput]:
        """Inputs by key, in the order of the case file; then errors that it does not have."""
        found: dict[str, PageInput] = {}
        for path in leaves(self.data):
            if self._vector_of(path) is None:
                one = self._read(path, look_up(self.data, path))
                if one is not None:
                    found[one.key] = one
        for path, table in self._tables.items():
            for part, given in table.items():
                one = self._read((*path, part), given)
                if one is not None:
                    found[one.key] = one
        return found

    def keys(self, name: str) -> tuple[str, ...]:
        """Return the keys that a name means: a key, a pattern with a star, several joined by ``=``.

        Raises
        ------
        CaseError
            If one of them is no input, or they are of different kinds.
        """
        found: dict[str, None] = {}
        for part in split_outside(name, "="):
            found |= dict.fromkeys((part,) if part in self.every else matches(self.case, part))
        known = [self.every[key] for key in found if key in self.every]
        if not known or len(known) < len(found):
            message = "is not a number of the case"
            raise CaseError([Problem(PAGE, name, "", message, "an input from the list")])
        if len({Value(1.0, one.unit).si_unit for one in known}) > 1:
            raise CaseError([Problem(PAGE, name, "", "ties inputs of different kinds")])
        return tuple(found)

    def changes(self, given: Mapping[str, object]) -> dict[str, Any]:
        """Return the changes that a page asks for, as `Case.replace` takes them.

        Parameters
        ----------
        given : mapping of str to object
            A text with a unit, or a plain number, by key.

        Raises
        ------
        CaseError
            If a key is no input, or a value neither a text nor a number.
        """
        found: dict[str, Any] = {}
        problems = []
        for key, value in given.items():
            if key not in self.every:
                problems.append(Problem(PAGE, key, "", "is not an input", "an input from the list"))
            elif isinstance(value, bool) or not isinstance(value, str | int | float):
                allowed = "a number with its unit"
                problems.append(Problem(PAGE, key, "", "is not a value", allowed))
            elif isinstance(value, str) and len(value) > EXPLORE.text:
                problems.append(Problem(PAGE, key, value[:20] + "…", "is too long for a value"))
            else:
                path = parse(key)
                above = self._vector_of(path)
                if above is None:
                    found[key] = value
                    continue
                whole = dotted(above)
                table = found.setdefault(whole, dict(self._tables[above]))
                table[str(path[-1])] = value
        if problems:
            raise CaseError(problems)
        return found

    @cached_property
    def _tables(self) -> dict[Path, dict[str, str]]:
        return dict(self._vectors())

    @cached_property
    def _planes(self) -> dict[str, Vector]:
        """Unit vectors across the axes of the gears, from which directions count."""
        try:
            return {name: gear.plane for name, gear in build_train(self.case).gears.items()}
        except CaseError:
            return {}

    def _vector_of(self, path: Path) -> Path | None:
        """Return the path of the error by size and direction that holds a key, else None."""
        return path[:3] if path[:3] in self._tables else None

    def _vectors(self) -> Iterator[tuple[Path, dict[str, str]]]:
        """Yield errors by size and direction; those that a gear lacks but may have are zero."""
        absent = {}
        for gear in self.case.gears:
            for kind, parts in VECTORS.items():
                path: Path = ("errors", gear, kind)
                given = look_up(self.data, path)
                if isinstance(given, list):
                    if len(given) > 2:
                        continue
                    plane = self._planes.get(gear)
                    if plane is None:
                        continue
                    given = _polar(given, plane)
                table = {part: "0 um" if part == "amount" else "0 deg" for part in parts}
                if given is None:
                    absent[path] = table
                else:
                    yield path, table | {k: str(v) for k, v in given.items()}
        yield from self._possible(absent)

    def _possible(self, absent: dict[Path, dict[str, str]]) -> Iterator[tuple[Path, Any]]:
        """Yield those errors that the case may have; its checks name those that it may not."""
        while absent:
            trial = {dotted(p): table | {"amount": "1 um"} for p, table in absent.items()}
            try:
                self.case.replace(trial)
            except CaseError as error:
                wrong = [problem.key for problem in error.problems]
                left = {p: t for p, t in absent.items() if not _concerns(wrong, dotted(p))}
                absent = left if len(left) < len(absent) else {}
            else:
                yield from absent.items()
                return

    def _read(self, path: Path, given: object) -> PageInput | None:
        value = read_value(given)
        if value is None or (isinstance(given, str) and not value.unit):
            return None
        whole, turning = isinstance(given, int), value.unit != "" and path[-1] in ANGLES
        low, high = _reach(path, value, turning)
        return PageInput(
            key=dotted(path),
            text=given if isinstance(given, str | int | float) else str(given),
            number=value.number,
            unit=value.unit,
            low=low,
            high=high,
            step=1.0 if whole else _step(high - low),
            whole=whole,
            turning=turning,
            about=about(Content, path),
            assumed=self.case.is_assumed(dotted(path)),
            geometry=whole or (path[0] == "gears" and value.si_unit in FITTING),
        )


def _concerns(wrong: Iterable[str], key: str) -> bool:
    return any(one == key or one.startswith(f"{key}.") for one in wrong)


def _polar(given: list[Any], plane: Vector) -> dict[str, str]:
    """Return components along x and y as size and direction in a plane, in the unit of the first.

    The component along the axis has no effect.
    """
    x, y = (read_value(part) for part in given)
    assert x is not None
    assert y is not None
    across = plane[:, :2] @ (x.number, y.in_unit(x.unit).number)
    amount, direction = float(np.hypot(*across)), math.degrees(math.atan2(*across[::-1]))
    return {"amount": f"{amount!r} {x.unit}", "direction": f"{direction!r} deg"}


def _reach(path: Path, value: Value, turning: bool) -> tuple[float, float]:
    """Return the ends of a slider, around the input and within its bounds."""
    number, factor, dimension = value.number, value.factor, dimension_of(path)
    if turning:
        turn = round(2.0 * math.pi / factor, 6)
        low = -0.5 * turn if number <= 0.5 * turn else 0.0
        return low, low + turn
    unit = value.si_unit
    if number == 0.0:
        reach = ZERO.get(unit, factor) / factor
        low, high = -reach, reach
    elif unit == "rad" or (unit == "m" and abs(value.si) >= COARSE) or "shape" in path:
        room = 0.02 * abs(number)
        low, high = number - room, number + room
    else:
        low, high = sorted((0.0, _round_up(2.0 * number)))
    if dimension is not None and dimension.at_least is not None:
        low = max(low, dimension.at_least / factor)
    if dimension is not None and dimension.above is not None and low <= dimension.above / factor:
        low = dimension.above / factor + 0.05 * abs(number)
    if low >= high:
        high = low + abs(low or 1.0)
    # From a multiple of the step on, so that a slider stops at round values.
    step = _step(high - low)
    low = min(math.ceil(low / step - 1e-9) * step, number)
    return float(f"{low:.12g}"), float(f"{high:.12g}")


def _round_up(number: float) -> float:
    """Return the next number away from zero that has one or two digits."""
    size = 10.0 ** (math.floor(math.log10(abs(number))) - 1)
    return math.copysign(math.ceil(round(abs(number) / size, 6)) * size, number)


def _step(width: float) -> float:
    """Return the largest round step that gives a slider at least a thousand steps."""
    size = 10.0 ** math.floor(math.log10(width / EXPLORE.steps))
    step = next(k * size for k in (5.0, 2.0, 1.0) if k == 1.0 or k * size <= width / EXPLORE.steps)
    return float(f"{step:.12g}")
