"""What event streams share: their events, and a count of those open."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


class JobEvent(NamedTuple):
    """A state of a job as all its streams send it, made once.

    Attributes
    ----------
    id : str
        When the state changed last, RFC 3339: a browser that reconnects names it (``Last-Event-ID``).
    text : bytes
        The server-sent event.
    last : bool
        Whether nothing more happens to the job.
    """

    id: str
    text: bytes
    last: bool


@dataclass
class Streams:
    """A count with a bound, of one event loop, so without a lock.

    Attributes
    ----------
    most : int
        Streams that may be open at once.
    """

    most: int = 256
    _open: int = 0

    def enter(self) -> bool:
        """Count one more; False: there is no room."""
        if self._open >= self.most:
            return False
        self._open += 1
        return True

    def leave(self) -> None:
        """Count one less."""
        self._open -= 1
