"""Worker processes, each lent to one request at a time, and killed when that is broken off."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, TypeVar

from starlette.requests import Request

from loadshare.explore.request import RequestError
from loadshare.processes import Worker
from loadshare.settings import EXPLORE

Item = TypeVar("Item")
Found = TypeVar("Found")


class Crew:
    """Some worker processes, started when they are first needed.

    Parameters
    ----------
    count : int
        Processes.
    """

    def __init__(self, count: int) -> None:
        self.count, self.waiting = count, 0
        self.free = [Worker() for _ in range(count)]
        self.turn = asyncio.Semaphore(count)

    async def done(self, request: Request, work: Callable[[Item], Found], item: Item) -> Found:
        """Return what a worker finds, as long as somebody waits for it.

        Parameters
        ----------
        request : Request
            Its body read; when who sent it goes away, the worker is killed.
        work : callable
        item : object

        Raises
        ------
        RequestError
            If too many wait already, or nobody does any more.
        """
        if self.waiting >= self.count * EXPLORE.waiting:
            raise RequestError(503, "too many studies are waiting; try again in a while")
        # A task of its own: whoever waits may be cancelled, and the worker is put in order all
        # the same.
        lent = asyncio.create_task(self._lent(request, work, item))
        lent.add_done_callback(_looked_at)
        return await asyncio.shield(lent)

    async def _lent(self, request: Request, work: Callable[[Item], Found], item: Item) -> Found:
        gone = asyncio.ensure_future(_gone(request))
        self.waiting += 1
        try:
            async with self.turn:
                if gone.done():
                    raise RequestError(499, "nobody waits for this any more")
                return await self._by_one(gone, work, item)
        finally:
            self.waiting -= 1
            gone.cancel()

    async def _by_one(
        self, gone: asyncio.Future[None], work: Callable[[Item], Found], item: Item
    ) -> Found:
        worker = self.free.pop()
        finished = False
        try:
            pending = await asyncio.to_thread(worker.begin, work, item)
            found: asyncio.Future[Found] = asyncio.wrap_future(pending)
            either: set[asyncio.Future[Any]] = {found, gone}
            await asyncio.wait(either, return_when=asyncio.FIRST_COMPLETED)
            finished = found.done()
            if not finished:
                # Not cancelled: its process is killed, and that is its answer.
                found.add_done_callback(_looked_at)
                raise RequestError(499, "nobody waits for this any more")
            return found.result()
        finally:
            if not finished:
                # At work for nobody, or never started.
                await asyncio.to_thread(worker.end)
            self.free.append(worker)

    def end(self) -> None:
        """Kill all of them."""
        for worker in self.free:
            worker.end()


def _looked_at(done: asyncio.Future[Any]) -> None:
    """Take an exception that nobody waits for any more."""
    if not done.cancelled():
        done.exception()


async def _gone(request: Request) -> None:
    """Return when who asked has gone away."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
