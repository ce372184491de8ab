"""The exceptions of `loadshare`, and the problems a case can have."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

LONGEST = 400
"""Most characters of a key in a message: more than any allowed key has."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a case, in words that let its author correct it.

    Parameters
    ----------
    file : str
        The file that contains the offending key.
    key : str
        Dotted path of the key, as in ``meshes."4-6".stiffness``; empty for the file as a whole.
    given : str
        The present value, as text; empty if there is none.
    message : str
        What is wrong with it, without a full stop.
    allowed : str
        What is allowed instead.
    hint : str
        A whole sentence that helps, such as a did-you-mean.
    """

    file: str
    key: str
    given: str
    message: str
    allowed: str = ""
    hint: str = ""

    def __str__(self) -> str:
        key = self.key if len(self.key) <= LONGEST else f"{self.key[:LONGEST]}…"
        place = " = ".join(part for part in (key, self.given) if part)
        parts = [f"{': '.join(part for part in (self.file, place, self.message) if part)}."]
        if self.allowed:
            parts.append(f"Allowed: {self.allowed}" + ("." if self.allowed[-1] != "…" else ""))
        if self.hint:
            parts.append(self.hint)
        return " ".join(parts)


class LoadshareError(Exception):
    """Base of every error that `loadshare` raises on purpose."""


class CaseError(LoadshareError):
    """A case that cannot be used, with everything that is wrong with it.

    Parameters
    ----------
    problems : iterable of Problem
        All problems found.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__(self.problems)

    def __str__(self) -> str:
        return "\n".join(map(str, self.problems))


class Refused(LoadshareError):  # noqa: N818 -- an answer is refused; nothing went wrong in the code
    """An answer that is not returned because it could not be certified.

    Parameters
    ----------
    message : str
        Why the answer is refused.
    figures : mapping of str to float
        The figures that failed, by name.
    partial : object, optional
        The result of what was certified nevertheless, such as the other positions of a case.

    Attributes
    ----------
    study : object
        What a study found before, such as the steps of a march; None if it found nothing.
    """

    study: Any = None

    def __init__(
        self,
        message: str,
        figures: Mapping[str, float] | None = None,
        partial: Any = None,
    ) -> None:
        self.figures = dict(figures or {})
        self.partial = partial
        super().__init__(message)


class ResultError(LoadshareError):
    """A result file that cannot be trusted, with everything that is wrong with it.

    Parameters
    ----------
    problems : iterable of Problem
        All problems found.
    refusal : bool
        Whether the file says that its case was refused.
    """

    def __init__(self, problems: Iterable[Problem], *, refusal: bool = False) -> None:
        self.problems = tuple(problems)
        self.refusal = refusal
        super().__init__(self.problems)

    def __str__(self) -> str:
        lines = [str(problem) for problem in self.problems[:SHOWN]]
        more = len(self.problems) - len(lines)
        return "\n".join([*lines, *([f"and {more} more problems"] if more else [])])


SHOWN = 5
"""Problems of a result file that are shown: a file that was tampered with disagrees everywhere."""
