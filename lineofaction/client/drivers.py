"""Drivers of the operations of a client: one that blocks, one that awaits.

An operation, or its steps, is a generator of actions: to send a request, to take a piece of a body, to pause.
A driver performs each action and sends the answer into the generator, see `lineofaction.client.steps`.
"""

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
    """The progress of an operation.

    A driver takes the next action with `action`, performs it, and returns its answer with `answer` or its
    exception with `fail`.
    """

    def __init__(self, steps: Generator[Any, Any, T]) -> None:
        self._steps = steps
        self.answer(None)  # a generator starts with None

    def action(self) -> Any:
        """Return the next action; raises `StopIteration` with the result, or the operation's exception."""
        return self._advance(self._reply)

    def answer(self, reply: Any) -> None:
        """Give the answer to an action."""
        self._advance: Callable[[Any], Any] = self._steps.send
        self._reply = reply

    def fail(self, error: BaseException) -> None:
        """Give the exception that an action raised; the operation handles it or passes it on."""
        self._advance, self._reply = self._steps.throw, error


class BlockingDriver:
    """Performs steps over HTTP connections of this driver, blocking; threads may share it.

    Parameters
    ----------
    transport : httpx2.BaseTransport, optional
        Replaces the network, for tests.
    options : dict
        Options of `httpx2.Client`.
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
                    self._answer(course, course.action(), streams)
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
                    self._answer(course, action, streams)

    def map(self, operations: Iterable[Steps[T]], concurrency: int) -> Iterator[T]:
        """Perform operations at the same time in this thread; yield their results in order.

        While an operation pauses, others proceed. At most `concurrency` operations are started or have a
        result that waits for its turn. The exception of an operation is raised in its turn and ends the
        iteration.
        """
        source = iter(operations)
        window = deque[_Started[T]]()
        with ExitStack() as streams:
            while True:
                window.extend(_Started(_Course(steps)) for steps in islice(source, concurrency - len(window)))
                if not window:
                    return
                while not window[0].ended:
                    running = (operation for operation in window if not operation.ended)
                    earliest = min(running, key=lambda operation: operation.due)
                    self._until_pause(earliest, streams)
                first = window.popleft()
                if first.error is not None:
                    raise first.error
                yield cast("T", first.value)

    def _until_pause(self, operation: _Started[Any], streams: ExitStack) -> None:
        """Perform the actions of an operation until it pauses or ends."""
        time.sleep(max(operation.due - time.monotonic(), 0.0))
        try:
            action = operation.course.action()
            while not isinstance(action, Pause):
                self._answer(operation.course, action, streams)
                action = operation.course.action()
            operation.due = time.monotonic() + action.seconds
            operation.course.answer(None)
        except StopIteration as end:
            operation.ended = True
            operation.value = end.value
        except Exception as error:  # noqa: BLE001 (raised in its turn)
            operation.ended = True
            operation.error = error

    def _answer(self, course: _Course[Any], action: Send | Piece | Pause, streams: ExitStack) -> None:
        """Perform an action and give its answer or its exception to the operation.

        `streams` closes the responses that the operation opened.
        """
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
                    response.read()  # the body says why the request was refused
                return Stream(response, response.iter_bytes())
            case Send():
                return self._http.request(action.method, action.path, **action.options)
            case Piece():
                return next(action.stream.pieces, None)  # None: the end of the body
            case Pause():
                return time.sleep(action.seconds)


@dataclass
class _Started(Generic[T]):
    """An operation of `BlockingDriver.map`, and its result or exception once it has ended."""

    course: _Course[T]
    due: float = 0.0
    """Time of the monotonic clock, s, at which its pause ends."""
    ended: bool = False
    value: T | None = None
    error: Exception | None = None


class AwaitingDriver:
    """Performs steps over HTTP connections of this driver, awaiting.

    Parameters are those of `BlockingDriver`; the transport is an `httpx2.AsyncBaseTransport`.
    """

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
                    await self._answer(course, course.action(), streams)
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
                    await self._answer(course, action, streams)

    async def map(self, operations: Iterable[Steps[T]], concurrency: int) -> AsyncGenerator[T, None]:
        """Perform operations at the same time; yield their results in order.

        At most `concurrency` operations are started or have a result that waits for its turn. The exception
        of an operation is raised in its turn; the other operations are then cancelled.
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

    async def _answer(
        self, course: _Course[Any], action: Send | Piece | Pause, streams: AsyncExitStack
    ) -> None:
        """Perform an action and give its answer or its exception to the operation."""
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
                    await response.aread()  # the body says why the request was refused
                return Stream(response, response.aiter_bytes())
            case Send():
                return await self._http.request(action.method, action.path, **action.options)
            case Piece():
                return await anext(action.stream.pieces, None)  # None: the end of the body
            case Pause():
                return await asyncio.sleep(action.seconds)
