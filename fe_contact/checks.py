"""Checks of single values, each raising one clear `InputError`."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fe_contact.errors import InputError
from fe_contact.types import FloatArray


def finite(field: str, value: float, suggestion: str = "") -> float:
    """Return `value` as a float if it is a finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not math.isfinite(value):
        raise InputError(field, value, "a finite number", suggestion)
    return float(value)


def within(field: str, value: float, low: float, high: float, suggestion: str = "") -> float:
    """Return `value` if low <= value <= high."""
    number = finite(field, value, suggestion)
    if not low <= number <= high:
        raise InputError(field, value, f"from {low:g} to {high:g}", suggestion)
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
