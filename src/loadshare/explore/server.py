"""The server: it assigns requests to the functions that answer them, and keeps no sessions."""

from __future__ import annotations

import asyncio
import json
import logging
import os
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from functools import cache, partial
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from loadshare.case import Case
from loadshare.errors import CaseError
from loadshare.explore.answer import answer_of, case_of, invalid, whole_of
from loadshare.explore.files import case_file
from loadshare.explore.guard import Guard
from loadshare.explore.inputs import PageInputs
from loadshare.explore.questions import along, finite, place, slopes
from loadshare.explore.request import RequestError, body_of, setting, text
from loadshare.explore.samples import Growing, SampleRange, samples, scatter, start_study
from loadshare.explore.studies import criticals, rates, trace
from loadshare.explore.workers import Workers

log = logging.getLogger("loadshare")

TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
INDEX = "index.html"
Body = dict[str, Any]
Parts = AsyncIterator[dict[str, Any]]
Found = TypeVar("Found")
Answering = Callable[[PageInputs, Mapping[str, object], int], dict[str, Any]]
Handler = Callable[[Request], Awaitable[Response]]


@cache
def assets() -> dict[str, tuple[bytes, str]]:
    """Return content and type of every file of the page, by name; no other file is served."""
    # The style of the report is the base of the page's own.
    folders = files("loadshare.report.page") / "templates", files("loadshare.explore") / "page"
    return {
        file.name: (file.read_bytes(), TYPES[suffix])
        for folder in folders
        for file in folder.iterdir()
        if (suffix := f".{file.name.rpartition('.')[2]}") in TYPES
    }


class Explorer:
    """Answers the requests of pages about one case.

    Parameters
    ----------
    case : Case
    file : Path or None
        File of the case, for cases that extend it.
    """

    def __init__(self, case: Case, file: Path | None) -> None:
        self.inputs, self.file = PageInputs(case), file
        # One after another: each answer is ready sooner than if they ran at the same time.
        self.solver = ThreadPoolExecutor(1, "solver")
        self.workers = Workers(max(1, (os.cpu_count() or 2) - 1))
        self.studies: Mapping[str, Callable[[Request, Body], Parts]] = {
            "critical": self.critical,
            "sweep": self.sweep,
            "slopes": self.slopes,
            "tolerance": self.tolerance,
        }

    async def solved(self, work: Callable[[], Found]) -> Found:
        """Do work in the solver's thread."""
        return await asyncio.get_running_loop().run_in_executor(self.solver, work)

    async def index(self, request: Request) -> Response:
        """Return the page."""
        return await self.asset(request, INDEX)

    async def asset(self, request: Request, name: str = "") -> Response:
        """Return one of the page's files."""
        known = assets().get(name or request.path_params["name"])
        if known is None:
            raise RequestError(404, "There is no such file.")
        content, kind = known
        return Response(content, headers={"content-type": kind})

    async def case(self, request: Request) -> Response:
        """Return what the page must know about the case."""
        return JSONResponse(await self.solved(partial(case_of, self.inputs)))

    async def answered(self, request: Request, work: Answering) -> Response:
        """Return what `work` answers to a setting and a position."""
        body = await body_of(request)
        asked = partial(work, self.inputs, setting(body), place(body))
        return JSONResponse(await self.solved(asked))

    async def answer(self, request: Request) -> Response:
        """Return the answer to a setting."""
        return await self.answered(request, answer_of)

    async def whole(self, request: Request) -> Response:
        """Return the answer at all positions, and how far it can be trusted."""
        return await self.answered(request, whole_of)

    async def keys(self, request: Request) -> Response:
        """Return the inputs that a name means: one with a star, or several joined."""
        return JSONResponse({"keys": self.inputs.keys(text(await body_of(request), "name"))})

    async def study(self, request: Request) -> Response:
        """Return the study that the path names, with a line of JSON after each of its parts."""
        parts = self.studies.get(request.path_params["name"])
        if parts is None:
            raise RequestError(404, "there is no such study")
        lines = parts(request, await body_of(request))
        # Mistakes in the request are reported before anything is sent.
        first = await anext(lines)
        return StreamingResponse(_lines(first, lines), media_type="application/x-ndjson")

    async def critical(self, request: Request, body: Body) -> Parts:
        """Yield critical values along an input, those near its present value first."""
        question = await self.solved(partial(along, self.inputs, body))
        stretches = question.stretches(finite(body, "at", question.low))
        for done, stretch in enumerate(stretches, start=1):
            found = await self.workers.done(request, criticals, stretch, done > 1)
            if "events" not in found:
                gap = [stretch.low, stretch.high, " ".join(found["messages"])]
                found = {"events": [], "gaps": [gap], "confirmed": True}
            yield found | {"done": done, "of": len(stretches)}

    async def sweep(self, request: Request, body: Body) -> Parts:
        """Yield Ω and the places of floats along an input."""
        question = await self.solved(partial(along, self.inputs, body))
        yield await self.workers.done(request, trace, question)

    async def slopes(self, request: Request, body: Body) -> Parts:
        """Yield how Ω changes with inputs."""
        question = await self.solved(partial(slopes, self.inputs, body))
        done = 0
        for batch in question.batches():
            found = await self.workers.done(request, rates, batch, done > 0)
            done += len(batch.keys)
            yield found | {"done": done, "of": len(question.keys)}

    async def tolerance(self, request: Request, body: Body) -> Parts:
        """Yield what a tolerance study is, then its statistics after every part."""
        question = await self.solved(partial(scatter, self.inputs, body))
        study = await self.workers.done(request, start_study, question)
        if "job" not in study:
            yield study
            return
        yield {"begun": study["begun"]}
        growing = Growing(study)
        while growing.done < study["samples"]:
            part = SampleRange(study["job"], growing.done, study["rows"])
            found = await self.workers.done(request, samples, part, True)
            growing.take(found)
            yield await asyncio.to_thread(growing.statistics)

    async def toml(self, request: Request) -> Response:
        """Return a setting as a case file."""
        given = setting(await body_of(request))
        return JSONResponse(await self.solved(partial(case_file, self.inputs, given, self.file)))


