"""Actions that the client asks of network and clock, as data that a driver performs, blocking or awaiting.

An operation of the client is a generator. It yields actions, receives their answers, or the exceptions they
raised, and returns its result. It knows no socket and no event loop, so both clients run the same code.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import httpx2

T = TypeVar("T")


@dataclass(frozen=True)
class Send:
    """Send a request; the answer is an `httpx2.Response`, read to its end. `options` are those of httpx2."""

    method: str
    path: str
    options: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Open(Send):
    """Send a request; the answer is a `Stream`. The body of a refusal is read, any other is not."""


@dataclass(frozen=True)
class Stream:
    """An answer whose body comes piece by piece, and the driver's iterator of the pieces."""

    response: httpx2.Response
    pieces: Any


@dataclass(frozen=True)
class Piece:
    """Take the next piece of a body; the answer is bytes, None at its end."""

    stream: Stream


@dataclass(frozen=True)
class Pause:
    """Action: do nothing for this number of seconds."""

    seconds: float


@dataclass(frozen=True)
class Item(Generic[T]):
    """Hand an item to who iterates; there is no answer."""

    value: T


Steps = Generator[Send | Piece | Pause, Any, T]
"""An operation with one result."""
Items = Generator[Send | Piece | Pause | Item[T], Any, None]
"""An operation that yields items. A driver closes its connection when the iteration ends early."""
