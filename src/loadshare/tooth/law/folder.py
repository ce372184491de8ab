"""A folder in which computed texts are kept from run to run, by the hash of what they follow from.

The first line of an entry is the digest of the rest; what does not match it is as good as absent,
so a damaged entry is computed again and never believed.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

VARIABLE = "LOADSHARE_CACHE"
"""Environment variable that names another folder."""


def cache_folder() -> Path:
    """Folder of the cache: ``$LOADSHARE_CACHE``, or ``loadshare`` among the user's caches."""
    told = os.environ.get(VARIABLE)
    return Path(told).expanduser() if told else user_cache_path("loadshare", appauthor=False)


def key_of(*parts: str) -> str:
    """Key of an entry: the SHA-256 of what it follows from, the code of this room included."""
    return _digest("\n".join((code_hash(), *parts)))


def read_entry(key: str) -> str | None:
    """Text of an entry, or None where there is none or it is damaged."""
    try:
        digest, _, text = _file(key).read_text(encoding="utf-8").partition("\n")
    except (OSError, UnicodeDecodeError):
        return None
    return text if digest == _digest(text) else None


def write_entry(key: str, text: str) -> None:
    """Keep a text, whole or not at all; a cache that cannot be written is done without."""
    file = _file(key)
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent, prefix=".")
        temporary = Path(name)
        try:
            with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as stream:
                stream.write(f"{_digest(text)}\n{text}")
            temporary.replace(file)
        finally:
            temporary.unlink(missing_ok=True)


@cache
def code_hash() -> str:
    """SHA-256 of the sources of this room: another method gives another entry."""
    room = Path(__file__).parent
    found = hashlib.sha256()
    for file in sorted(room.rglob("*.py")):
        found.update(file.relative_to(room).as_posix().encode())
        found.update(file.read_bytes())
    return found.hexdigest()


def _file(key: str) -> Path:
    return cache_folder() / "laws" / f"{key}.toml"


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
