"""What was made of the last few cases, for those who solve them again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Generic, TypeVar

from loadshare.case.model import Case
from loadshare.settings import JOB

Made = TypeVar("Made")


class Recent(Generic[Made]):
    """What was made of the last few cases: of a case itself, not of one that says the same."""

    def __init__(self) -> None:
        # Replaced as a whole: other threads may be looking.
        self._made: tuple[tuple[Case, object, Made], ...] = ()

    def __iter__(self) -> Iterator[Made]:
        """What was made, the last first."""
        return (made for _, _, made in self._made)

    def of(self, case: Case | None, what: object = None) -> Made | None:
        """Return what was made of a case; None where it is not known.

        Parameters
        ----------
        case : Case or None
        what : object
            To distinguish it from what else was made of it.
        """
        return next((m for c, w, m in self._made if c is case and w == what), None)

    def keep(self, case: Case, made: Made, what: object = None) -> Made:
        """Keep what was made of a case, and return it."""
        self._made = ((case, what, made), *self._made)[: JOB.recent]
        return made
