"""How the functions of this room are compiled."""

from __future__ import annotations

from typing import Any

from loadshare import compilation

# Nothing is allocated in here, so Numba need not count who holds an array: counting would take
# twice as long as judging. A call would hand over every array of the tuples, and cost more than
# what it does, so functions that take them are inlined.
_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz"},
    "_nrt": False,
}
compiled = compilation.jit(**_how)
inlined = compilation.within(forceinline=True, **_how)
