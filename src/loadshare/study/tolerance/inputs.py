"""Inputs of a tolerance study: which keys scatter, how, and which of them are correlated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from loadshare.array_types import Array
from loadshare.case import Case, Study
from loadshare.case.counts import takes_count
from loadshare.case.iso1328 import tolerances_of
from loadshare.case.keys import dotted, parse
from loadshare.case.study import CLASS, Group, Spread
from loadshare.errors import CaseError, Problem
from loadshare.settings import TOLERANCE
from loadshare.study.parameter import (
    NO_COUNT,
    OF_COUNTS,
    Parameter,
    changes_of,
    matches,
    split_outside,
    table_of,
)
from loadshare.study.tolerance.distribution import (
    Copula,
    Distribution,
    correlation_matrix,
    read_distribution,
)


@dataclass(frozen=True, slots=True)
class ScatteredInput(Parameter):
    """An input that scatters.

    Attributes
    ----------
    name : str
        Its keys, joined by ``=``.
    keys : tuple of str
        Dotted key paths, which take the same value.
    unit : str
        Unit of its values; empty for a plain number.
    distribution : Distribution
    """

    distribution: Distribution

    @classmethod
    def of(cls, keys: tuple[str, ...], distribution: Distribution) -> ScatteredInput:
        """Return the input of keys that all take one value, drawn from a distribution."""
        return cls("=".join(keys), keys, distribution.unit, distribution)


@dataclass(frozen=True)
class ScatteredInputs:
    """All inputs of a study.

    Attributes
    ----------
    every : tuple of ScatteredInput
    copulas : tuple of Copula
    """

    every: tuple[ScatteredInput, ...]
    copulas: tuple[Copula, ...] = ()

    def values(self, uniforms: Array) -> Array:
        """Return inputs in their units from independent uniforms, both of shape (S, inputs)."""
        for copula in self.copulas:
            uniforms = copula.applied(uniforms)
        columns = [one.distribution.at(uniforms[:, k]) for k, one in enumerate(self.every)]
        return np.stack(columns, axis=1)

    def samples(self, values: Array) -> dict[str, Array]:
        """Return values, shape (S, inputs), as `loadshare.solve_many` takes them."""
        return table_of(self.every, values)

    def changes(self, values: Sequence[float]) -> dict[str, Any]:
        """Return one sample as the changes that `Case.replace` takes."""
        return changes_of(self.every, values)

    @cached_property
    def units(self) -> tuple[tuple[int, ...], ...]:
        """Units that are independent of one another: numbers of a group's inputs, or of one."""
        of = {member: copula.members for copula in self.copulas for member in copula.members}
        return tuple(dict.fromkeys(of.get(k, (k,)) for k in range(len(self.every))))

    @property
    def unit_names(self) -> tuple[str, ...]:
        """Name of each unit."""
        return tuple(" + ".join(self.every[k].name for k in unit) for unit in self.units)

    def to_plain(self) -> dict[str, Any]:
        """Return the inputs as tables, lists, texts and numbers, which `from_plain` takes."""
        return {
            "inputs": [
                {
                    "keys": list(one.keys),
                    "distribution": one.distribution.kind,
                    "numbers": dict(one.distribution.numbers),
                    "unit": one.distribution.unit,
                }
                for one in self.every
            ],
            "groups": [
                {"inputs": list(c.members), "correlation": c.matrix.tolist()} for c in self.copulas
            ],
        }

    @classmethod
    def from_plain(cls, plain: Mapping[str, Any]) -> ScatteredInputs:
        """Return inputs from the plain data of `to_plain`."""
        every = tuple(
            ScatteredInput.of(
                tuple(one["keys"]),
                Distribution(one["distribution"], one["numbers"], one["unit"]),
            )
            for one in plain["inputs"]
        )
        copulas = tuple(
            Copula(tuple(c["inputs"]), np.array(c["correlation"])) for c in plain["groups"]
        )
        return cls(every, copulas)


def read_inputs(case: Case, name: str) -> ScatteredInputs:
    """Read the inputs of a tolerance study, and check the case at their far ends.

    Parameters
    ----------
    case : Case
    name : str
        Name of the study.

    Raises
    ------
    CaseError
        If an input, its distribution or a group cannot be used; all problems are listed.
    """
    reader = _Reader(case, name)
    every = tuple(reader.inputs())
    copulas = tuple(reader.copulas(every))
    if reader.problems:
        raise CaseError(reader.problems)
    return ScatteredInputs(every, copulas)


