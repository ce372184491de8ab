"""The server: which request leads to what. It remembers nothing of those who ask."""

from __future__ import annotations

import asyncio
import logging
import os
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from functools import cache, partial
from importlib.resources import files
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.explore.answer import answer_of, case_of, invalid, whole_of
from loadshare.explore.asked import Unasked, asked, number, setting, text
from loadshare.explore.crew import Crew
from loadshare.explore.files import case_file
from loadshare.explore.guard import Guard
from loadshare.explore.inputs import Inputs
from loadshare.explore.questions import piece_of, question_of
from loadshare.explore.studies import criticals, safely, samples, slopes, trace
from loadshare.settings import ALLOWED

log = logging.getLogger("loadshare")

TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
INDEX = "index.html"
STUDIES = {"critical": criticals, "sweep": trace, "slopes": slopes}
Handler = Callable[[Request], Awaitable[Response]]


@cache
def assets() -> dict[str, tuple[bytes, str]]:
    """Content and type of every file of the page, by name: what is not here, is nowhere."""
    # The style of the report is the base of the page's own.
    folders = files("loadshare.report.page") / "templates", files("loadshare.explore") / "page"
    return {
        file.name: (file.read_bytes(), TYPES[suffix])
        for folder in folders
        for file in folder.iterdir()
        if (suffix := f".{file.name.rpartition('.')[2]}") in TYPES
    }


class Explorer:
    """Answers what pages ask of one case.

    Parameters
    ----------
    case : Case
    file : Path or None
        From which it is, for cases that extend it.
    """

    def __init__(self, case: Case, file: Path | None) -> None:
        self.inputs, self.file = Inputs(case), file
        # One after another: each answer is there sooner than if they took turns.
        self.solver = ThreadPoolExecutor(1, "solver")
        self.crew = Crew(max(1, (os.cpu_count() or 2) - 1))

    async def solved(self, work: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """Do work in the solver's thread."""
        return await asyncio.get_running_loop().run_in_executor(self.solver, work)

    async def index(self, request: Request) -> Response:
        """The page."""
        return await self.asset(request, INDEX)

    async def asset(self, request: Request, name: str = "") -> Response:
        """One of its files."""
        known = assets().get(name or request.path_params["name"])
        if known is None:
            raise Unasked(404, "There is no such file.")
        content, kind = known
        return Response(content, headers={"content-type": kind})

    async def case(self, request: Request) -> Response:
        """What the page must know of the case."""
        return JSONResponse(await self.solved(partial(case_of, self.inputs)))

    async def answer(self, request: Request) -> Response:
        """A setting, solved."""
        body = await asked(request)
        position = number(body, "position", 1, 1, ALLOWED.positions)
        work = partial(answer_of, self.inputs, setting(body), position)
        return JSONResponse(await self.solved(work))

    async def whole(self, request: Request) -> Response:
        """The same at all positions, and how far it is to be trusted."""
        body = await asked(request)
        return JSONResponse(await self.solved(partial(whole_of, self.inputs, setting(body))))

    async def keys(self, request: Request) -> Response:
        """The inputs that a name means: one with a star, or several joined."""
        name = text(await asked(request), "name")
        try:
            return JSONResponse({"keys": self.inputs.keys(name)})
        except CaseError as error:
            return JSONResponse(invalid(error))

    async def study(self, request: Request) -> Response:
        """A sweep, critical values or sensitivities, by the name of the path."""
        body = await asked(request)
        try:
            question = question_of(self.inputs, body)
        except CaseError as error:
            return JSONResponse(invalid(error))
        name = request.path_params["name"]
        if name not in STUDIES:
            raise Unasked(404, "there is no such study")
        work = partial(safely, STUDIES[name])
        return JSONResponse(await self.crew.done(request, work, question))

    async def samples(self, request: Request) -> Response:
        """A piece of a tolerance study."""
        body = await asked(request)
        try:
            piece = piece_of(self.inputs, body)
        except CaseError as error:
            return JSONResponse(invalid(error))
        return JSONResponse(await self.crew.done(request, samples, piece))

    async def toml(self, request: Request) -> Response:
        """A setting as a case file."""
        given = setting(await asked(request))
        try:
            return JSONResponse(
                await self.solved(partial(case_file, self.inputs, given, self.file))
            )
        except CaseError as error:
            return JSONResponse(invalid(error))


def _safely(handler: Handler) -> Handler:
    """Answer whatever goes wrong with a message."""

    async def answered(request: Request) -> Response:
        try:
            return await handler(request)
        except Unasked as error:
            return _failed(str(error), error.status)
        except Exception as error:
            log.exception("%s failed", request.url.path)
            return _failed(f"the server failed: {type(error).__name__}; its log says more", 500)

    return answered


def _failed(told: str, status: int) -> Response:
    return JSONResponse({"status": "failed", "messages": [told]}, status)


def application(case: Case, hosts: Iterable[str], file: Path | None = None) -> Guard:
    """Return the server of a case, for any ASGI server.

    Parameters
    ----------
    case : Case
    hosts : iterable of str
        What a Host header may say, `guard.hosts_of`.
    file : Path, optional
        From which the case is, for cases that extend it.
    """
    explorer = Explorer(case, file)

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        yield
        explorer.crew.end()
        explorer.solver.shutdown(wait=False, cancel_futures=True)

    got = {"/": explorer.index, "/case": explorer.case, "/page/{name}": explorer.asset}
    posted = {
        "/answer": explorer.answer,
        "/whole": explorer.whole,
        "/keys": explorer.keys,
        "/toml": explorer.toml,
        "/samples": explorer.samples,
        "/study/{name}": explorer.study,
    }
    routes = [
        *(Route(path, _safely(handler), methods=["GET"]) for path, handler in got.items()),
        *(Route(path, _safely(handler), methods=["POST"]) for path, handler in posted.items()),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), frozenset(hosts))