async def _lines(first: dict[str, Any], others: Parts) -> AsyncIterator[str]:
    """Yield the parts of a study as lines; if an error occurs, it is the last one."""
    yield f"{json.dumps(first)}\n"
    try:
        async for one in others:
            yield f"{json.dumps(one)}\n"
    except Exception as error:  # noqa: BLE001 -- reported, as everything is
        yield f"{json.dumps(_failure(error, 'a study')[0])}\n"


def _safely(handler: Handler) -> Handler:
    """Return a handler that answers any error with a message."""

    async def answered(request: Request) -> Response:
        try:
            return await handler(request)
        except Exception as error:  # noqa: BLE001 -- reported, as everything is
            return JSONResponse(*_failure(error, request.url.path))

    return answered


def _failure(error: Exception, what: str) -> tuple[dict[str, Any], int]:
    """Return the message for an error, and its status."""
    if isinstance(error, CaseError):
        return invalid(error), 200
    if isinstance(error, RequestError):
        return {"status": "failed", "messages": [str(error)]}, error.status
    if isinstance(error, ClientDisconnect):
        # The page left in the middle of its request: nobody reads this, and nothing has failed.
        return {"status": "failed", "messages": ["the page went away"]}, 499
    log.error("%s failed", what, exc_info=error)
    message = f"the server failed: {type(error).__name__}; its log says more"
    return {"status": "failed", "messages": [message]}, 500


def application(case: Case, hosts: Iterable[str], file: Path | None = None) -> Guard:
    """Return the server of a case, for any ASGI server.

    Parameters
    ----------
    case : Case
    hosts : iterable of str
        What a Host header may say, `guard.hosts_of`.
    file : Path, optional
        File of the case, for cases that extend it.
    """
    explorer = Explorer(case, file)

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        yield
        explorer.workers.end()
        explorer.solver.shutdown(wait=False, cancel_futures=True)

    got = {"/": explorer.index, "/case": explorer.case, "/page/{name}": explorer.asset}
    posted = {
        "/answer": explorer.answer,
        "/whole": explorer.whole,
        "/keys": explorer.keys,
        "/toml": explorer.toml,
        "/study/{name}": explorer.study,
    }
    routes = [
        *(Route(path, _safely(handler), methods=["GET"]) for path, handler in got.items()),
        *(Route(path, _safely(handler), methods=["POST"]) for path, handler in posted.items()),
    ]
    return Guard(Starlette(routes=routes, lifespan=lifespan), frozenset(hosts))
