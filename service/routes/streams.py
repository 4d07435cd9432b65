"""Count of open event streams; of one event loop, so without a lock."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Streams:
    """A count with a bound.

    Attributes
    ----------
    most : int
        Streams that may be open at once.
    """

    most: int = 64
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
