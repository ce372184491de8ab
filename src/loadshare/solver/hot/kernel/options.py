"""How the functions of this package are compiled."""

from __future__ import annotations

from typing import Any

from loadshare.compilation import jit, within

_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz", "arcp"},
}
cached = jit(**_how)
"""Decorator of functions called from outside; their compiled code is kept on disk."""
allocating = within(**_how)
# Without reference counting, which would cost more than the sums: these allocate nothing.
_uncounted: dict[str, Any] = {**_how, "_nrt": False}
bare = within(**_uncounted)
