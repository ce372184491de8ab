"""Digests of the content of a result's file, which reveal any change."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

DIGEST = "digest"
"""Key of the digest in a document."""
_SEAL = b"\nloadshare sha256 "


def digest_of(document: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a document without its own digest, whatever its layout."""
    content = {key: value for key, value in document.items() if key != DIGEST}
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def sealed(held: bytes) -> bytes:
    """Return a file with its digest appended; readers of HDF5 do not look beyond the file's end."""
    return held + _seal_of(held)


def is_sealed(whole: bytes) -> bool:
    """Return whether a file's content is what was sealed, without interpreting it."""
    end = whole.rfind(_SEAL)
    return end >= 0 and whole[end:] == _seal_of(whole[:end])


def _seal_of(held: bytes) -> bytes:
    return _SEAL + hashlib.sha256(held).hexdigest().encode() + b"\n"
