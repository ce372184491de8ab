"""Access control: who may send requests, and what a browser may do with the answers.

A server on this machine can be reached by any page that its user opens: by its address, or by a
name that somebody points at this machine. So a request must name the server as it was started
(Host), and come from its own page (Origin, Sec-Fetch-Site); a page gets its scripts, styles and
answers from the server and nothing from elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterable

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}
LOCAL = ("localhost", "127.0.0.1", "[::1]")
"""Names by which this machine calls itself."""


def hosts_of(host: str, port: int, names: Iterable[str] = ()) -> frozenset[str]:
    """Return what a Host header may say.

    Parameters
    ----------
    host : str
        Address that the server listens at.
    port : int
    names : iterable of str
        Further names by which the server is reached, with a port if that differs.
    """
    own = f"[{host}]" if ":" in host else host
    own_names = {*LOCAL, own} - {"0.0.0.0", "[::]"}
    found = {f"{name}:{port}" for name in own_names}
    for name in names:
        found |= {name.lower(), f"{name.lower()}:{port}"}
    return frozenset(found | (own_names if port in (80, 443) else set()))


class Guard:
    """Refuses requests from elsewhere, and sends the policy with every answer.

    Parameters
    ----------
    app : ASGI application
    hosts : set of str
        What a Host header may say.
    """

    def __init__(self, app: ASGIApp, hosts: frozenset[str]) -> None:
        self.app, self.hosts = app, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or refuse."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        why = self._refused(Headers(scope=scope))
        if why:
            await PlainTextResponse(why, 403)(scope, receive, guarded)
        else:
            await self.app(scope, receive, guarded)

    def _refused(self, headers: Headers) -> str:
        host = headers.get("host", "").lower()
        if host not in self.hosts:
            return (
                "This server is not known by that name. It answers to: "
                f"{', '.join(sorted(self.hosts))}. Add others with --name."
            )
        origin = headers.get("origin")
        if origin is not None and origin.lower() not in {f"http://{host}", f"https://{host}"}:
            return "The request comes from a page of another server."
        if headers.get("sec-fetch-site", "same-origin") not in ("same-origin", "none"):
            return "The request comes from a page of another server."
        return ""
