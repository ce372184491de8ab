"""Whether a command prints errors only, as ``--quiet`` and ``--json`` ask."""

from __future__ import annotations

from contextvars import ContextVar

_hushed: ContextVar[bool] = ContextVar("hushed", default=False)


def hush(wanted: bool) -> None:
    """From here on print errors only, or everything."""
    _hushed.set(wanted)


def is_hushed() -> bool:
    """Return whether only errors are printed."""
    return _hushed.get()
