"""How a solve can end without an answer, and how much work it may do."""

from __future__ import annotations

import math
from dataclasses import dataclass


class Unsolved(RuntimeError):  # noqa: N818 -- a finding, not a fault
    """A programme has no answer, or none was found; the message says which."""


@dataclass(slots=True)
class StepBudget:
    """Newton steps that exact solves may still take in the search for one answer."""

    left: float = math.inf
    whole: StepBudget | None = None

    def half(self) -> StepBudget:
        """Return half of what is left, so that one who never arrives leaves some to the others."""
        return StepBudget(self.left / 2, self)

    def step(self) -> None:
        """Count one step.

        Raises
        ------
        Unsolved
            If none is left.
        """
        if self.left <= 0:
            raise Unsolved("no consistent active set was found in the steps allowed")
        self.left -= 1
        if self.whole is not None:
            self.whole.step()
