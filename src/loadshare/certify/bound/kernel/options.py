"""How the functions of this package are compiled."""

from __future__ import annotations

from typing import Any

from loadshare import compilation

# Nothing is allocated in here, so Numba need not count references to arrays: counting would take
# twice as long as judging.
_how: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"reassoc", "contract", "nsz"},
    "_nrt": False,
}
compiled = compilation.jit(**_how)
# Otherwise a function called in an inlined function would be inlined as well.
within = compilation.within(forceinline=False, **_how)
# Called claim by claim, these read the same arrays, whose addresses each call would load again.
inlined = compilation.within(forceinline=True, **_how)
