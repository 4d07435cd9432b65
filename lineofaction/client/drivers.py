"""Drivers of the operations of a client: one that blocks, one that awaits."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Generator, Iterable, Iterator
from contextlib import AsyncExitStack, ExitStack
from dataclasses import dataclass
from itertools import islice
from typing import Any, Generic, TypeVar, cast

import httpx2

from lineofaction.client.steps import Item, Items, Open, Pause, Piece, Send, Steps, Stream

T = TypeVar("T")


class _Course(Generic[T]):
    """How far an operation is: a driver takes its next action, performs it and gives back what came of it."""

    def __init__(self, steps: Generator[Any, Any, T]) -> None:
        self._steps = steps
        self.answer(None)

    def action(self) -> Any:
        """Return the next action; raises `StopIteration` with the result, or what the operation raises."""
        return self._advance(self._reply)

    def answer(self, reply: Any) -> None:
        """Give the answer to an action."""
        self._advance: Callable[[Any], Any] = self._steps.send
        self._reply = reply

    def fail(self, error: BaseException) -> None:
        """Give what an action raised; the operation decides what becomes of it."""
        self._advance, self._reply = self._steps.throw, error


class BlockingDriver:
    """Performs steps on a network of its own; threads may share it.

    Parameters
    ----------
    transport : httpx2.BaseTransport, optional
        Replaces the network, for tests.
    options : dict
        Of the client of httpx2.
    """

    def __init__(self, transport: httpx2.BaseTransport | None, options: dict[str, Any]) -> None:
        self._http = httpx2.Client(transport=transport, **options)

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def run(self, steps: Steps[T]) -> T:
        """Perform steps to their end; return their result."""
        course = _Course(steps)
        with ExitStack() as streams:
            try:
                while True:
                    self._go_on(course, course.action(), streams)
            except StopIteration as end:
                result: T = end.value
                return result

    def iterate(self, steps: Items[T]) -> Iterator[T]:
        """Perform steps; yield the items they hand out."""
        course = _Course(steps)
        with ExitStack() as streams:
            while True:
                try:
                    action = course.action()
                except StopIteration:
                    return
                if isinstance(action, Item):
                    yield action.value
                    course.answer(None)
                else:
                    self._go_on(course, action, streams)

    def map(self, operations: Iterable[Steps[T]], concurrency: int) -> Iterator[T]:
        """Perform operations side by side in this thread; yield their results in order.

        While one pauses, others go on; at most `concurrency` are begun or wait to be yielded. What one
        raises is raised in its turn and ends the iteration.
        """
        source, window = iter(operations), deque[_Begun[T]]()
        with ExitStack() as streams:
            while True:
                window.extend(_Begun(_Course(steps)) for steps in islice(source, concurrency - len(window)))
                if not window:
                    return
                while not window[0].ended:
                    under_way = (operation for operation in window if not operation.ended)
                    self._until_pause(min(under_way, key=lambda begun: begun.due), streams)
                first = window.popleft()
                if first.error is not None:
                    raise first.error
                yield cast("T", first.value)

    def _until_pause(self, begun: _Begun[Any], streams: ExitStack) -> None:
        """Perform what an operation wants until it pauses or ends."""
        time.sleep(max(begun.due - time.monotonic(), 0.0))
        try:
            while not isinstance(action := begun.course.action(), Pause):
                self._go_on(begun.course, action, streams)
            begun.due = time.monotonic() + action.seconds
            begun.course.answer(None)
        except StopIteration as end:
            begun.ended, begun.value = True, end.value
        except Exception as error:  # noqa: BLE001 (raised in its turn)
            begun.ended, begun.error = True, error

    def _go_on(self, course: _Course[Any], action: Send | Piece | Pause, streams: ExitStack) -> None:
        try:
            course.answer(self._perform(action, streams))
        except BaseException as error:  # noqa: BLE001 (whatever it is, the operation decides)
            course.fail(error)

    def _perform(self, action: Send | Piece | Pause, streams: ExitStack) -> Any:
        match action:
            case Open():
                response = streams.enter_context(
                    self._http.stream(action.method, action.path, **action.options)
                )
                if not response.is_success:
                    response.read()
                return Stream(response, response.iter_bytes())
            case Send():
                return self._http.request(action.method, action.path, **action.options)
            case Piece():
                return next(action.stream.pieces, None)
            case Pause():
                return time.sleep(action.seconds)


@dataclass
class _Begun(Generic[T]):
    """An operation of `BlockingDriver.map`: how it goes on, and when."""

    course: _Course[T]
    due: float = 0.0
    ended: bool = False
    value: T | None = None
    error: Exception | None = None


class AwaitingDriver:
    """Performs steps on a network of its own; as `BlockingDriver`, with `httpx2.AsyncBaseTransport`."""

    def __init__(self, transport: httpx2.AsyncBaseTransport | None, options: dict[str, Any]) -> None:
        self._http = httpx2.AsyncClient(transport=transport, **options)

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def run(self, steps: Steps[T]) -> T:
        """Perform steps to their end; return their result."""
        course = _Course(steps)
        async with AsyncExitStack() as streams:
            try:
                while True:
                    await self._go_on(course, course.action(), streams)
            except StopIteration as end:
                result: T = end.value
                return result

    async def iterate(self, steps: Items[T]) -> AsyncIterator[T]:
        """Perform steps; yield the items they hand out."""
        course = _Course(steps)
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
        self, course: _Course[Any], action: Send | Piece | Pause, streams: AsyncExitStack
    ) -> None:
        try:
            course.answer(await self._perform(action, streams))
        except BaseException as error:  # noqa: BLE001 (whatever it is, the operation decides)
            course.fail(error)

    async def _perform(self, action: Send | Piece | Pause, streams: AsyncExitStack) -> Any:
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
