"""Units, and numbers as they are written in one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

DIGITS = 7
"""Default number of digits of a number in a message."""
MIN_LEFTOVER = 1e-12
"""Residual from which on its digits are written."""


@dataclass(frozen=True)
class Unit:
    """A unit as it is written."""

    name: str = ""
    """Symbol of the unit, e.g. ``"mm"``; empty for none."""
    factor: float = 1.0
    """SI value of one unit."""
    si: str = ""
    """Symbol of the SI unit of the same quantity, e.g. ``"m"``."""

    @property
    def plain(self) -> str:
        """The symbol in ASCII, as programs read it."""
        return self.name.replace("µ", "u")

    def after(self, number: str) -> str:
        """Return a number with the symbol."""
        return f"{number} {self.name}".rstrip()

    def exact(self, value: float) -> str:
        """Return a value, in SI, as it was typed."""
        return self.after(f"{value / self.factor + 0.0:.12g}")

    def low(self, limit: float) -> str:
        """Return a lower limit, in SI, as text that is accepted when it is typed."""
        return self.after(_rounded(limit, self.factor, ROUND_CEILING))

    def high(self, limit: float) -> str:
        """Return an upper limit, in SI, as text that is accepted when it is typed."""
        return self.after(_rounded(limit, self.factor, ROUND_FLOOR))


def leftover(value: float, digits: int = 1) -> str:
    """Write a number that should be zero, a residual or an imbalance: below `MIN_LEFTOVER` without digits.

    Rounding decides smaller numbers; their digits say nothing.

    Parameters
    ----------
    value : float
        Its size counts.
    digits : int
        Significant digits of a number that is large enough.
    """
    return f"below {MIN_LEFTOVER:g}" if abs(value) < MIN_LEFTOVER else engineering(abs(value), digits)


def engineering(value: float, digits: int = 3, sign: str = "") -> str:
    """Write a number for people: plainly from 1e-6 to 1e7, else with an exponent that is a multiple of three.

    Parameters
    ----------
    digits : int
        Significant digits; zeros at the end are left out.
    sign : str
        "+": positive numbers have their sign too.
    """
    text = f"{value:{sign}.{digits}g}"
    if "e" not in text:
        return text
    mantissa, _, power = text.partition("e")
    exponent = int(power)
    if -6 <= exponent < 7:
        decimals = max(len(mantissa.partition(".")[2]) - exponent, 0)
        return f"{float(text):{sign}.{decimals}f}"
    shift = exponent % 3
    return f"{float(mantissa) * 10**shift:{sign}.6g}e{exponent - shift}"


def _rounded(limit: float, factor: float, direction: str) -> str:
    """Return seven digits, rounding of the limit's own computation left aside; integers are written out."""
    if isinstance(limit, int) and factor == 1.0:
        return str(limit)
    number = limit / factor + 0.0  # no -0
    if not math.isfinite(number):
        return f"{number:g}"
    exact = Decimal(f"{number:.13g}")
    last_digit = Decimal(1).scaleb(exact.adjusted() - DIGITS + 1)
    return f"{float(exact.quantize(last_digit, rounding=direction)):.{DIGITS}g}"
