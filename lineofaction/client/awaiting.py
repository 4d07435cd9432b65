"""The driver that awaits: the steps of many tasks of one event loop."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncGenerator, AsyncIterator, Iterable
from contextlib import AsyncExitStack
from typing import Any, TypeVar

import httpx2

from lineofaction.client.steps import Course, Item, Items, Open, Pause, Piece, Send, Steps, Stream

T = TypeVar("T")


class AwaitingDriver:
    """Performs steps on a network of its own; as `BlockingDriver`, with `httpx2.AsyncBaseTransport`."""

    def __init__(self, transport: httpx2.AsyncBaseTransport | None, options: dict[str, Any]) -> None:
        self._http = httpx2.AsyncClient(transport=transport, **options)

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def run(self, steps: Steps[T]) -> T:
        """Perform steps to their end; return their result."""
        course = Course(steps)
        async with AsyncExitStack() as streams:
            try:
                while True:
                    await self._go_on(course, course.action(), streams)
            except StopIteration as end:
                result: T = end.value
                return result

    async def iterate(self, steps: Items[T]) -> AsyncIterator[T]:
        """Perform steps; yield the items they hand out."""
        course = Course(steps)
        async with AsyncExitStack() as streams:
            while True:
                try:
                    action = course.action()
                except StopIteration:
                    return
                if isinstance(action, Item):
                    yield action.value
                    course.answer(None)
                else:
                    await self._go_on(course, action, streams)

    async def map(self, operations: Iterable[Steps[T]], concurrency: int) -> AsyncGenerator[T, None]:
        """Perform operations side by side; yield their results in order.

        At most `concurrency` are begun or wait to be yielded. What one raises is raised in its turn; the
        others are then cancelled.
        """
        window: deque[asyncio.Task[T]] = deque()
        try:
            for steps in operations:
                window.append(asyncio.create_task(self.run(steps)))
                if len(window) == concurrency:
                    yield await window.popleft()
            while window:
                yield await window.popleft()
        finally:
            for task in window:
                task.cancel()
            await asyncio.gather(*window, return_exceptions=True)

    async def _go_on(
        self, course: Course[Any], action: Send | Piece | Pause, streams: AsyncExitStack
    ) -> None:
        """Perform an action and give back what came of it."""
        try:
            course.answer(await self._perform(action, streams))
        except BaseException as error:  # noqa: BLE001 (whatever it is, the operation decides)
            course.fail(error)

    async def _perform(self, action: Send | Piece | Pause, streams: AsyncExitStack) -> Any:
        """Perform an action; return its answer."""
        match action:
            case Open():
                response = await streams.enter_async_context(
                    self._http.stream(action.method, action.path, **action.options)
                )
                if not response.is_success:
                    await response.aread()
                return Stream(response, response.aiter_bytes())
            case Send():
                return await self._http.request(action.method, action.path, **action.options)
            case Piece():
                return await anext(action.stream.pieces, None)
            case Pause():
                return await asyncio.sleep(action.seconds)
