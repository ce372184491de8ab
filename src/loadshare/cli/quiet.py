"""Whether a command says only what went wrong, as ``--quiet`` and ``--json`` ask."""

from __future__ import annotations

from contextvars import ContextVar

_hushed: ContextVar[bool] = ContextVar("hushed", default=False)


def hush(wanted: bool) -> None:
    """Say nothing from here on but what went wrong, or go on saying all."""
    _hushed.set(wanted)


def is_hushed() -> bool:
    """Tell whether only what went wrong is said."""
    return _hushed.get()
