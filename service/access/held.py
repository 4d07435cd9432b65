"""What callers hold at the same time: requests, bodies under way, event streams."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from lineofaction.gearbox.problems import TooManyHeld, TooManyRequests

_AGAIN_S = 1
NOBODY = ""
"""Holder of what callers without a key hold."""


class Held:
    """Counts of one kind by the names of their holders, in one event loop of one server process.

    Parameters
    ----------
    what : str
        The kind, plural.
    in_all : int, optional
        Most of all holders together.
    """

    def __init__(self, what: str, in_all: int | None = None) -> None:
        self._what, self._in_all, self._held = what, in_all, Counter[str]()

    def refuse_beyond(self, name: str, most: int | None) -> None:
        """Raise `TooManyHeld` if a holder has `most`, `TooManyRequests` if all together have theirs."""
        if most is not None and self._held[name] >= most:
            who = "Callers without a key hold" if name == NOBODY else f"Key {name!r} holds"
            text = f"{who} {most} {self._what}, the limit. End one of them, or try again."
            raise TooManyHeld.after(_AGAIN_S, text)
        if self._in_all is not None and self._held.total() >= self._in_all:
            raise TooManyRequests(f"There are {self._in_all} {self._what} in all. Try again soon.")

    @contextmanager
    def one(self, name: str) -> Iterator[None]:
        """Hold one more while the context lasts."""
        self._held[name] += 1
        try:
            yield
        finally:
            self._held[name] -= 1
            if not self._held[name]:
                del self._held[name]
