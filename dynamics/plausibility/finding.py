"""What a plausibility check found in a scene, in words and as plain JSON."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

from dynamics.types import Json


class PlausibilityWarning(UserWarning):
    """A value of a scene is far from practice: most likely a slip of units."""


@dataclass(frozen=True)
class Finding:
    """A quantity beyond the limit of a check.

    Attributes
    ----------
    check : str
        Name of the check.
    field : str
        Dotted name of the field, as in an `InputError`.
    value : float
        Of the field, in `unit`.
    low, high : float
        Usual values of the field in `unit`. No bound is 0 or infinity.
    unit : str
        SI unit.
    reason : str
        What is implausible, in words.
    source : str
        Of the limit.
    whole : str
        Other fields that must have slipped with this one, in words; empty if it stands alone.
    """

    check: str
    field: str
    value: float
    low: float
    high: float
    unit: str
    reason: str
    source: str
    whole: str = ""

    def message(self) -> str:
        """Say it in one line, in SI units."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.field} = {self.value:.6g}{unit}: {self.reason} ({self.source})."

    def to_json(self) -> Json:
        """Return plain JSON in SI units; a missing bound is None."""
        return {
            "check": self.check,
            "field": self.field,
            "value": self.value,
            "unit": self.unit,
            "low": self.low or None,
            "high": self.high if math.isfinite(self.high) else None,
            "reason": self.reason,
            "source": self.source,
            "whole": self.whole,
            "message": self.message(),
        }


def warn_of(findings: Sequence[Finding], stacklevel: int = 3) -> None:
    """Warn of findings, once of each; a `stacklevel` of 3 names the caller of who calls this."""
    for finding in findings:
        warnings.warn(f"implausible: {finding.message()}", PlausibilityWarning, stacklevel)
