"""Loops where numba is not installed: Python runs them as they are written, slowly.

A report solves a few small problems with them; whoever computes needs the extra `analysis` (`host.require`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])


def njit(function: Function | None = None, **_: Any) -> Any:
    """Return a loop as it is, whatever the options of numba's `njit`."""
    return inner() if function is None else function


def inner(**_: Any) -> Callable[[Function], Function]:
    """Return the decorator that leaves a loop as it is."""
    return lambda function: function
