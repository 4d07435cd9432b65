"""Functions of frozen data, such as a table or a scene, that keep their results by its identity."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any, TypeVar, cast

MAX_CACHED = 8
"""Most results per function, the last ones. They keep their arguments alive, so that an identity stays
unique.
"""

Function = TypeVar("Function", bound=Callable[..., Any])


Parts = Callable[[Any], tuple[Any, ...]]
_BY_VALUE = (tuple, str)


def _itself(data: Any) -> tuple[Any, ...]:
    return (data,)


def _key(part: Any) -> Any:
    """Return the key of a part: of tuples the keys of their items, of names their letters, else identity."""
    kind = type(part)
    if kind is tuple:
        return tuple([_key(item) if type(item) in _BY_VALUE else id(item) for item in part])
    return part if kind is str else id(part)


class _Identity:
    """Data by the identity of its parts: arrays have no hash."""

    __slots__ = ("data", "parts")

    def __init__(self, data: Any, parts: tuple[Any, ...]) -> None:
        self.data = data
        self.parts = _key(parts)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Identity) and self.parts == other.parts

    def __hash__(self) -> int:
        return hash(self.parts)


def identity_cached(make: Function) -> Function:
    """Return `make`, which then returns the same object for the same data and equal further arguments.

    A tuple is the same if its parts are, a name if its letters are. Data and results are frozen: who changes
    an array in place gets what was made before.
    """
    return cached_by(_itself)(make)


def cached_by(parts: Parts) -> Callable[[Function], Function]:
    """Return `identity_cached` for data that is the same if the `parts` of it are that `make` reads."""

    def cached(make: Function) -> Function:
        @lru_cache(maxsize=MAX_CACHED)
        def cached_value(identity: _Identity, *args: Any) -> Any:
            return make(identity.data, *args)

        @wraps(make)
        def of(data: Any, *args: Any) -> Any:
            return cached_value(_Identity(data, parts(data)), *args)

        return cast(Function, of)

    return cached