class _Reader:
    """Reader of inputs and groups, which collects all problems."""

    def __init__(self, case: Case, name: str) -> None:
        self.case = case
        self.path = ("study", name)
        self.block: Study = case.study[name]
        self.problems: list[Problem] = []
        self.bad: set[str] = set()

    def _wrong(
        self, path: tuple[str | int, ...], message: str, allowed: str = "", hint: str = ""
    ) -> None:
        place = dotted((*self.path, *path))
        self.problems.append(self.case.problem(place, message, allowed, hint))

    def _keys(self, path: tuple[str | int, ...], text: str) -> list[tuple[str, ...]]:
        """Return the keys of each input that a text names; those joined by = are one input."""
        try:
            parts = [matches(self.case, part) for part in split_outside(text, "=")]
        except CaseError as error:
            for problem in error.problems:
                self._wrong(path, problem.message, problem.allowed, problem.hint)
            return []
        if len(parts) > 1:
            return [tuple(dict.fromkeys(key for part in parts for key in part))]
        return [(key,) for key in parts[0]]

    def inputs(self) -> Iterator[ScatteredInput]:
        """Yield the inputs that can be used."""
        seen: dict[str, str] = {}
        for text, spread in (self.block.inputs or {}).items():
            path = ("inputs", text)
            by_class = spread.high == CLASS
            one_for_all = None if by_class else self._read(path, spread)
            for keys in self._keys(path, text):
                found = self._read_by_class(path, spread, keys) if by_class else one_for_all
                double = [key for key in keys if key in seen]
                for key in double:
                    message = f"{key} is already drawn by {seen[key]}"
                    self._wrong(path, message, "one distribution for each key")
                seen |= dict.fromkeys(keys, text)
                if found is None:
                    self.bad.update(keys)
                elif not double and self._fits(path, one := ScatteredInput.of(keys, found)):
                    yield one

    def _read(self, path: tuple[str | int, ...], spread: Spread) -> Distribution | None:
        found = read_distribution(spread)
        if isinstance(found, Distribution):
            return found
        for wrong in found:
            self._wrong((*path, *wrong.path), wrong.message, wrong.allowed)
        return None

    def _read_by_class(
        self, path: tuple[str | int, ...], spread: Spread, keys: tuple[str, ...]
    ) -> Distribution | None:
        """Return a distribution whose upper end follows from the tolerance class of a gear."""
        ends = set()
        for key in keys:
            match parse(key):
                case ("errors", gear, "eccentricity", "amount"):
                    tolerances = tolerances_of(self.case.gears[str(gear)])
                    hint = f"gears.{gear} has no tolerance_class with teeth and module."
                case _:
                    tolerances, hint = None, f"{key} does not follow from a tolerance class."
            if tolerances is None:
                allowed = "a value with its unit; or, for eccentricities only, a gear with a class"
                self._wrong((*path, "high"), "cannot be derived", allowed, hint)
                return None
            ends.add(tolerances.runout / 2.0)
        if len(ends) > 1:
            hint = "Drop the equals sign: a star gives each key its own draw."
            self._wrong((*path, "high"), "is not the same for all keys of one draw", hint=hint)
            return None
        return self._read(path, spread.model_copy(update={"high": f"{1e6 * ends.pop()!r} um"}))

    def _fits(self, path: tuple[str | int, ...], one: ScatteredInput) -> bool:
        """Return whether the case can be used at the far ends of an input, and between them."""
        for key in one.keys:
            if takes_count(parse(key)):
                message = f"{key} is a count: it has no values in between"
                self._wrong(path, message, NO_COUNT, OF_COUNTS)
                self.bad.update(one.keys)
                return False
        for end in one.distribution.ends(TOLERANCE.far):
            try:
                self.case.replace(one.changes(end))
            except CaseError as error:
                hint = f"{one.name} was tried with {one.text(end)}."
                if one.distribution.kind == "normal":
                    hint += " A truncated normal distribution stays within limits."
                for problem in error.problems:
                    self._wrong(path, problem.message, problem.allowed, problem.hint or hint)
                self.bad.update(one.keys)
                return False
        return True

    def copulas(self, every: Sequence[ScatteredInput]) -> Iterator[Copula]:
        """Yield the groups that can be used."""
        number = {key: k for k, one in enumerate(every) for key in one.keys}
        taken: set[int] = set()
        for g, group in enumerate(self.block.groups or ()):
            members = self._members(g, group, number)
            if members is None:
                continue
            for k in sorted(taken & set(members)):
                message = f"{every[k].name} is already in another group"
                self._wrong(("groups", g, "inputs"), message, "one group for each input")
            taken |= set(members)
            matrix = correlation_matrix(group.correlation, len(members))
            if isinstance(matrix, str):
                hint = "Keys joined by = take the same value." if "definite" in matrix else ""
                self._wrong(("groups", g, "correlation"), matrix, hint=hint)
            else:
                yield Copula(members, matrix)

    def _members(self, g: int, group: Group, number: Mapping[str, int]) -> tuple[int, ...] | None:
        """Return the numbers of a group's inputs; None if one is not usable."""
        members: list[int] = []
        usable = True
        for i, text in enumerate(group.inputs):
            path = ("groups", g, "inputs", i)
            keys = [key for one in self._keys(path, text) for key in one]
            usable = usable and bool(keys)
            for key in keys:
                if key in number:
                    members.append(number[key])
                    continue
                usable = False
                if key not in self.bad:
                    self._wrong(path, f"{key} is not drawn", "a key of an input of this study")
        return tuple(dict.fromkeys(members)) if usable else None
