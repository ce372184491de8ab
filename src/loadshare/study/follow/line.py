"""A case along one parameter: its numbers and certified equilibria, at many values at once.

Where the parameter's keys may become arrays (`loadshare.train.array_keys`), one machine serves all
values; otherwise every value has a train of its own, written in the units of the first.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from loadshare.array_types import Array, States
from loadshare.case import Case
from loadshare.errors import CaseError, Refused
from loadshare.job.machine import Machine
from loadshare.scene.structure import Structure
from loadshare.settings import CERTIFY
from loadshare.solver.hot import vectorised
from loadshare.study.follow.active import coordinates, read_states
from loadshare.study.follow.numbers import Numbers, structure_like
from loadshare.study.parameter import Parameter, Value, applied, table_of
from loadshare.study.positions import certified
from loadshare.train import Train, build_train
from loadshare.train.placed import train_at
from loadshare.train.samples import Samples, samples_of
from loadshare.train.situations import Situations, situation_of


@dataclass(frozen=True, slots=True, eq=False)
class SolvedValue:
    """A certified equilibrium at a value.

    Attributes
    ----------
    value : float
    states : ndarray of int8, shape (switches,)
        Contact states of all elements.
    x : ndarray, shape (n,)
        Coordinates.
    worst : float
        Worst scaled residual of its certificate.
    """

    value: float
    states: States
    x: Array
    worst: float


@dataclass(frozen=True, slots=True)
class Missing:
    """A value without a point, and why."""

    value: float
    why: str


class Line:
    """A case along a parameter.

    Parameters
    ----------
    case : Case
    parameter : Parameter
    start, stop : float
        Ends of the interval, in the parameter's unit.

    Raises
    ------
    CaseError
        If the case cannot be used with one of the ends.
    """

    def __init__(self, case: Case, parameter: Parameter, start: float, stop: float) -> None:
        self.case, self.parameter = case, parameter
        self._placed: int | None = None
        self.first, self.last = self.train(start), self.train(stop)
        self._samples = self._array_like(start, stop)
        self._known: dict[float, tuple[Train, Structure]] = {}

    def train(self, value: float) -> Train:
        """Build the train at a value."""
        train = build_train(applied(self.case, [self.parameter], [value]))
        return train if self._placed is None else train_at(train, self._placed)

    def at(self, position: int) -> Line:
        """Return the line at a position (1-based): itself, unless each has a train of its own."""
        if not self.first.is_placed_anew:
            return self
        line = copy(self)
        line._placed = position
        line.first, line.last = (train_at(train, position) for train in (self.first, self.last))
        line._known = {}
        return line

    def _array_like(self, start: float, stop: float) -> Samples | None:
        """Return samples that share one machine; None if the parameter changes the machine."""
        table = table_of([self.parameter], np.array([[start], [stop]]))
        groups = samples_of(self.case, table)
        samples = groups[0][1]
        alike = len(groups) == 1 and len(samples.values) == len(samples.columns)
        return samples if alike else None

    def _at(self, values: Array) -> Samples:
        """Return samples at other values of the same keys."""
        assert self._samples is not None
        columns = tuple(replace(column, values=values) for column in self._samples.columns)
        si = values * Value(1.0, self.parameter.unit).factor
        return replace(
            self._samples, columns=columns, values=dict.fromkeys(self._samples.values, si)
        )

    @cached_property
    def machine(self) -> Machine:
        """The machine at the start."""
        machine = Machine(self._samples.train if self._samples is not None else self.first)
        return machine if self._placed is None else machine.at(self._placed)

    @property
    def structure(self) -> Structure:
        """The structure of the machine, in whose units everything is given."""
        return self.machine.structure

    def _own(self, value: float) -> tuple[Train, Structure]:
        """Return train and structure at a value that has a machine of its own."""
        if value not in self._known:
            train = self.train(value)
            self._known[value] = train, structure_like(self.structure, train)
        return self._known[value]

    def numbers(self, position: int, values: Array) -> Numbers:
        """Return the numbers of a position at values (S,)."""
        if self._samples is not None:
            situations = self._at(values).situations(position)
            return Numbers.of(self.structure, situations)
        parts = []
        for value in values.tolist():
            train, structure = self._own(value)
            parts.append(Numbers.of(structure, situation_of(train, position)))
        return Numbers.stacked(parts)

    def solved(self, position: int, values: Array) -> list[SolvedValue | Missing]:
        """Solve and certify a position at values (S,)."""
        if self._samples is not None:
            situations = self._at(values).situations(position)
            return self._answers(self.machine, situations, position, values.tolist())
        found: list[SolvedValue | Missing] = []
        for value in values.tolist():
            try:
                train, structure = self._own(value)
            except (CaseError, ValueError) as problem:
                found.append(Missing(value, str(problem)))
                continue
            machine = Machine(train)
            machine.__dict__["structure"] = structure
            found += self._answers(machine, situation_of(train, position), position, [value])
        return found

    def _answers(
        self, machine: Machine, situations: Situations, position: int, values: list[float]
    ) -> list[SolvedValue | Missing]:
        """Return the answers of a machine, or of a slower method where one is not certified."""
        found = machine.answer(situations, CERTIFY.tolerance, vectorised.settle)
        every: list[SolvedValue | Missing] = []
        for k, value in enumerate(values):
            if not found.passed[k]:
                every.append(self._from_ladder(position, value))
                continue
            one, own = found.equilibria.one(k, 1), situations.take(slice(k, k + 1))
            x, worst = coordinates(machine.structure, own, one), float(found.verdicts.worst[k])
            every.append(SolvedValue(value, found.states[k].copy(), x, worst))
        return every

    def _from_ladder(self, position: int, value: float) -> SolvedValue | Missing:
        """Return the answer of a slower method, with states read from forces and radii."""
        try:
            train = self.train(value)
            answer = certified(train, position)
        except (CaseError, Refused) as refusal:
            return Missing(value, str(refusal))
        structure, found = structure_like(self.structure, train), answer.equilibrium
        situation = situation_of(train, position)
        x, numbers = coordinates(structure, situation, found), Numbers.of(structure, situation)
        states = read_states(structure, numbers, found, x)
        return SolvedValue(value, states, x, answer.certificate.worst)
