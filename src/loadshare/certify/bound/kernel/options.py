"""How the functions of this room are compiled."""

from __future__ import annotations

from typing import Any

from loadshare import compilation

# Nothing is allocated in here, so Numba need not count who holds an array: counting would take
# twice as long as judging.
_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz"},
    "_nrt": False,
}
compiled = compilation.jit(**_how)
# Else what is called in an inlined function would be inlined as well.
within = compilation.within(forceinline=False, **_how)
# Claim by claim they read the same arrays, whose places would be read again by each of them.
inlined = compilation.within(forceinline=True, **_how)
