"""Functions of frozen data, such as a table or a scene, that keep their results by its identity."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any, TypeVar, cast

KEPT = 8
"""Results per function, the last ones. They keep what they are made from alive: an identity stays its own."""

Function = TypeVar("Function", bound=Callable[..., Any])


class _Identity:
    """Data by its identity: arrays have no hash."""

    __slots__ = ("data",)

    def __init__(self, data: Any) -> None:
        self.data = data

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Identity) and self.data is other.data

    def __hash__(self) -> int:
        return id(self.data)


def identity_cached(make: Function) -> Function:
    """Return `make`, which then returns the same object for the same data and equal further arguments.

    Data and results are frozen: who changes an array in place gets what was made before.
    """

    @lru_cache(maxsize=KEPT)
    def kept(identity: _Identity, *args: Any) -> Any:
        return make(identity.data, *args)

    @wraps(make)
    def of(data: Any, *args: Any) -> Any:
        return kept(_Identity(data), *args)

    return cast(Function, of)
