"""Checks of the size and form of requests; a request that fails is answered with a message."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

from starlette.requests import Request

from loadshare.settings import EXPLORE


class RequestError(Exception):
    """A request that cannot be answered, and the reason.

    Parameters
    ----------
    status : int
        HTTP status.
    message : str
    """

    def __init__(self, status: int, message: str) -> None:
        self.status = status
        super().__init__(message)


async def body_of(request: Request) -> dict[str, Any]:
    """Return the body of a request.

    Raises
    ------
    RequestError
        If it is too long, or no JSON object as a page sends it.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json":
        raise RequestError(415, f'the content type is "{kind}"; allowed: application/json')
    held = b""
    async for piece in request.stream():
        held += piece
        if len(held) > EXPLORE.body:
            raise RequestError(413, f"the request is longer than {EXPLORE.body} bytes")
    try:
        found = json.loads(
            held,
            parse_constant=_no_number,
            parse_int=lambda text: _held(text, int),
            parse_float=lambda text: _held(text, float),
        )
        # A lone surrogate, which JSON may hold, cannot be written to a file or a message.
        json.dumps(found, ensure_ascii=False).encode()
    except (ValueError, RecursionError):
        raise RequestError(400, "the request is not JSON, or a number in it is too long") from None
    if not isinstance(found, dict):
        raise RequestError(400, "the request is not a JSON object")
    return found


def _no_number(text: str) -> NoReturn:
    raise ValueError(text)


def _held(text: str, kind: Callable[[str], float]) -> float:
    """Return a number that double precision can hold."""
    if math.isinf(float(text)):
        raise ValueError(text)
    return kind(text)


def setting(body: Mapping[str, Any]) -> dict[str, object]:
    """Return the inputs that a page has changed, by key."""
    given = body.get("changes", {})
    if not isinstance(given, dict):
        raise RequestError(400, "changes is not an object of values by key")
    return given


def number(body: Mapping[str, Any], name: str, default: int, least: int, most: int) -> int:
    """Return a whole number of a request, within its bounds."""
    given = body.get(name, default)
    if isinstance(given, bool) or not isinstance(given, int) or not least <= given <= most:
        raise RequestError(400, f"{name} is not a whole number from {least} to {most}")
    return given


def text(body: Mapping[str, Any], name: str) -> str:
    """Return a text of a request."""
    given = body.get(name)
    if not isinstance(given, str) or not given or len(given) > EXPLORE.text * 10:
        raise RequestError(400, f"{name} is not a text")
    return given
