"""A case along one parameter: its numbers at many values at once, its certified equilibria.

Where the parameter's keys become arrays (`loadshare.train.array_keys`) one machine does for all
values; otherwise every value is a train of its own, written in the units of the first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from loadshare.case import Case
from loadshare.case.keys import parse
from loadshare.certify.tolerance import TOLERANCE
from loadshare.contact.radial import RadialLaw
from loadshare.errors import CaseError, Refused
from loadshare.job.machine import Answers, Machine
from loadshare.scene import assemble
from loadshare.scene.data import Data, data_of
from loadshare.scene.elements import Elements, elements_of
from loadshare.scene.scene import Array, Scene
from loadshare.solver.hot import places as at
from loadshare.solver.hot import vectorised
from loadshare.study.answers import certified
from loadshare.study.branch.active import Place, coordinates, read_set
from loadshare.study.branch.units import Units
from loadshare.study.parameter import Parameter, Value
from loadshare.train import Train, build_train
from loadshare.train.columns import Column
from loadshare.train.equilibria import Equilibria
from loadshare.train.samples import Samples, samples_of
from loadshare.train.situations import Situations, situation_of

Codes = NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """What the equations of a machine consist of at S values, in the units of its elements.

    Attributes
    ----------
    vectors : ndarray, shape (S or 1, m, n)
        A.
    load, gap, bending, hertz : ndarray, shape (S or 1, n), (S or 1, m) ...
        f, g, b, c; see `loadshare.scene.data.Data`.
    tables : ndarray, shape (S or 1, tables, 2, points)
    nominal, shift, clearance : ndarray, shape (S or 1, arcs, 3), (S or 1, arcs, 3), (S or 1, arcs)
    relative : ndarray, shape (S or 1, arcs, 3, n)
    radial : ndarray, shape (S or 1, radials, 6)
    carried : ndarray, shape (S or 1, radials, m)
    """

    vectors: Array
    load: Array
    gap: Array
    bending: Array
    hertz: Array
    tables: Array
    nominal: Array
    shift: Array
    clearance: Array
    relative: Array
    radial: Array
    carried: Array

    def take(self, rows: NDArray[np.intp] | slice) -> Numbers:
        """Return the numbers at some of the values."""
        every = {f.name: getattr(self, f.name) for f in fields(self)}
        return Numbers(**{k: v[rows] if len(v) > 1 else v for k, v in every.items()})


def numbers_of(elements: Elements, data: Data) -> Numbers:
    """Collect the numbers of a machine."""
    return Numbers(
        vectors=elements.vectors[None],
        load=data.load,
        gap=data.gap,
        bending=data.bending,
        hertz=data.hertz,
        tables=data.tables,
        nominal=data.nominal[None],
        shift=data.shift,
        clearance=data.clearance,
        relative=data.relative[None],
        radial=data.radial,
        carried=data.carried[None],
    )


def _stacked(parts: Sequence[Numbers]) -> Numbers:
    names = [f.name for f in fields(Numbers)]
    return Numbers(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in names})


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """A certified equilibrium at a value.

    Attributes
    ----------
    value : float
    code : ndarray of int8, shape (switches,)
        Which elements act, and where radial elements stand.
    x : ndarray, shape (n,)
        Coordinates.
    worst : float
        Worst scaled residual of its certificate.
    """

    value: float
    code: Codes
    x: Array
    worst: float


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
        self.first, self.last = self.train(start), self.train(stop)
        self._samples = self._array_like(start, stop)
        self._known: dict[float, tuple[Train, Elements]] = {}

    def train(self, value: float) -> Train:
        """Build the train at a value."""
        return build_train(self.parameter.applied(self.case, value))

    def _array_like(self, start: float, stop: float) -> Samples | None:
        """Samples that share one machine; None where the parameter changes the machine."""
        unit = f" [{self.parameter.unit}]" if self.parameter.unit else ""
        table = {f"{key}{unit}": [start, stop] for key in self.parameter.keys}
        groups = samples_of(self.case, table)
        samples = groups[0][1]
        alike = len(groups) == 1 and len(samples.values) == len(samples.columns)
        return samples if alike else None

    def _at(self, values: Array) -> Samples:
        """Samples at other values of the same keys."""
        assert self._samples is not None
        unit = self.parameter.unit
        columns = tuple(Column(parse(key), unit, values) for key in self.parameter.keys)
        known = {c.path: c for c in columns}
        factor = Value(1.0, unit)
        si = dict.fromkeys(self._samples.values, values * factor.factor)
        return replace(
            self._samples, columns=tuple(known[c.path] for c in self._samples.columns), values=si
        )

    @cached_property
    def machine(self) -> Machine:
        """The machine at the start."""
        return Machine(self._samples.train if self._samples is not None else self.first)

    @property
    def elements(self) -> Elements:
        """Its elements, in whose units everything is told."""
        return self.machine.elements

    @property
    def scene(self) -> Scene:
        """A scene, for names."""
        return self.elements.scene

    def _own(self, value: float) -> tuple[Train, Elements]:
        """Train and elements at a value that makes a machine of its own."""
        if value not in self._known:
            train = self.train(value)
            base = self.elements
            mine = elements_of(assemble(train, 1))
            if mine.kinds != base.kinds or mine.scene.coordinates != base.scene.coordinates:
                raise ValueError("the parameter changes which elements there are")
            self._known[value] = train, replace(mine, force=base.force, length=base.length)
        return self._known[value]

    def numbers(self, position: int, values: Array) -> Numbers:
        """Return the numbers of a position at values (S,)."""
        if self._samples is not None:
            situations = self._at(values).situations(position)
            return numbers_of(self.elements, data_of(self.elements, situations))
        parts = []
        for value in values.tolist():
            train, elements = self._own(value)
            parts.append(numbers_of(elements, data_of(elements, situation_of(train, position))))
        return _stacked(parts)

    def solved(self, position: int, values: Array) -> list[Solved | str]:
        """Solve and certify a position at values (S,).

        Returns
        -------
        list of Solved or str
            Why there is no answer, where there is none.
        """
        if self._samples is not None:
            situations = self._at(values).situations(position)
            found = self.machine.answer(situations, TOLERANCE, vectorised.settle)
            return [
                self._from_batch(self.scene, found, k, value)
                if found.passed[k]
                else self._from_ladder(position, value)
                for k, value in enumerate(values.tolist())
            ]
        return [self._one(position, value) for value in values.tolist()]

    def _one(self, position: int, value: float) -> Solved | str:
        try:
            train, elements = self._own(value)
        except (CaseError, ValueError) as problem:
            return str(problem)
        machine = Machine(train)
        machine.__dict__["elements"] = elements
        situations: Situations = situation_of(train, position)
        found = machine.answer(situations, TOLERANCE, vectorised.settle)
        if not found.passed[0]:
            return self._from_ladder(position, value)
        return self._from_batch(elements.scene, found, 0, value)

    def _from_batch(self, scene: Scene, found: Answers, k: int, value: float) -> Solved:
        x = _coordinates(scene, found.equilibria, k) / self.elements.length
        return Solved(value, found.code[k].copy(), x, float(found.verdicts.worst[k]))

    def _from_ladder(self, position: int, value: float) -> Solved | str:
        """Answer of the slower ways, its set read from forces and radii."""
        try:
            train = self.train(value)
            answer = certified(train, position)
        except (CaseError, Refused) as refusal:
            return str(refusal)
        scene = assemble(train, position)
        units = Units(self.elements.force, self.elements.length)
        active, *_ = read_set(scene, answer.equilibrium, units)
        code = np.zeros(self.elements.switches, dtype=np.int8)
        for k, name in enumerate(self.elements.row_names):
            code[k] = at.CLOSED if name in active.closed else at.OPEN
        flanks = answer.equilibrium.flank_force
        for j, (radial, (_, place)) in enumerate(zip(scene.radials, active.places, strict=True)):
            law = radial.law(train.transmitted(radial.gear, flanks))
            code[self.elements.rows + j] = _code_of(place, law)
        x = coordinates(scene, answer.equilibrium) / self.elements.length
        return Solved(value, code, x, answer.certificate.worst)


def _coordinates(scene: Scene, found: Equilibria, k: int) -> Array:
    """Coordinates x [m] of an answer of a batch."""
    names = found.names
    x = np.zeros(scene.size)
    for g, gear in enumerate(names.gears):
        turn, where = scene.rotation[gear], scene.displacement.get(gear)
        if turn.index is not None:
            x[turn.index] = (found.rotation[k, g] - turn.constant) / turn.rate
        if where is not None:
            x[where] = names.train.gears[gear].frame @ found.displacement[k, g]
    return x


def _code_of(place: Place, law: RadialLaw) -> int:
    """Code of a place on a radial graph."""
    if place.corner and not place.piece:
        return at.WALL if law.reach > 0.0 else at.PINNED
    first = place.piece == law.pieces[0].name
    if place.corner:
        return at.PINNED if first else at.CORNER
    if place.piece == "stick":
        return at.STICK
    if place.piece in ("slip", "inside"):
        return at.SLIP if law.pieces[0].force > 0.0 or not first else at.OPEN
    return at.STOP
