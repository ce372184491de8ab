"""The law of a pair, from the cache or computed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from loadshare._version import __version__
from loadshare.tooth.law.file import MeshLaw, law_of, law_text, parsed_law
from loadshare.tooth.law.folder import key_of, read_entry, write_entry

if TYPE_CHECKING:
    from loadshare.tooth.analysis.result import Ltca
    from loadshare.tooth.pair.file import PairFile

Tick = Callable[[int, int], None]


def known_law(pair: PairFile) -> MeshLaw | None:
    """Law that the cache holds for a pair, if it does."""
    text = read_entry(_key(pair))
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
    write_entry(_key(pair), law_text(law))
    return law


def _key(pair: PairFile) -> str:
    return key_of(__version__, pair.hash)
