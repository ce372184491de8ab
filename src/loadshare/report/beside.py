"""Pictures are converted in a thread of their own, beside what computes and writes the rest.

The converter is a JavaScript engine, which takes half a second to start and holds no lock of
Python's while it draws.
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
    """Begin a conversion, by the name of vl-convert, of a specification or of SVG."""
    thread = _thread()
    try:
        return thread.submit(_convert, conversion, what, settings)
    except BaseException:
        # Interrupted while the thread starts, it is one that the pool does not know of and never
        # ends; the interpreter, which does know, would wait for it.
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
