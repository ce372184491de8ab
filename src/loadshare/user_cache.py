"""Texts kept in the user's cache folder.

The first line of an entry is the digest of the rest; an entry that does not match it counts as
absent, so that a damaged one is made again and never used.
"""

from __future__ import annotations

import os
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from platformdirs import user_cache_path

from loadshare.output import write_whole

VARIABLE = "LOADSHARE_CACHE"
"""Environment variable that names another folder."""


def cache_folder() -> Path | None:
    """Return the cache folder: ``$LOADSHARE_CACHE``, or ``loadshare`` among the user's caches.

    None for a user without a home: services and containers may lack one.
    """
    given = os.environ.get(VARIABLE)
    try:
        found = Path(given).expanduser() if given else user_cache_path("loadshare", appauthor=False)
    except RuntimeError:
        return None
    # Versions of platformdirs differ in what they return if the home is not known.
    return None if found.parts[:1] == ("~",) else found


def digest_of(text: str) -> str:
    """Return the SHA-256 of a text."""
    return sha256(text.encode()).hexdigest()


def read_entry(place: str) -> str | None:
    """Return the text kept at a place in the folder; None where there is none or it is damaged."""
    try:
        file = _file(place)
        if file is None:
            return None
        digest, _, text = file.read_text(encoding="utf-8").partition("\n")
    except (OSError, UnicodeDecodeError):
        return None
    return text if digest == digest_of(text) else None


def write_entry(place: str, text: str) -> None:
    """Keep a text, whole or not at all; a cache that cannot be written is no error."""
    file = _file(place)
    if file is None:
        return
    with suppress(OSError):
        write_whole(file, f"{digest_of(text)}\n{text}")


def _file(place: str) -> Path | None:
    folder = cache_folder()
    return None if folder is None else folder / place
