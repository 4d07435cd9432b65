"""Change of the level of a quantity by leaving an effect out.

The level is that of the quantity for which a scene is computed, in dB. It is compared at the order whose
amplitude changes most.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bounds import engineering
from dynamics.settings.level_quantity import ForceLines
from dynamics.types import FloatArray

Lines = Mapping[float, float]
"""Largest power or mean square over the speeds, weighted, by order."""
MAX = 60.0
"""Largest change of level that is stated, dB: a larger one means that one of the two levels is negligible."""
ROUNDING = 1e-8
"""Relative change of amplitude below which an estimate is rounding."""


@dataclass(frozen=True)
class BearingForces:
    """Root of the sum of squares of the forces on all bearings: the default quantity of a scene's level."""

    name: str = "bearing forces"
    unit: str = "dB"

    def squares(self, forces: ForceLines) -> FloatArray:
        """Return their mean squares, (S, H), N^2."""
        return np.asarray(0.5 * np.sum(np.abs(forces.bearing_force[:, :3]) ** 2, axis=(0, 1)))


@dataclass(frozen=True)
class LevelChange:
    """Change of a level without an effect, at the order whose amplitude changes most."""

    quantity: str = ""
    unit: str = "dB"
    """`quantity`, `unit`: Name and unit of the level, as `LevelQuantity` states them."""
    order: float = 0.0
    """Multiple of the frequency of the first mesh that turns."""
    decibels: float = 0.0
    """The level without the effect less that with it, each the largest over the speeds; at most `MAX` in
    size.
    """
    relative: float = 0.0
    """Change of that amplitude over the largest of all orders with the effect."""

    @property
    def text(self) -> str:
        """The change, in words."""
        if self.relative <= ROUNDING:
            return f"0 {self.unit} of {self.quantity}"
        more = "more than " if abs(self.decibels) >= MAX else ""
        size = engineering(self.decibels, 2, "+")
        return f"{more}{size} {self.unit} of {self.quantity} at order {self.order:.4g}"


def loudest_lines(order: FloatArray, squares: FloatArray, known: Lines) -> dict[float, float]:
    """Return the largest of `squares` (S, H) over the speeds, by `order` (H,), or `known` if larger."""
    lines = dict(known)
    for value, maximum in zip(np.round(order, 9).tolist(), np.max(squares, axis=0).tolist(), strict=True):
        lines[value] = max(maximum, lines.get(value, 0.0))
    return lines


def level_change(with_effect: Lines, without: Lines, quantity: str, unit: str = "dB") -> LevelChange:
    """Return the change of a level from the lines with an effect to those without."""
    both = {
        k: (math.sqrt(with_effect.get(k, 0.0)), math.sqrt(without.get(k, 0.0)))
        for k in {**with_effect, **without}
    }
    if not any(map(any, both.values())):
        return LevelChange(quantity, unit)
    order = max(both, key=lambda k: abs(both[k][1] - both[k][0]))
    before, after = both[order]  # amplitudes with and without the effect
    largest = max(size for size, _ in both.values()) or after
    return LevelChange(quantity, unit, order, decibels(before, after), abs(after - before) / largest)


def decibels(size: float, left: float) -> float:
    """Return the level of an amplitude `left` over `size`, dB, at most `MAX` in size; 0 if both are 0."""
    minimum = 10.0 ** (-MAX / 20.0) * max(size, left)
    return 20.0 * math.log10(max(left, minimum) / max(size, minimum)) if minimum else 0.0


def in_decibels(relative: float) -> float:
    """Return the level of an amplitude that grows by a `relative` part of itself, dB, at most `MAX`."""
    return min(20.0 * math.log10(1.0 + relative), MAX)


def in_relative(decibels: float) -> float:
    """Return the relative change of an amplitude whose level rises by `decibels`."""
    return float(10.0 ** (decibels / 20.0) - 1.0)
