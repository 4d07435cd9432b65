"""What callers hold at the same time: connections, event streams."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from service.problems import TooManyHeld

_AGAIN_S = 1


class Held:
    """Counts of one kind by the names of their holders, in one event loop of one server process.

    Parameters
    ----------
    what : str
        The kind, plural.
    """

    def __init__(self, what: str) -> None:
        self._what, self._held = what, Counter[str]()

    @contextmanager
    def one(self, name: str, most: int | None) -> Iterator[None]:
        """Hold one more while the context lasts; raises `TooManyHeld` beyond `most`."""
        if most is not None and self._held[name] >= most:
            text = f"Key {name!r} holds {most} {self._what}, its limit. End one of them, or try again."
            raise TooManyHeld.after(_AGAIN_S, text)
        self._held[name] += 1
        try:
            yield
        finally:
            self._held[name] -= 1
            if not self._held[name]:
                del self._held[name]
