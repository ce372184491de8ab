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
    _thread().submit(_convert, "svg", {"mark": "point", "data": {"values": []}})


def begin(form: str, spec: dict[str, Any], **settings: Any) -> Future[Any]:
    """Begin to convert a Vega-Lite specification; settings are those of vl-convert."""
    return _thread().submit(_convert, form, spec, **settings)


def _convert(form: str, spec: dict[str, Any], **settings: Any) -> Any:
    import vl_convert

    return getattr(vl_convert, f"vegalite_to_{form}")(spec, **settings)


@cache
def _thread() -> ThreadPoolExecutor:
    from concurrent.futures import ThreadPoolExecutor

    return ThreadPoolExecutor(1, "pictures")
