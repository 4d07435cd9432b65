"""Types that every room shares: arrays, point status, and a value with its error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from bounds.error_digits import with_error
from bounds.types import BoolArray, ComplexArray, FloatArray, IntArray, Json
from host.extras import MissingExtra

__all__ = ["BoolArray", "ComplexArray", "Estimate", "FloatArray", "IntArray", "Json", "Status"]
_UNITS = {
    "m": {"mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9},
    "Pa": {"MPa": 1e6, "GPa": 1e9, "N/mm2": 1e6},
    "N": {"kN": 1e3},
    "N/m": {"N/mm": 1e3, "N/um": 1e6},
}
"""Sizes of the units in which a number of an SI unit can be written."""
_DEVIATIONS = 2.0
"""Standard deviations in the half-width of an error band, which covers about 95 % of the true errors."""


class Status(IntEnum):
    """Outcome of one contact solve, stored with every point of a database."""

    CONVERGED = 0
    ITERATION_LIMIT = 1  # Newton and its fallback both ran out of iterations
    SINGULAR = 2  # the contact matrix lost positive definiteness
    OUT_OF_MODEL = 3  # converged, but the load needs contact that the model does not hold
    NOT_COMPUTED = 4  # the sweep ended before this point

    @property
    def usable(self) -> bool:
        """Whether the value stored with this status is a solution."""
        return self is Status.CONVERGED


@dataclass(frozen=True)
class Estimate:
    """A number with an estimate of its error."""

    value: float
    error: float
    """`value`, `error`: The number and the half-width of its error band, both in `unit`; error >= 0."""
    unit: str
    """SI unit, e.g. "m"."""

    def __float__(self) -> float:
        return self.value

    def __str__(self) -> str:
        """Return the number with its error, in µm and MPa where the unit is m or Pa."""
        return self._written({"m": "um", "Pa": "MPa"}.get(self.unit, self.unit))

    def _repr_html_(self) -> str:
        return str(self)

    def __format__(self, unit: str) -> str:
        """Return the number with its error in a unit (``f"{ripple:um}"``), to two digits of the error.

        Raises `ValueError`: the unit is none of those of the number.
        """
        if not unit:
            return str(self)
        if unit != self.unit and unit not in _UNITS.get(self.unit, {}):
            known = ", ".join((self.unit, *_UNITS.get(self.unit, {})))
            raise ValueError(f"a number in {self.unit or '1'} is not written in {unit}; units: {known}")
        return self._written(unit)

    def ufloat(self) -> Any:
        """Return a number of `uncertainties`, which carries errors through arithmetic.

        The half-width of the band counts as two standard deviations; NaN where no error is stated. The number
        is in `unit`. Raises `MissingExtra`: the extra ``uncertainties`` is not installed.
        """
        try:
            from uncertainties import ufloat  # noqa: PLC0415 (an extra)
        except ModuleNotFoundError:
            raise MissingExtra("uncertainties", "uncertainties") from None
        return ufloat(self.value, self.error / _DEVIATIONS)

    def _written(self, unit: str) -> str:
        unit_value = _UNITS.get(self.unit, {}).get(unit, 1.0)
        value, error, name = self.value / unit_value, self.error / unit_value, unit.replace("um", "µm")
        if not math.isfinite(error):
            return f"{value:.4g} {name}, no error stated".replace("  ", " ")
        return with_error(value, error, name)
