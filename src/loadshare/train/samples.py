"""Samples of a case: inputs that vary from sample to sample, as situations of one train.

If only keys that become arrays vary (see `array_keys`), one train serves all samples. Otherwise
samples are grouped by the values of the other keys, and every group has a train of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from loadshare import case as spec
from loadshare.array_types import Array, Flags, Numbers
from loadshare.case.element import Element, fields_by_key
from loadshare.case.keys import Path, dotted
from loadshare.case.recent import Recent
from loadshare.errors import CaseError
from loadshare.settings import JOB
from loadshare.tooth import with_own_laws
from loadshare.train.alike import train_alike
from loadshare.train.array_keys import array_unit
from loadshare.train.build import build_train, train_of, with_laws
from loadshare.train.columns import Column, columns_of
from loadshare.train.geometry import Geometry, geometry_of
from loadshare.train.placed import train_at
from loadshare.train.pressed import pressed_flanks
from loadshare.train.situations import Situations, situations_of, stack
from loadshare.train.train import Train


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples that share a machine.

    Attributes
    ----------
    case : Case
        The case with the first sample's values; it supplies whatever no column gives.
    geometry : Geometry
    train : Train
        Built from that case.
    columns : tuple of Column
        All varying keys, with S values each.
    values : mapping of Path to ndarray, shape (S,)
        SI values of the keys that become arrays.
    """

    case: spec.Case
    geometry: Geometry
    train: Train
    columns: tuple[Column, ...]
    values: Mapping[Path, Array]

    @property
    def count(self) -> int:
        """S."""
        return len(self.columns[0].values)

    def one(self, sample: int) -> spec.Case:
        """Return a sample as a case."""
        return self.case.replace({dotted(c.path): c.text(sample) for c in self.columns})

    def train_of_one(self, sample: int) -> Train:
        """Return the train of a sample alone.

        Raises
        ------
        CaseError
            If the sample cannot be made into a train.
        """
        case = self.one(sample)
        return train_alike(case, (self.case, self.geometry, self.train)) or build_train(case)

    def take(self, rows: Numbers | slice) -> Samples:
        """Return some of the samples."""
        if isinstance(rows, slice) and len(range(*rows.indices(self.count))) == self.count:
            return self
        columns = tuple(replace(c, values=c.values[rows]) for c in self.columns)
        return replace(self, columns=columns, values={p: v[rows] for p, v in self.values.items()})

    def situations(self, index: int) -> Situations:
        """Return the situations at position `index` (1-based) of all samples."""
        found = situations_of(train_at(self._varied, index), index)
        return replace(found, train=train_at(self.train, index), count=self.count)

    def at_positions(self, positions: Sequence[int]) -> Situations:
        """Return the situations of all samples at several positions, one after another.

        Only one position is allowed for a train that is placed anew at every position.
        """
        if self._varied is self.train and not self.train.is_placed_anew:
            return situations_of(self.train, positions)
        return stack([self.situations(index) for index in positions])

    def build(self) -> Train:
        """Return the train whose numbers are those of all samples.

        Raises
        ------
        CaseError
            If a sample cannot be made into a train.
        """
        return self._varied

    @cached_property
    def _varied(self) -> Train:
        return train_of(_with(self.case, self.values), self.geometry, (self.case, self.train))


def samples_of(case: spec.Case, samples: Mapping[str, ArrayLike]) -> list[tuple[Numbers, Samples]]:
    """Turn a table of samples into groups that share a machine.

    Parameters
    ----------
    case : Case
    samples : mapping of str to array_like
        See `columns_of`.

    Returns
    -------
    list of (ndarray of int, Samples)
        Numbers of the samples of a group, and the group.

    Raises
    ------
    CaseError
        If a key or a value cannot be used; the smallest and the largest value of every key are
        checked like any other input.
    """
    return groups_of(case, columns_of(samples))


def groups_of(case: spec.Case, columns: Sequence[Column]) -> list[tuple[Numbers, Samples]]:
    """Turn samples, read as columns, into groups; see `samples_of`."""
    case = with_own_laws(case, (c.path for c in columns))
    first = case.replace({dotted(c.path): c.text(0) for c in columns})
    units = {c.path: u for c in columns if (u := array_unit(first, c)) is not None}
    arrays = {c.path: c.in_si(units[c.path]) for c in columns if c.path in units}
    _check(case, columns, arrays)
    others = [c for c in columns if c.path not in arrays]
    groups = []
    parts = _groups(others, len(columns[0].values))
    while parts:
        rows = parts.pop(0)
        whole = len(rows) == len(columns[0].values)
        some = slice(None) if whole else rows
        mine = tuple(replace(c, values=c.values[some]) for c in columns)
        own = first if rows[0] == 0 else first.replace({dotted(c.path): c.text(0) for c in mine})
        base = with_laws(own)
        geometry, train = _built(case, base)
        values = {path: si[some] for path, si in arrays.items()}
        alike = _pressed_alike(base, geometry, values, len(rows))
        if not alike.all():
            # The others press other flanks than the first, and become groups of their own.
            parts[:0] = [rows[alike], rows[~alike]]
            continue
        group = Samples(base, geometry, train, mine, values)
        if len(rows) == 1:
            # Its train is that of the only sample.
            group.__dict__["_varied"] = train
        groups.append((rows, group))
    return groups


