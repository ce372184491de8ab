"""Tooth geometry, contact without load and loaded tooth contact analysis of a gear pair."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from loadshare.tooth.law.file import load_law
    from loadshare.tooth.law.meshes import bears_on_laws, resolve, written_in
    from loadshare.tooth.pair.file import load_pair

_LAZY = {
    "bears_on_laws": "loadshare.tooth.law.meshes",
    "load_law": "loadshare.tooth.law.file",
    "load_pair": "loadshare.tooth.pair.file",
    "resolve": "loadshare.tooth.law.meshes",
    "written_in": "loadshare.tooth.law.meshes",
}

__all__ = ["bears_on_laws", "load_law", "load_pair", "resolve", "written_in"]


def __getattr__(name: str) -> Any:
    """Import what is asked for only when it is asked for, so that the command starts quickly."""
    if name in _LAZY:
        return getattr(import_module(_LAZY[name]), name)
    raise AttributeError(f"module 'loadshare.tooth' has no attribute {name!r}")
