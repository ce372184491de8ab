"""Worker processes, each lent to one request at a time, and killed when that is cancelled."""

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


class Workers:
    """Some worker processes, started when they are first needed.

    Parameters
    ----------
    count : int
        Number of processes.
    """

    def __init__(self, count: int) -> None:
        self.count, self.waiting = count, 0
        self.free = [Worker() for _ in range(count)]
        self.turn = asyncio.Semaphore(count)

    async def done(
        self, request: Request, work: Callable[[Item], Found], item: Item, begun: bool = False
    ) -> Found:
        """Return the answer of a worker, as long as somebody waits for it.

        Parameters
        ----------
        request : Request
            A request whose body has been read; if its sender disconnects, the worker is killed.
        work : callable
        item : object
        begun : bool
            Whether it continues a study, which then waits, however many others do: refused, it
            would lose what it has found.

        Raises
        ------
        RequestError
            If too many are waiting already, or the sender has disconnected.
        """
        if not begun and self.waiting >= self.count * EXPLORE.waiting:
            raise RequestError(503, "too many studies are waiting; try again in a while")
        # A task of its own: the worker is put back in order even if who waits is cancelled.
        lent = asyncio.create_task(self._lent(request, work, item))
        lent.add_done_callback(_looked_at)
        return await asyncio.shield(lent)

    async def _lent(self, request: Request, work: Callable[[Item], Found], item: Item) -> Found:
        gone = asyncio.ensure_future(_gone(request))
        self.waiting += 1
        try:
            async with self.turn:
                if gone.done():
                    raise RequestError(499, "no one is waiting for this any more")
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
                # Not cancelled: it ends by itself when its process is killed.
                found.add_done_callback(_looked_at)
                raise RequestError(499, "no one is waiting for this any more")
            return found.result()
        finally:
            if not finished:
                # Working for nobody, or never started.
                await asyncio.to_thread(worker.end)
            self.free.append(worker)

    def end(self) -> None:
        """Kill all workers that are not lent."""
        for worker in self.free:
            worker.end()


def _looked_at(done: asyncio.Future[Any]) -> None:
    """Retrieve an exception that nobody waits for any more."""
    if not done.cancelled():
        done.exception()


async def _gone(request: Request) -> None:
    """Return when the sender of a request has disconnected."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
