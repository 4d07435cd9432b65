"""Compiled loops by unmodified numba, without its cache, which does not see the loops that one calls."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def njit(function: Callable[..., Any] | None = None, *, cache: bool = False, **options: Any) -> Any:
    """Compile a loop that Python calls, with options of numba's `njit`; `cache` is for shared loops."""
    decorator = numba.njit(**options)
    return decorator if function is None else decorator(function)


def inner(**options: Any) -> Callable[[Function], Function]:
    """Compile a loop that loops call, with options of `njit`."""
    decorator: Callable[[Function], Function] = numba.njit(**options)
    return decorator
