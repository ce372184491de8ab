"""A client that may send anything."""

from __future__ import annotations

import contextlib
import http.client
import json
from urllib.parse import urlsplit


def ask(address, path, body=None, headers=None, method=None):
    """Return status, headers and content of an answer; JSON is parsed."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.hostname, parts.port, timeout=300)
    sent = dict(headers or {})
    if body is not None:
        sent.setdefault("Content-Type", "application/json")
        if not isinstance(body, bytes):
            body = json.dumps(body).encode()
    with contextlib.closing(connection):
        connection.request(method or ("GET" if body is None else "POST"), path, body, sent)
        reply = connection.getresponse()
        content = reply.read()
    if reply.headers.get("content-type", "").startswith("application/json"):
        content = json.loads(content)
    return reply.status, reply.headers, content


def answer(address, changes=None, position=1):
    """Return the answer for a setting."""
    status, _, found = ask(address, "/answer", {"changes": changes or {}, "position": position})
    assert status == 200
    return found
