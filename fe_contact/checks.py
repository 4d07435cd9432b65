"""Checks of single values, each raising one clear `InputError`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

import numpy as np

from fe_contact.errors import InputError
from fe_contact.types import FloatArray

LIMIT_SLACK = 1e-12
"""Relative rounding of a computed limit, which its printed form does not show."""


def rounded_up(limit: float) -> str:
    """Return a lower limit as text of seven digits that is accepted when it is typed."""
    return _rounded(limit, ROUND_CEILING)


def rounded_down(limit: float) -> str:
    """Return an upper limit as text of seven digits that is accepted when it is typed."""
    return _rounded(limit, ROUND_FLOOR)


def finite(field: str, value: float, suggestion: str = "") -> float:
    """Return `value` as a float if it is a finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not math.isfinite(value):
        raise InputError(field, value, "a finite number", suggestion)
    return float(value)


def within(field: str, value: float, low: float, high: float, suggestion: str = "") -> float:
    """Return `value` if low <= value <= high."""
    number = finite(field, value, suggestion)
    if not low - LIMIT_SLACK * abs(low) <= number <= high + LIMIT_SLACK * abs(high):
        raise InputError(field, value, f"from {rounded_up(low)} to {rounded_down(high)}", suggestion)
    return number


def positive(field: str, value: float, suggestion: str = "") -> float:
    """Return `value` if it is finite and above zero."""
    number = finite(field, value, suggestion)
    if number <= 0.0:
        raise InputError(field, value, "above 0", suggestion)
    return number


def integer(field: str, value: int, low: int, high: int, suggestion: str = "") -> int:
    """Return `value` if it is an integer from `low` to `high`."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
        raise InputError(field, value, f"an integer from {low} to {high}", suggestion)
    return int(value)


def increasing(field: str, values: Sequence[float] | FloatArray, suggestion: str = "") -> FloatArray:
    """Return `values` as a 1-D array if it is non-empty, finite and strictly increasing."""
    array = np.atleast_1d(np.asarray(values, dtype=float))
    if array.ndim != 1 or array.size == 0 or not np.all(np.isfinite(array)):
        raise InputError(field, values, "a non-empty list of finite numbers", suggestion)
    if np.any(np.diff(array) <= 0.0):
        raise InputError(
            field, values, "strictly increasing", suggestion or "Sort the list and drop repeats."
        )
    return array


def _rounded(limit: float, direction: str) -> str:
    """Return seven digits of a limit, rounding of its own computation (`LIMIT_SLACK`) left aside."""
    if not math.isfinite(limit):
        return f"{limit:g}"
    exact = Decimal(f"{limit:.13g}")
    last_digit = Decimal(1).scaleb(exact.adjusted() - 6)
    return f"{float(exact.quantize(last_digit, rounding=direction)):.7g}"
