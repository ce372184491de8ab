"""How the functions of this room are compiled."""

from __future__ import annotations

from typing import Any

from loadshare.compilation import jit, within

_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz", "arcp"},
}
cached = jit(**_how)
"""What is called from outside; its compiled code is kept on disk."""
allocating = within(**_how)
# Without counted references, which would cost more than the sums: nothing is allocated in these.
_uncounted: dict[str, Any] = {**_how, "_nrt": False}
bare = within(**_uncounted)
