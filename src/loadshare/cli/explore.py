"""`loadshare explore`: a live page of a case."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from loadshare.cli.cases import open_case
from loadshare.cli.console import say
from loadshare.cli.exits import UNUSABLE, fail, reporting_problems
from loadshare.cli.options import CaseFile, Changes
from loadshare.cli.stop import Stop

if TYPE_CHECKING:
    import socket

LOCAL = "127.0.0.1"
MISSING = (
    "The explorer needs a web server that a plain installation does not include: "
    "pip install 'loadshare[explore]'"
)


def explore(
    case: CaseFile,
    host: Annotated[
        str,
        typer.Option(metavar="ADDRESS", help="Address to listen on; by default only this machine."),
    ] = LOCAL,
    port: Annotated[
        int,
        typer.Option(min=0, max=65535, metavar="N", help="Port; a free one by default."),
    ] = 0,
    name: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Additional name by which browsers reach the server, with its port if different; "
            "may be repeated.",
        ),
    ] = None,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
    ] = True,
    change: Changes = None,
) -> None:
    """Open a live page of a case: inputs as sliders, the certified answer beside them.

    The page needs no network. The server answers only this machine unless another address is
    given; it changes no file.
    """
    try:
        import uvicorn

        from loadshare.explore.guard import hosts_of
        from loadshare.explore.server import application
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in ("uvicorn", "starlette"):
            raise
        fail([MISSING], UNUSABLE)
    with reporting_problems():
        loaded = open_case(case, change)
    listening = _listening(host, port)
    port = listening.getsockname()[1]
    app = application(loaded, hosts_of(host, port, name or ()), case)
    config = uvicorn.Config(app, log_level="error", access_log=False, server_header=False)
    shown = LOCAL if host in ("0.0.0.0", "::") else host
    address = f"http://[{shown}]:{port}/" if ":" in shown else f"http://{shown}:{port}/"
    say(f"{loaded.title or loaded.name}: {address}", whole=True)
    say("Press Ctrl-C to stop.")
    if host not in (LOCAL, "localhost", "::1"):
        say("Anyone who can reach this address can use it: there is no password.")
    with Stop() as stop:
        try:
            if browser:
                typer.launch(address)
            uvicorn.Server(config).run(sockets=[listening])
        except KeyboardInterrupt:
            fail(["Stopped."], stop.code)


def _listening(host: str, port: int) -> socket.socket:
    """Return a socket that listens at an address.

    Raises
    ------
    typer.Exit
        If the address is not available.
    """
    import socket

    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        found = socket.socket(family)
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        found.bind((host, port))
        # From here on, not only once the server has started: a browser may be faster.
        found.listen()
    except OSError as error:
        fail([f"cannot listen on {host}:{port}: {error.strerror or error}"], UNUSABLE)
    return found
