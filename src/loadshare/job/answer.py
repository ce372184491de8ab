"""Answers: certified equilibria, and how they were found."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

from loadshare.certify import Certificate
from loadshare.certify.validity import Measure, Validity, refusal_text
from loadshare.errors import Refused
from loadshare.later import known
from loadshare.results.result import Effort
from loadshare.scene import assemble
from loadshare.scene.scene import Scene
from loadshare.solver import Record
from loadshare.train.equilibrium import Equilibrium
from loadshare.train.train import Train
from loadshare.view import View, Viewed


@dataclass(frozen=True, eq=False, repr=False)
class Answer(Viewed):
    """An equilibrium that is certified.

    Its forces are known. Displacements that the forces leave open, the figures of its certificate
    and how it was found are computed when they are first read.

    Attributes
    ----------
    train : Train
    index : int
        1-based position.
    rung : str
        Rung of the ladder that answered.
    flank_force : mapping of flank to float
        [N].
    find : callable
        Returns the equilibrium at its place of least norm, and its certificate.
    how : callable
        Returns plan, passes of the outer loop, and what was left out.
    small : bool
        Whether its displacements are known to be below the limits of a refusal.
    """

    train: Train
    index: int
    rung: str
    flank_force: Mapping[str, float]
    find: Callable[[], tuple[Equilibrium, Certificate]]
    how: Callable[[], Record]
    small: bool = False

    @classmethod
    def of(
        cls,
        train: Train,
        equilibrium: Equilibrium,
        certificate: Certificate,
        record: Record,
        rung: str,
    ) -> Answer:
        """Return an answer of which all parts are known."""
        return cls(
            train,
            equilibrium.index,
            rung,
            equilibrium.flank_force,
            known((equilibrium, certificate)),
            known(record),
        )

    def _said(self) -> object:
        return self.rung, self.equilibrium, self.certificate

    @cached_property
    def _found(self) -> tuple[Equilibrium, Certificate]:
        return self.find()

    @property
    def equilibrium(self) -> Equilibrium:
        """The equilibrium, at its place of least norm."""
        return self._found[0]

    @property
    def certificate(self) -> Certificate:
        """Its certificate."""
        return self._found[1]

    @cached_property
    def record(self) -> Record:
        """Plan, passes of the outer loop, and what was left out."""
        return self.how()

    @property
    def effort(self) -> Effort:
        """How it was found, in short."""
        record = self.record
        return Effort(self.rung, record.method, record.kind, len(record.iterations), record.rounds)

    @property
    def scene(self) -> Scene:
        """The contact problem, assembled again."""
        return assemble(self.train, self.index)

    @property
    def validity(self) -> Validity:
        """Whether its displacements are small enough for the geometry in which it was found."""
        return self.certificate.claims.validities[self.certificate.row]

    def refused(self) -> Refused | None:
        """Return the refusal for its displacements; None if they are not refused."""
        beyond = {} if self.small else self.validity.refused
        return refusal_of(self.index, beyond) if beyond else None

    def _view(self) -> View:
        from loadshare.job.views import answer_view

        return answer_view(self)


def refusal_of(index: int, beyond: Mapping[str, Measure]) -> Refused:
    """Return the refusal of a position (1-based) whose displacements are beyond their bounds."""
    text = f"position {index}: {refusal_text(beyond)}"
    return Refused(text, {name: m.value for name, m in beyond.items()})
