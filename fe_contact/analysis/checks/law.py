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
    """The worst place of a table under a law."""

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
    """Distance of the value from the far bound over the distance of the bounds. Above 1, or where it is NaN,
    the law is broken.
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
    """Quantity that a law bounds: names of law and quantity, unit in messages, factor from SI to the unit."""

    name: str
    quantity: str
    unit: str = ""
    per_si: float = 1.0

    def between(
        self,
        value: FloatArray,
        low: FloatArray | float,
        high: FloatArray | float,
        location: Callable[..., str],
    ) -> LawCheck:
        """Hold values (...) between bounds that broadcast; `location` names the place of an index."""
        low, high = np.broadcast_to(low, value.shape), np.broadcast_to(high, value.shape)
        middle, room = 0.5 * (low + high), 0.5 * (high - low)
        off = value - middle
        ratio = np.divide(np.abs(off), room, out=np.full(value.shape, np.inf), where=room > 0.0)
        ratio = np.where(off == 0.0, 0.0, ratio)
        bound = np.where(off < 0.0, low, high)
        return self._worst(value, bound, ratio, location)

    def below(self, value: FloatArray, bound: FloatArray | float, location: Callable[..., str]) -> LawCheck:
        """Hold values (...) below bounds > 0 that broadcast."""
        bound = np.broadcast_to(bound, value.shape)
        return self._worst(value, bound, value / bound, location)

    def above(self, value: FloatArray, bound: FloatArray | float, location: Callable[..., str]) -> LawCheck:
        """Hold values (...) above bounds > 0 that broadcast; the ratio is bound over value."""
        bound = np.broadcast_to(bound, value.shape)
        ratio = np.divide(bound, value, out=np.full(value.shape, np.inf), where=value > 0.0)
        return self._worst(value, bound, ratio, location)

    def _worst(
        self, value: FloatArray, bound: FloatArray, ratio: FloatArray, location: Callable[..., str]
    ) -> LawCheck:
        at = np.unravel_index(int(np.argmax(np.where(np.isnan(ratio), np.inf, ratio))), ratio.shape)
        return LawCheck(
            law=self.name,
            quantity=self.quantity,
            location=location(*at),
            value=float(value[at]) * self.per_si,
            bound=float(bound[at]) * self.per_si,
            unit=self.unit,
            ratio=float(ratio[at]),
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
