"""Where each key of a case was written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path as FilePath

from loadshare.case.keys import Path, dotted, look_up
from loadshare.case.words import as_given
from loadshare.errors import Problem
from loadshare.input import real
from loadshare.settings import ALLOWED

CHANGES = "changes"
"""Stands in for the file of keys that `Case.replace` changed."""


@dataclass(frozen=True)
class Origin:
    """The file of each key; a case built in Python has one made-up file.

    Parameters
    ----------
    file : str
        File of every key that `files` does not name.
    files : mapping
        File of a key and of all below it, by key path.
    outside : bool
        Whether the case may name files outside the folder of `file`.
    """

    file: str = "case"
    files: Mapping[Path, str] = field(default_factory=dict)
    outside: bool = False

    def outside_problem(self, named: FilePath, file: str, key: str, given: str) -> Problem | None:
        """Return a problem if a file named by a case must not be read, else None.

        A case from elsewhere must not make its user open other files; a file that the user names in
        a change is allowed. Links are resolved first.

        Parameters
        ----------
        named : pathlib.Path
            The file.
        file : str
            The file that names it.
        key, given : str
            The key that names it, and the text given there.
        """
        if "\0" in str(named) or any(len(part) > ALLOWED.file_name for part in named.parts):
            return Problem(file, key, given, "is not a valid file name", "the name of a file")
        folder = FilePath(self.file).parent
        if self.outside or file == CHANGES or real(named).is_relative_to(real(folder)):
            return None
        message = "is outside the folder of the case"
        allowed = f"a file beside {self.file}, or in a folder below"
        hint = "To read it anyway: --allow-outside; in Python, load_case(…, allow_outside=True)."
        return Problem(file, key, given, message, allowed, hint)

    def of(self, path: Path) -> str:
        """Return the file that contains a key.

        Parameters
        ----------
        path : tuple of str or int
            Its path; for a key that does not exist, that of the table which would hold it counts.

        Returns
        -------
        str
            The file.
        """
        for length in range(len(path), 0, -1):
            if path[:length] in self.files:
                return self.files[path[:length]]
        return self.file

    def problem(
        self, data: Mapping[str, object], path: Path, message: str, allowed: str, hint: str
    ) -> Problem:
        """Return a problem with a key, including its file and the value given.

        Parameters
        ----------
        data : mapping
            The case as plain data.
        path : tuple of str or int
            The key.
        message, allowed, hint : str
            As in `Problem`.

        Returns
        -------
        Problem
            The problem.
        """
        value = look_up(data, path)
        # A whole table would bury the message.
        given = "" if isinstance(value, Mapping) else as_given(value)
        return Problem(self.of(path), dotted(path), given, message, allowed, hint)
