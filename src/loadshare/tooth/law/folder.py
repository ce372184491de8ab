"""The law of a pair, computed, or kept from an earlier run.

Entries of the folder go by the hash of what they follow from. The first line of an entry is the
digest of the rest; what does not match it is as good as absent, so a damaged entry is computed
again and never believed.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from platformdirs import user_cache_path

from loadshare._version import __version__
from loadshare.output import write_whole
from loadshare.settings import TEETH
from loadshare.tooth.law.file import MeshLaw, law_of, law_text, parsed_law

if TYPE_CHECKING:
    from loadshare.tooth.analysis.result import Ltca
    from loadshare.tooth.pair.file import PairFile

VARIABLE = "LOADSHARE_CACHE"
"""Environment variable that names another folder."""

LAWS = "laws/{}.toml"
"""Place of a law in the folder, by its key."""

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


def cache_folder() -> Path | None:
    """Folder of the cache: ``$LOADSHARE_CACHE``, or ``loadshare`` among the user's caches.

    None for a user without a home: services and containers may lack one.
    """
    given = os.environ.get(VARIABLE)
    try:
        found = Path(given).expanduser() if given else user_cache_path("loadshare", appauthor=False)
    except RuntimeError:
        return None
    # Versions of platformdirs differ in what they make of a home that is not known.
    return None if found.parts[:1] == ("~",) else found


def key_of(*parts: str) -> str:
    """Key of an entry: the SHA-256 of what it follows from, the code of this room included."""
    return _digest("\n".join((code_hash(), *parts)))


def read_entry(key: str, place: str = LAWS) -> str | None:
    """Text of an entry, or None where there is none or it is damaged."""
    try:
        file = _file(key, place)
        if file is None:
            return None
        digest, _, text = file.read_text(encoding="utf-8").partition("\n")
    except (OSError, UnicodeDecodeError):
        return None
    return text if digest == _digest(text) else None


def write_entry(key: str, text: str, place: str = LAWS) -> None:
    """Keep a text, whole or not at all; a cache that cannot be written is done without."""
    file = _file(key, place)
    if file is None:
        return
    with suppress(OSError):
        write_whole(file, f"{_digest(text)}\n{text}")


@cache
def code_hash(room: Path = Path(__file__).parents[1]) -> str:
    """SHA-256 of the sources of this room and its settings: another method, another entry."""
    found = hashlib.sha256(repr(TEETH).encode())
    for file in sorted(room.rglob("*.py")):
        found.update(file.relative_to(room).as_posix().encode())
        found.update(file.read_bytes())
    return found.hexdigest()


def _file(key: str, place: str) -> Path | None:
    folder = cache_folder()
    return None if folder is None else folder / place.format(key)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
