"""The base of the client's operations, each written once: one client blocks in it, the other awaits it.

An operation is written as a generator of steps (`lineofaction.client.steps`): a step is a request or a pause.
The driver of a blocking client performs the steps and returns the result; that of an awaiting client awaits
them.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Coroutine, Iterator, Mapping
from dataclasses import dataclass, field
from functools import wraps
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar, overload

from lineofaction.client.cache import ResultCache
from lineofaction.client.drivers import AwaitingDriver, BlockingDriver
from lineofaction.client.exchange import Exchange
from lineofaction.client.status import Watch
from lineofaction.client.steps import Items, Steps

T = TypeVar("T")
P = ParamSpec("P")


@dataclass(frozen=True)
class Session:
    """State that all operations on one service share."""

    exchange: Exchange
    cache: ResultCache
    patience: float
    """Seconds for which the service may be away while a job is waited for."""
    progress: Watch | None
    """Function that is called with every new state of any job that the client waits for; None: none."""
    terms: Mapping[str, Any] = field(default_factory=dict)
    """Terms of every submission beside its inputs, such as title and tags, as the body of the request has
    them."""


class Surface:
    """Whatever has operations on a service: a client, a job."""

    session: Session
    driver: Any


class Blocking(Surface):
    """A surface whose operations return their results."""

    driver: BlockingDriver


class Awaiting(Surface):
    """A surface whose operations are awaited."""

    driver: AwaitingDriver


class _Method:
    """A descriptor that makes a method of a generator of steps.

    As an attribute of an object it is a method whose steps the driver of the object performs. As an attribute
    of a class it is the generator itself, for other operations to ``yield from``.
    """

    _verb: str
    """Name of the method of the driver that performs the steps."""

    def __init__(self, steps: Callable[..., Any]) -> None:
        self._steps = steps

    def _of(self, surface: Any) -> Callable[..., Any]:
        """Return the generator if `surface` is None, else the method of `surface`."""
        steps = self._steps
        if surface is None:
            return steps

        @wraps(steps)
        def perform(*args: Any, **kwargs: Any) -> Any:
            return getattr(surface.driver, self._verb)(steps(surface, *args, **kwargs))

        return perform


class Operation(_Method, Generic[P, T]):
    """A method with one result."""

    _verb = "run"

    def __init__(self, steps: Callable[Concatenate[Any, P], Steps[T]]) -> None:
        super().__init__(steps)

    @overload
    def __get__(self, surface: None, owner: type) -> Callable[Concatenate[Any, P], Steps[T]]: ...
    @overload
    def __get__(self, surface: Blocking, owner: type) -> Callable[P, T]: ...
    @overload
    def __get__(self, surface: Awaiting, owner: type) -> Callable[P, Coroutine[Any, Any, T]]: ...
    def __get__(self, surface: Any, owner: type) -> Callable[..., Any]:
        """Return the generator for the class, and the method for an object."""
        return self._of(surface)


class Listing(_Method, Generic[P, T]):
    """A method that yields items."""

    _verb = "iterate"

    def __init__(self, steps: Callable[Concatenate[Any, P], Items[T]]) -> None:
        super().__init__(steps)

    @overload
    def __get__(self, surface: None, owner: type) -> Callable[Concatenate[Any, P], Items[T]]: ...
    @overload
    def __get__(self, surface: Blocking, owner: type) -> Callable[P, Iterator[T]]: ...
    @overload
    def __get__(self, surface: Awaiting, owner: type) -> Callable[P, AsyncIterator[T]]: ...
    def __get__(self, surface: Any, owner: type) -> Callable[..., Any]:
        """Return the generator for the class, and the method for an object."""
        return self._of(surface)


operation, listing = Operation, Listing
"""The two classes as decorators of generators: `operation` of a generator of steps, `listing` of a generator
of steps and items.
"""
