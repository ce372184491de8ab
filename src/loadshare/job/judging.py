"""The certificate of samples that are being solved, renewed where their answers change."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from loadshare.array_types import Flags
from loadshare.certify import Judge, Verdicts
from loadshare.scene.structure import Structure
from loadshare.solver.hot.answer import equilibria
from loadshare.solver.hot.iterate import Iterate
from loadshare.train.equilibria import Equilibria
from loadshare.train.situations import Situations


@dataclass(eq=False, repr=False)
class Judging:
    """Answers of samples, and the certificate's verdicts on them.

    Parameters
    ----------
    structure : Structure
    judge : Judge
    situations : Situations
    iterate : Iterate
        Iterate of the samples, from which answers follow.
    tolerance : float
        Largest scaled residual of a certified answer.
    compiled : bool
        See `Judge.judge`.

    Attributes
    ----------
    answers : Equilibria
        Set once they have been judged.
    """

    structure: Structure
    judge: Judge
    situations: Situations
    iterate: Iterate
    tolerance: float
    compiled: bool
    answers: Equilibria = field(init=False)
    _verdicts: Verdicts | None = field(default=None, init=False)

    def renewed(self, rows: Flags, bounded: bool = True) -> Verdicts:
        """Judge samples that have changed, the first time all; return the verdicts on all.

        If `bounded`, errors are bounded with every effort, otherwise only where that takes no time
        (see `Judge.judge`).
        """
        if self._verdicts is None:
            self.answers = self._answers(self.situations, self.iterate)
            self._verdicts = self._judged(self.situations, self.answers, bounded)
        elif rows.any():
            some = np.flatnonzero(rows)
            situations = self.situations.take(some)
            answers = self._answers(situations, self.iterate.take(some))
            self.answers.put_all(some, answers)
            verdicts = self._judged(situations, answers, bounded)
            self._verdicts = self._verdicts.replaced(some, verdicts)
        return self._verdicts

    def _answers(self, situations: Situations, iterate: Iterate) -> Equilibria:
        return equilibria(self.structure, situations, iterate, self.compiled)

    def _judged(self, situations: Situations, answers: Equilibria, bounded: bool) -> Verdicts:
        return self.judge.judge(
            situations, answers, self.tolerance, compiled=self.compiled, bounded=bounded
        )
