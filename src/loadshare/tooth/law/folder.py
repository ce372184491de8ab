"""The law of a pair, computed, or kept from an earlier run."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from loadshare._version import __version__
from loadshare.settings import TEETH
from loadshare.tooth.law.file import MeshLaw, law_of, law_text, parsed_law
from loadshare.user_cache import digest_of, read_entry, write_entry

if TYPE_CHECKING:
    from loadshare.tooth.analysis.result import Ltca
    from loadshare.tooth.pair.file import PairFile

Tick = Callable[[int, int], None]


def known_law(pair: PairFile) -> MeshLaw | None:
    """Law that the cache holds for a pair, if it does."""
    text = read_entry(_place(pair))
    return None if text is None else parsed_law(text)


def computed_law(pair: PairFile, progress: Tick | None = None) -> MeshLaw:
    """Analyse a pair, and keep and return its law.

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
    """Return the law of an analysis, and keep it in the cache."""
    law = law_of(pair, found)
    write_entry(_place(pair), law_text(law))
    return law


def _place(pair: PairFile) -> str:
    """Place of a law: by the version, the pair, and the sources of this room and its settings."""
    key = digest_of(f"{code_hash()}\n{__version__}\n{pair.hash}")
    return f"laws/{key}.toml"


@cache
def code_hash(room: Path = Path(__file__).parents[1]) -> str:
    """SHA-256 of the sources of this room and its settings: another method, another entry."""
    found = hashlib.sha256(repr(TEETH).encode())
    for file in sorted(room.rglob("*.py")):
        found.update(file.relative_to(room).as_posix().encode())
        found.update(file.read_bytes())
    return found.hexdigest()
