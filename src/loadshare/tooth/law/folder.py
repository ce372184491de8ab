"""The law of a pair, computed or read from the cache."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from loadshare._version import __version__
from loadshare.progress import Progress
from loadshare.settings import TEETH
from loadshare.tooth.law.file import MeshLaw, law_of, law_text, parsed_law
from loadshare.user_cache import digest_of, read_entry, write_entry

if TYPE_CHECKING:
    from loadshare.tooth.analysis.result import Ltca
    from loadshare.tooth.pair.file import PairFile


def known_law(pair: PairFile) -> MeshLaw | None:
    """Return the law that the cache holds for a pair; None if it holds none."""
    text = read_entry(_place(pair))
    return None if text is None else parsed_law(text)


def computed_law(pair: PairFile, progress: Progress | None = None) -> MeshLaw:
    """Analyse a pair, and cache and return its law.

    Parameters
    ----------
    pair : PairFile
    progress : callable, optional
        As for :meth:`PairFile.analyse`.

    Raises
    ------
    Refused
        If a position has no certified contact.
    """
    return kept_law(pair, pair.analyse(progress))


def kept_law(pair: PairFile, found: Ltca) -> MeshLaw:
    """Return the law of an analysis, after writing it to the cache."""
    law = law_of(pair, found)
    write_entry(_place(pair), law_text(law))
    return law


def _place(pair: PairFile) -> str:
    """Return a law's place in the cache: by version, pair, and this package's code and settings."""
    key = digest_of(f"{code_hash()}\n{__version__}\n{pair.hash}")
    return f"laws/{key}"


@cache
def code_hash(room: Path = Path(__file__).parents[1]) -> str:
    """Return the SHA-256 of this package's code and settings: a new method gets a new entry."""
    found = hashlib.sha256(repr(TEETH).encode())
    for file in sorted(room.rglob("*.py")):
        found.update(file.relative_to(room).as_posix().encode())
        found.update(file.read_bytes())
    return found.hexdigest()
