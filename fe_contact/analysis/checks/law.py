"""A law of mechanics checked on a table: its worst grid point, the value at it and the bound."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bounds import engineering
from fe_contact.ste.fields import SteFields
from fe_contact.types import FloatArray, Json

_DIGITS = 6
"""Significant digits of value and bound in a message. A law may be broken in the last digits alone."""


@dataclass(frozen=True)
class LawCheck:
    """The grid point of a table at which a law is nearest to be broken, or is broken most."""

    law: str
    quantity: str
    """`law`, `quantity`: Name of the law, and name of the quantity that it bounds."""
    location: str
    """Position, load, misalignment and center distance."""
    value: float
    bound: float
    """`value`, `bound`: Value of the quantity and its bound in `unit`; of two bounds the nearer one."""
    unit: str
    """Unit of value and bound; empty for numbers."""
    ratio: float
    """Part of its range that the value uses; above 1 or NaN: the law is broken. Between two bounds it is the
    distance of the value from their middle over half of their distance. With one bound it is value over
    bound, or bound over value.
    """

    @property
    def broken(self) -> bool:
        """Whether the value is out of its bound."""
        return not self.ratio <= 1.0

    @property
    def text(self) -> str:
        """The law, the place and both numbers."""
        value, bound = (
            f"{engineering(number, _DIGITS)} {self.unit}".rstrip() if np.isfinite(number) else str(number)
            for number in (self.value, self.bound)
        )
        return f"{self.law}: {self.quantity} is {value} at {self.location}, bound {bound}"

    def to_json(self) -> Json:
        """Return plain JSON; numbers that are not finite are None."""
        numbers = {"value": self.value, "bound": self.bound, "ratio": self.ratio}
        finite = {name: number if np.isfinite(number) else None for name, number in numbers.items()}
        return {
            "law": self.law,
            "quantity": self.quantity,
            "unit": self.unit,
            "place": self.location,
        } | finite


@dataclass(frozen=True)
class Law:
    """A law that bounds a quantity."""

    name: str
    quantity: str
    """`name`, `quantity`: Names of the law and of the quantity."""
    unit: str = ""
    """Unit of the quantity in messages."""
    per_si: float = 1.0
    """Value in this unit of one SI unit."""

    def between(
        self,
        value: FloatArray,
        low: FloatArray | float,
        high: FloatArray | float,
        location: Callable[..., str],
    ) -> LawCheck:
        """Check that values (...) lie between two bounds.

        Bounds are broadcast to the values. `location` returns the text of a grid point from its indices.
        """
        low, high = np.broadcast_to(low, value.shape), np.broadcast_to(high, value.shape)
        middle, half_range = 0.5 * (low + high), 0.5 * (high - low)
        distance = value - middle
        infinite = np.full(value.shape, np.inf)
        ratio = np.divide(np.abs(distance), half_range, out=infinite, where=half_range > 0.0)
        ratio = np.where(distance == 0.0, 0.0, ratio)
        bound = np.where(distance < 0.0, low, high)
        return self._worst(value, bound, ratio, location)

    def below(self, value: FloatArray, bound: FloatArray | float, location: Callable[..., str]) -> LawCheck:
        """Check that values (...) lie below bounds > 0; the ratio is value over bound."""
        bound = np.broadcast_to(bound, value.shape)
        return self._worst(value, bound, value / bound, location)

    def above(self, value: FloatArray, bound: FloatArray | float, location: Callable[..., str]) -> LawCheck:
        """Check that values (...) lie above bounds > 0; the ratio is bound over value."""
        bound = np.broadcast_to(bound, value.shape)
        ratio = np.divide(bound, value, out=np.full(value.shape, np.inf), where=value > 0.0)
        return self._worst(value, bound, ratio, location)

    def _worst(
        self, value: FloatArray, bound: FloatArray, ratio: FloatArray, location: Callable[..., str]
    ) -> LawCheck:
        worst = int(np.argmax(np.where(np.isnan(ratio), np.inf, ratio)))
        index = np.unravel_index(worst, ratio.shape)
        return LawCheck(
            law=self.name,
            quantity=self.quantity,
            location=location(*index),
            value=float(value[index]) * self.per_si,
            bound=float(bound[index]) * self.per_si,
            unit=self.unit,
            ratio=float(ratio[index]),
        )


def location_text(
    table: SteFields, position: int, misalignment: int, distance: int, force: float | None = None
) -> str:
    """Name a place of a table by its indices, and the normal force in N if there is one."""
    parts = [f"position {table.position[position]:.6g}"]
    if force is not None:
        parts.append(f"force {force:.6g} N")
    parts.append(f"misalignment {1e6 * table.misalignment[misalignment]:.4g} µm")
    parts.append(f"center distance change {1e6 * table.center_distance_change[distance]:.4g} µm")
    return ", ".join(parts)