_recent: Recent[tuple[spec.Case, Geometry, Train]] = Recent()


def _built(case: spec.Case, base: spec.Case) -> tuple[Geometry, Train]:
    """Return geometry and train of a sample, reusing what it shares with a recent one."""
    known = _recent.of(case)
    train = None if known is None else train_alike(base, known)
    if known is not None and train is not None:
        return known[1], train
    geometry = geometry_of(base)
    return _recent.keep(case, (base, geometry, train_of(base, geometry)))[1:]


def _pressed_alike(
    case: spec.Case, geometry: Geometry, values: Mapping[Path, Array], count: int
) -> Flags:
    """Return whether each sample presses the flanks that the geometry has, (count,)."""
    loads = {path: si for path, si in values.items() if path[0] == "operating"}
    alike = np.ones(count, dtype=bool)
    if loads and count > 1:
        found = pressed_flanks(_with(case, loads), geometry.gears, geometry.period)
        for name, pair in geometry.pairs.items():
            alike &= found[name].named_backwards == pair.named_backwards
            alike &= found[name].flank_uncertain == pair.flank_uncertain
    return alike


def _with(part: Any, values: Mapping[Path, Any]) -> Any:
    """Return a part of a case with arrays [SI] in place of the numbers at some key paths."""
    if () in values:
        return (
            spec.Quantity(part.text, values[()]) if isinstance(part, spec.Quantity) else values[()]
        )
    below: dict[str | int, dict[Path, Any]] = {}
    for path, array in values.items():
        below.setdefault(path[0], {})[path[1:]] = array
    if isinstance(part, Element):
        named = fields_by_key(type(part))
        names = {named[str(step)]: inner for step, inner in below.items()}
        changes = {name: _with(getattr(part, name), inner) for name, inner in names.items()}
        # The own `model_copy` of a case refuses changes, which nobody would check.
        return Element.model_copy(part, update=changes)
    if isinstance(part, Mapping):
        return {**part, **{step: _with(part[step], inner) for step, inner in below.items()}}
    return tuple(_with(v, below[k]) if k in below else v for k, v in enumerate(part))


def _check(case: spec.Case, columns: Sequence[Column], arrays: Mapping[Path, Array]) -> None:
    """Apply the checks of case files to the extreme values of every array key.

    Values of other keys are checked with the groups that they form.
    """
    parts, judged = [np.arange(len(columns[0].values))], 0
    while parts:
        rows, judged = parts.pop(), judged + 1
        try:
            for pick in (np.argmin, np.argmax):
                at = {path: int(rows[pick(values[rows])]) for path, values in arrays.items()}
                # The first sample has been checked already.
                if any(at.values()):
                    others = int(rows[0])
                    case.replace({dotted(c.path): c.text(at.get(c.path, others)) for c in columns})
        except CaseError:
            # A combination of extremes may fail that no sample has: check smaller parts.
            if len(rows) == 1 or judged > JOB.extremes:
                raise
            parts += np.array_split(rows, 2)[::-1]


def unusable(case: spec.Case, samples: Mapping[str, ArrayLike]) -> Iterator[tuple[int, CaseError]]:
    """Yield which samples make no train, counted from 0, and why; in order, each when asked for.

    Parameters
    ----------
    case : Case
    samples : mapping of str to array_like
        See `columns_of`.
    """
    table = {column.key: np.asarray(column.values) for column in columns_of(samples)}

    def judge(rows: Numbers) -> Iterator[tuple[int, CaseError]]:
        try:
            for _, group in samples_of(case, {key: values[rows] for key, values in table.items()}):
                group.build()
        except CaseError as error:
            if len(rows) == 1:
                yield int(rows[0]), error
            else:
                for half in np.array_split(rows, 2):
                    yield from judge(half)

    yield from judge(np.arange(len(next(iter(table.values())))))


def _groups(columns: Sequence[Column], count: int) -> list[Numbers]:
    """Return groups of rows that have the same values in all of these columns."""
    if not columns:
        return [np.arange(count)]
    codes = np.stack([np.unique(c.values, return_inverse=True)[1] for c in columns], axis=1)
    _, which = np.unique(codes, axis=0, return_inverse=True)
    which = which.reshape(-1)
    order = np.argsort(which, kind="stable")
    return np.split(order, np.cumsum(np.bincount(which))[:-1])
