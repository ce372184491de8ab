"""Objects made from the last few cases, kept in case these are solved again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Generic, TypeVar

from loadshare.case.model import Case
from loadshare.settings import JOB

Made = TypeVar("Made")


class Recent(Generic[Made]):
    """Objects made from the last few cases, found by identity of the case, not by equality."""

    def __init__(self) -> None:
        # Replaced as a whole: other threads may be reading it.
        self._made: tuple[tuple[Case | None, object, Made], ...] = ()

    def __iter__(self) -> Iterator[Made]:
        """Iterate over the objects, the newest first."""
        return (made for _, _, made in self._made)

    def of(self, case: Case | None, what: object = None) -> Made | None:
        """Return the object made from a case; None if it is not kept.

        Parameters
        ----------
        case : Case or None
        what : object
            Distinguishes several objects made from one case, or from none.
        """
        return next((m for c, w, m in self._made if c is case and w == what), None)

    def keep(self, case: Case | None, made: Made, what: object = None) -> Made:
        """Keep an object made from a case, or from something else, and return it."""
        self._made = ((case, what, made), *self._made)[: JOB.recent]
        return made
