"""What a client offers, written once: operations that block in one client and are awaited in the other."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Coroutine, Iterator, Mapping
from dataclasses import dataclass, field
from functools import wraps
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar, overload

from lineofaction.client.awaiting import AwaitingDriver
from lineofaction.client.blocking import BlockingDriver
from lineofaction.client.cache import ResultCache
from lineofaction.client.exchange import Exchange
from lineofaction.client.status import Watch
from lineofaction.client.steps import Items, Steps

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True)
class Session:
    """What all operations on one service share.

    Attributes
    ----------
    exchange : Exchange
    cache : ResultCache
    patience : float
        Seconds for which the service may be away while a job is waited for.
    progress : callable, optional
        Called with every state seen of any job that is waited for.
    terms : mapping
        What every submission asks beside its inputs: title, tags, as in its body.
    """

    exchange: Exchange
    cache: ResultCache
    patience: float
    progress: Watch | None
    terms: Mapping[str, Any] = field(default_factory=dict)


class Surface:
    """Whatever has operations on a service: a client, a job."""

    session: Session


class Blocking(Surface):
    """A surface whose operations return their results."""

    driver: BlockingDriver


class Awaiting(Surface):
    """A surface whose operations are awaited."""

    driver: AwaitingDriver


class Operation(Generic[P, T]):
    """A method with one result, made of a method that is a generator of steps.

    On the class it is the generator, for other operations to ``yield from``.
    """

    def __init__(self, steps: Callable[Concatenate[Any, P], Steps[T]]) -> None:
        self._steps = steps

    @overload
    def __get__(self, surface: None, owner: type) -> Callable[Concatenate[Any, P], Steps[T]]: ...
    @overload
    def __get__(self, surface: Blocking, owner: type) -> Callable[P, T]: ...
    @overload
    def __get__(self, surface: Awaiting, owner: type) -> Callable[P, Coroutine[Any, Any, T]]: ...
    def __get__(self, surface: Any, owner: type) -> Callable[..., Any]:
        """Return the generator of a class, the method of an object."""
        steps = self._steps
        if surface is None:
            return steps

        @wraps(steps)
        def perform(*args: P.args, **kwargs: P.kwargs) -> Any:
            return surface.driver.run(steps(surface, *args, **kwargs))

        return perform


class Listing(Generic[P, T]):
    """A method that yields items, made of a method that is a generator of steps and items."""

    def __init__(self, steps: Callable[Concatenate[Any, P], Items[T]]) -> None:
        self._steps = steps

    @overload
    def __get__(self, surface: None, owner: type) -> Callable[Concatenate[Any, P], Items[T]]: ...
    @overload
    def __get__(self, surface: Blocking, owner: type) -> Callable[P, Iterator[T]]: ...
    @overload
    def __get__(self, surface: Awaiting, owner: type) -> Callable[P, AsyncIterator[T]]: ...
    def __get__(self, surface: Any, owner: type) -> Callable[..., Any]:
        """Return the generator of a class, the method of an object."""
        steps = self._steps
        if surface is None:
            return steps

        @wraps(steps)
        def iterate(*args: P.args, **kwargs: P.kwargs) -> Any:
            return surface.driver.iterate(steps(surface, *args, **kwargs))

        return iterate


def operation(steps: Callable[Concatenate[Any, P], Steps[T]]) -> Operation[P, T]:
    """Make an operation of a generator of steps."""
    return Operation(steps)


def listing(steps: Callable[Concatenate[Any, P], Items[T]]) -> Listing[P, T]:
    """Make a listing of a generator of steps and items."""
    return Listing(steps)
