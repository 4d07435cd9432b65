"""A number of another source (theirs) compared with ours."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

AGREES, DIFFERS = "agrees", "differs"


@dataclass(frozen=True)
class Comparison:
    """A quantity in their value and in ours, each with its error in the same unit."""

    quantity: str
    unit: str
    theirs: float
    their_error: float
    ours: float
    our_error: float = 0.0
    why: str = ""
    """Cause of a difference that exceeds both errors; empty where none is known."""

    @property
    def agrees(self) -> bool:
        """Whether the difference lies within the sum of both errors, but for rounding of decimals."""
        allowed = self.their_error + self.our_error
        return abs(self.ours - self.theirs) <= allowed + 1e-12 * abs(self.theirs)

    @property
    def verdict(self) -> str:
        """`AGREES` or `DIFFERS`."""
        return AGREES if self.agrees else DIFFERS

    @property
    def difference(self) -> float:
        """Ours less theirs over theirs; NaN where theirs is zero."""
        return self.ours / self.theirs - 1.0 if self.theirs else math.nan

    def to_json(self) -> dict[str, Any]:
        """Return plain JSON."""
        fields = {name: getattr(self, name) for name in self.__dataclass_fields__}
        relative = self.difference
        return fields | {"verdict": self.verdict, "difference": relative if math.isfinite(relative) else None}


def last_digit(text: str) -> float:
    """Return half a unit of the last digit of a decimal number: the error of a printed value."""
    mantissa, _, exponent = text.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - decimals)
