"""The driver that blocks: one thread performs the steps, one action after the other."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import islice
from typing import Any, Generic, TypeVar, cast

import httpx2

from lineofaction.client.steps import Course, Item, Items, Open, Pause, Piece, Send, Steps, Stream

T = TypeVar("T")


class BlockingDriver:
    """Performs steps on a network of its own; threads may share it.

    Parameters
    ----------
    transport : httpx2.BaseTransport, optional
        Replaces the network, for tests.
    options : dict
        Of `address.http_options`.
    """

    def __init__(self, transport: httpx2.BaseTransport | None, options: dict[str, Any]) -> None:
        self._http = httpx2.Client(transport=transport, **options)

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def run(self, steps: Steps[T]) -> T:
        """Perform steps to their end; return their result."""
        course = Course(steps)
        with ExitStack() as streams:
            try:
                while True:
                    self._go_on(course, course.action(), streams)
            except StopIteration as end:
                result: T = end.value
                return result

    def iterate(self, steps: Items[T]) -> Iterator[T]:
        """Perform steps; yield the items they hand out."""
        course = Course(steps)
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
                window.extend(_Begun(Course(steps)) for steps in islice(source, concurrency - len(window)))
                if not window:
                    return
                while not window[0].ended:
                    self._until_pause(min((each for each in window if not each.ended), key=_due), streams)
                yield window.popleft().result()

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

    def _go_on(self, course: Course[Any], action: Send | Piece | Pause, streams: ExitStack) -> None:
        """Perform an action and give back what came of it."""
        try:
            course.answer(self._perform(action, streams))
        except BaseException as error:  # noqa: BLE001 (whatever it is, the operation decides)
            course.fail(error)

    def _perform(self, action: Send | Piece | Pause, streams: ExitStack) -> Any:
        """Perform an action; return its answer."""
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

    course: Course[T]
    due: float = 0.0
    ended: bool = False
    value: T | None = None
    error: Exception | None = None

    def result(self) -> T:
        """Return what it returned, or raise what it raised."""
        if self.error is not None:
            raise self.error
        return cast("T", self.value)


def _due(begun: _Begun[Any]) -> float:
    return begun.due
