"""A case as it was imported from another kind of file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any, NoReturn, TypeAlias

from loadshare.case import Case
from loadshare.case.keys import Path
from loadshare.case.origin import Origin
from loadshare.case.writer import toml_text
from loadshare.errors import CaseError, Problem
from loadshare.input import Unreadable

Data: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Imported:
    """A case as it was imported.

    Attributes
    ----------
    data : dict
        The sections of a case file.
    text : str
        The case file, headed by what was assumed and left out.
    taken, assumed, left_out : tuple of str
    places : mapping of key path to str
        Where keys were found, if messages are to name it.
    """

    data: Data
    text: str
    taken: tuple[str, ...]
    assumed: tuple[str, ...]
    left_out: tuple[str, ...]
    places: Mapping[Path, str] = field(default_factory=dict)

    def case(self, file: str = "case") -> Case:
        """Return the case.

        Parameters
        ----------
        file : str
            File to name in messages.

        Raises
        ------
        CaseError
            If the content does not make a valid case.
        """
        return Case(self.data, origin=Origin(file, self.places))


def commented(data: Data, assumed: Iterable[str], left: Iterable[str]) -> str:
    """Return the case file, headed by what was assumed and left out."""
    lines = []
    for title, notes in (("Assumed:", list(assumed)), ("Left out:", list(left))):
        if notes:
            lines += [f"# {title}", *(f"#   {' '.join(line.split())}" for line in notes)]
    return "\n".join([*lines, "", toml_text(data)])


def refuse(path: FilePath, why: str, hint: str = "") -> NoReturn:
    """Refuse a file."""
    raise CaseError([Problem(str(path), "", "", why, hint=hint)]) from None


@contextmanager
def reading(path: FilePath) -> Iterator[None]:
    """Refuse a file that cannot be read, and say why."""
    try:
        yield
    except OSError as error:
        refuse(path, (error.strerror or "cannot be read").lower())
    except Unreadable as error:
        refuse(path, str(error))
