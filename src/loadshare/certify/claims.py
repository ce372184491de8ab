"""Claims of a train at some positions, and the figures of each, computed together.

NumPy takes as long for one claim as for eight, so positions of a result are judged in groups. No
digit of a figure of a certificate depends on the other claims of its group; bounds do depend on the
group, but each of them holds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar, cast

import numpy as np

from loadshare.case.table import Table
from loadshare.certify.bound.judge import bounds
from loadshare.certify.bound.one import Bound
from loadshare.certify.fault import fault_of
from loadshare.certify.floats import FloatPlaces, FloatState
from loadshare.certify.judge import Judge
from loadshare.certify.residuals import FIGURES, Residual, scales, worst_of_each
from loadshare.certify.state import ClaimedState
from loadshare.certify.uniqueness import Uniqueness, uniqueness
from loadshare.certify.validity import Validity
from loadshare.settings import CERTIFY
from loadshare.train.equilibria import Equilibria
from loadshare.train.equilibrium import Equilibrium, Range
from loadshare.train.situations import Situations, situation_of, situations_of
from loadshare.train.train import Train

Derived = TypeVar("Derived")


@dataclass(eq=False, repr=False)
class Claims:
    """Claims of one train, each at a position.

    Parameters
    ----------
    train : Train
    judge : Judge
        The judge of a train of the same shape.
    positions : sequence of int
        1-based.
    answers : Equilibria
    undetermined : sequence of mapping of coordinate to (float, float)
        Coordinates that the forces of each leave undetermined, with their ranges.
    rigorous : bool
        As for `certify`.
    """

    train: Train
    judge: Judge
    positions: Sequence[int]
    answers: Equilibria
    undetermined: Sequence[Mapping[str, Range]]
    rigorous: bool = False
    _derived: dict[Callable[..., Any], Any] = field(default_factory=dict, init=False)

    @classmethod
    def of(cls, train: Train, answers: Sequence[Equilibrium], rigorous: bool = False) -> Claims:
        """Return the claims of some equilibria."""
        claimed = Equilibria.empty(train, len(answers))
        with np.errstate(all="ignore"):
            for row, answer in enumerate(answers):
                claimed.put(row, answer)
        open_ = [answer.undetermined for answer in answers]
        return cls(
            train, Judge(train), [answer.index for answer in answers], claimed, open_, rigorous
        )

    def derived(self, derive: Callable[[Claims], Derived]) -> Derived:
        """Return what a later package derives from the claims; computed once."""
        if derive not in self._derived:
            self._derived[derive] = derive(self)
        return cast("Derived", self._derived[derive])

    @cached_property
    def situations(self) -> Situations:
        """The situation of each claim."""
        if len(self.positions) == 1:
            return situation_of(self.train, self.positions[0])
        return situations_of(self.train, self.positions)

    @cached_property
    def state(self) -> ClaimedState:
        """The mechanical state that is claimed: approaches, forces and graphs."""
        return ClaimedState(self.judge.mechanics, self.situations, self.answers)

    @cached_property
    def faults(self) -> tuple[str, ...]:
        """Why each claim cannot be judged; empty where it can."""
        with np.errstate(all="ignore"):
            return tuple(
                fault_of(self.train, self.state, row) for row in range(len(self.positions))
            )

    @cached_property
    def scales(self) -> list[dict[str, float]]:
        """Scale of every unit, claim by claim."""
        units, sizes = zip(*scales(self.state).items(), strict=True)
        return [
            dict.fromkeys(units, 1.0) if fault else dict(zip(units, row, strict=True))
            for fault, row in zip(self.faults, np.array(sizes).T.tolist(), strict=True)
        ]

    @cached_property
    def residuals(self) -> list[dict[str, Residual]]:
        """Residuals, claim by claim."""
        found: list[dict[str, Residual]] = [{} for _ in self.positions]
        for name, (figures, unit) in FIGURES.items():
            with np.errstate(all="ignore"):
                worst = worst_of_each(figures(self.state), len(found))
            for row, (value, where) in enumerate(worst):
                if self.faults[row]:
                    value, where = math.inf, self.faults[row]
                ratio = value / self.scales[row][unit]
                scaled = math.inf if math.isnan(ratio) else ratio
                found[row][name] = Residual(value, unit, scaled, where)
        return found

    @cached_property
    def rests(self) -> FloatPlaces:
        """Where floats rest."""
        return FloatPlaces(self.state, self.undetermined, CERTIFY.band)

    @cached_property
    def floats(self) -> list[Mapping[str, FloatState]]:
        """Where every float rests, claim by claim."""
        # Claimed numbers may be of any size.
        with np.errstate(all="ignore"):
            gears = self.train.floating if not all(self.faults) else ()
            every = {gear: self.rests.each(gear) for gear in gears}
        return [
            Table({} if fault else {gear: rests[row] for gear, rests in every.items()})
            for row, fault in enumerate(self.faults)
        ]

    @cached_property
    def bounds(self) -> list[Bound]:
        """Bounds on the distance of each claim from the exact equilibrium."""
        found = [Bound.none(self.train) for _ in self.positions]
        every = range(len(found))
        sound = [
            row
            for row in every
            if not self.faults[row] and all(np.isfinite(a[row]).all() for a in self.answers.arrays)
        ]
        if sound:
            here, claims = self.situations, self.answers
            if len(sound) < len(every):
                rows = np.array(sound)
                here, claims = here.take(rows), claims.take(rows)
            together = bounds(self.judge.columns, here, claims, self.rigorous)
            for k, row in enumerate(sound):
                found[row] = Bound.of(together, k)
        return found

    @cached_property
    def validities(self) -> list[Validity]:
        """Whether displacements are small enough for the geometry in which they were found."""
        deflection = np.array([each["m"] for each in self.scales])
        measures = self.judge.measuring.each(self.situations, self.answers, deflection)
        return [Validity(each) for each in measures]

    @cached_property
    def uniquenesses(self) -> list[Uniqueness]:
        """Whether each is proved to be the only answer."""
        return [
            uniqueness(self.train, self.judge.columns, self.state, row)
            for row in range(len(self.positions))
        ]
