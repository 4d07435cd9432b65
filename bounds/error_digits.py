"""A number and its error as text, with as many digits as the error leaves significant.

A place counts the decimals behind the point; a negative place is left of the point.
"""

from __future__ import annotations

import math

from bounds.unit import engineering

DIGITS_OF_ERROR = 2
"""Significant digits of an error: the second one changes no decision, a third would be noise."""
MAX_DIGITS = 7
"""Significant digits of a number whose error is very small, or zero: more are rounding, not a result."""
DIGITS_WITHOUT_ERROR = 4
"""Significant digits of a number whose error is not known."""
NONE = "none"
"""Text of a number that is none (NaN, infinite)."""
NO_CHANGE = "no change"
"""Text of a change that is below its error."""
MAX_PLACE = 9
"""Decimal places up to which a number is written plainly; smaller ones have an exponent."""


def with_error(value: float, error: float, unit: str = "") -> str:
    """Write a number with its error, "9.786 ± 0.035 µm": both end with the second digit of the error.

    Parameters
    ----------
    value : float
        Number in `unit`.
    error : float
        Half-width of the error band, in `unit`, >= 0; not finite: the number stands alone.
    unit : str
        Symbol behind both.
    """
    if not math.isfinite(value):
        return NONE
    band = f" ± {error_text(value, error)}" if math.isfinite(error) else ""
    return f"{to_error(value, error)}{band} {unit}".rstrip()


def to_error(value: float, error: float, sign: str = "") -> str:
    """Write a number up to the second digit of its error.

    Parameters
    ----------
    value, error : float
        As of `with_error`.
    sign : str
        "+": positive numbers have their sign too.
    """
    if not math.isfinite(value):
        return NONE
    if not math.isfinite(error):
        return _fixed(value, _place_of_digit(value, DIGITS_WITHOUT_ERROR), sign)
    if error == 0.0:
        return engineering(value, MAX_DIGITS, sign)
    return _fixed(value, _last_place(value, error), sign)


def change_text(change: float, error: float) -> str:
    """Write a change with its sign, up to its error; one below its error is none.

    Parameters
    ----------
    change, error : float
        As `value` and `error` of `with_error`.
    """
    if not math.isfinite(change):
        return NONE
    if change == 0.0 or (math.isfinite(error) and abs(change) <= error):
        return NO_CHANGE
    return to_error(change, error, "+")


def error_text(value: float, error: float) -> str:
    """Write the error of a number, up to the same place as `to_error` writes the number."""
    place = _last_place(value, error)
    return _fixed(error, max(place, _place_of_digit(error, DIGITS_OF_ERROR))) if error else "0"


def _last_place(value: float, error: float) -> int:
    """Return the decimal place with which a number and its error end."""
    if not math.isfinite(value):
        return _place_of_digit(error, DIGITS_OF_ERROR)
    finest = _place_of_digit(value, MAX_DIGITS)
    return min(_place_of_digit(error, DIGITS_OF_ERROR), finest) if error else finest


def _place_of_digit(number: float, digits: int) -> int:
    """Return the decimal place of the last digit of a number that is rounded to `digits` significant ones."""
    if number == 0.0:
        return digits - 1
    return digits - 1 - int(f"{number:.{digits - 1}e}".partition("e")[2])


def _fixed(number: float, place: int, sign: str = "") -> str:
    """Write a number to a decimal place; digits between a negative place and the point are zeros."""
    rounded = round(number, place) + 0.0  # no -0
    if place > MAX_PLACE:
        return engineering(rounded, DIGITS_WITHOUT_ERROR, sign)
    return f"{rounded:{sign}.{max(place, 0)}f}"
