"""Conversion of pictures in a thread of its own, in parallel with computing and writing the rest.

The converter is a JavaScript engine, which takes half a second to start and does not hold Python's
global lock while it draws.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from concurrent.futures import Future, ThreadPoolExecutor


def start() -> None:
    """Start the converter, for pictures that will be drawn soon."""
    begin("vegalite_to_svg", {"mark": "point", "data": {"values": []}})


def begin(conversion: str, what: object, **settings: Any) -> Future[Any]:
    """Begin a conversion of a specification or of SVG, by its name in vl-convert."""
    thread = _thread()
    try:
        return thread.submit(_convert, conversion, what, settings)
    except BaseException:
        # If this is interrupted while the thread starts, the pool does not know of the thread and
        # never ends it, but the interpreter does know of it and would wait for it.
        thread.shutdown(wait=False)
        _thread.cache_clear()
        raise


def _convert(conversion: str, what: object, settings: dict[str, Any]) -> Any:
    import vl_convert

    return getattr(vl_convert, conversion)(what, **settings)


@cache
def _thread() -> ThreadPoolExecutor:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(1, "pictures")
