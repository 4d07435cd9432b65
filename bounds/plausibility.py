"""Plausibility: limits of practice, and findings beyond them. A check warns and changes no number."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bounds.types import Json
from bounds.unit import Unit

TYPED: dict[str, tuple[Unit, ...]] = {
    "m": (Unit("meters", 1.0), Unit("millimeters", 1e-3), Unit("micrometers", 1e-6), Unit("inches", 25.4e-3)),
    "N m": (Unit("kN m", 1e3), Unit("N mm", 1e-3), Unit("N m", 1.0)),
    "N": (Unit("kN", 1e3), Unit("N", 1.0)),
    "rad": (Unit("radians", 1.0), Unit("degrees", math.pi / 180.0)),
    "Pa": (Unit("GPa", 1e9), Unit("MPa", 1e6), Unit("Pa", 1.0)),
    "N/m": (Unit("N/µm", 1e6), Unit("N/mm", 1e3), Unit("N/m", 1.0)),
    "rad/s": (Unit("rad/s", 1.0), Unit("rpm", math.pi / 30.0), Unit("degrees per second", math.pi / 180.0)),
    "s": (Unit("milliseconds", 1e-3), Unit("seconds", 1.0)),
    "kg": (Unit("grams", 1e-3), Unit("kilograms", 1.0)),
    "kg/m^3": (Unit("g/cm^3", 1e3), Unit("kg/m^3", 1.0)),
    "kg m^2": (Unit("kg cm^2", 1e-4), Unit("kg mm^2", 1e-6), Unit("kg m^2", 1.0)),
    "1": (Unit("per cent", 1e-2),),
}
"""Units that people type by mistake, by the SI unit of the field; the likeliest first."""

SI_UNITS = {name: Unit(name, 1.0) for name in TYPED}


def _suspected_unit(value: float, field_unit: Unit, dimension: str, low: float, high: float) -> str:
    """Return a unit, other than the field's, in which the typed number would be plausible; "" if none is.

    Parameters
    ----------
    value : float
        Value in SI, as read in the unit `field_unit`.
    field_unit : Unit
        Unit of the field.
    dimension : str
        SI unit of the quantity, e.g. "m".
    low, high : float
        Usual magnitudes in SI.
    """
    typed = abs(value) / field_unit.factor
    for unit in TYPED.get(dimension, ()):
        if typed and not math.isclose(unit.factor, field_unit.factor) and low <= typed * unit.factor <= high:
            return unit.name
    return ""


@dataclass(frozen=True)
class Check:
    """A limit of practice that a quantity is compared with."""

    name: str
    """Name of the findings of the check."""
    quantity: str
    """Compared quantity, in words."""
    low: float | None
    high: float | None
    """`low`, `high`: Bounds in `unit`; None: no such bound."""
    unit: str
    """Unit of the bounds; "1" for a ratio."""
    source: str
    """Source of the limit."""


class PlausibilityWarning(UserWarning):
    """A value or a result is far from practice: most likely a slip of units."""


@dataclass(frozen=True)
class Finding:
    """A quantity beyond the limit of a check."""

    check: str
    """Name of the check."""
    field: str
    """Dotted name of the field, as in an `InputError`."""
    value: float
    """Value of the field, in `unit`."""
    low: float
    high: float
    """`low`, `high`: Usual values in `unit`, given the other values of the case; no bound: 0 or infinity."""
    unit: str
    """SI unit."""
    reason: str
    """Reason why the value is implausible, in words."""
    source: str
    """Source of the limit."""
    unit_note: str = ""
    """Text on other fields that must be in the wrong unit too; empty if this field may be so alone."""

    def message(self, field: str | None = None, field_unit: Unit | None = None) -> str:
        """Return the finding in one line, in the caller's name and unit of the field (default: ours, SI)."""
        unit = field_unit or SI_UNITS[self.unit]
        suspected = _suspected_unit(self.value, unit, self.unit, self.low, self.high)
        written = f"{self.value / unit.factor:.6g}" + (f" {unit.name}" if unit.name != "1" else "")
        question = f" Did you give {suspected}{self.unit_note}?" if suspected else ""
        return f"{field or self.field} = {written}: {self.reason} ({self.source}).{question}"

    def to_json(self) -> Json:
        """Return plain JSON in SI units; a missing bound is None."""
        return {
            "check": self.check,
            "field": self.field,
            "value": self.value,
            "unit": self.unit,
            "low": self.low or None,  # 0 and infinity are no bounds
            "high": self.high if math.isfinite(self.high) else None,
            "reason": self.reason,
            "source": self.source,
            "whole": self.unit_note,
            "message": self.message(),
        }


@dataclass(frozen=True)
class Checklist:
    """The checks of a library, by name."""

    checks: Mapping[str, Check]

    def assessed(
        self,
        check: str,
        field: str,
        value: float,
        unit: str,
        *,
        scale: float = 1.0,
        reason: str | None = None,
        unit_note: str = "",
        skip_zero: bool = False,
    ) -> Iterator[Finding]:
        """Yield a finding if |value| is outside the bounds of a check.

        `scale` is the unit of the bounds in `unit`, the unit of the value.
        """
        rule = self.checks[check]
        low = 0.0 if rule.low is None else rule.low * scale
        high = math.inf if rule.high is None else rule.high * scale
        if not low <= abs(value) <= high and not (skip_zero and value == 0.0):
            text = reason or f"implausible {rule.quantity}"
            yield Finding(check, field, float(value), low, high, unit, text, rule.source, unit_note)


def finding_of(content: Json) -> Finding:
    """Return the finding that `to_json` wrote."""
    values = {name: content[name] for name in ("check", "field", "value", "unit", "reason", "source")}
    low, high = content["low"] or 0.0, content["high"] or math.inf
    return Finding(low=low, high=high, unit_note=content["whole"], **values)


def warn_of(findings: Sequence[Finding]) -> None:
    """Warn of findings at the line that called the package of this function's caller."""
    # level 2 is the function that called this one; functools calls cached properties
    library, level = _package(2), 3
    while _package(level) in (library, "functools"):
        level += 1
    for finding in findings:
        warnings.warn(f"implausible: {finding.message()}", PlausibilityWarning, level)


def _package(level: int) -> str:
    """Return the name of the top package of the function `level` calls above this one."""
    return str(sys._getframe(level).f_globals.get("__name__", "")).partition(".")[0]
