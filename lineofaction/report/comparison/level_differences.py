"""Differences of the levels of mesh orders in dB, with errors, over the speeds that two signals pass."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bounds.error_digits import error_text, to_error
from dynamics.orders import OrderPower, Waterfall, order_power, shared_frequencies
from lineofaction.report.drawing.figure import Table

PLACES = 40
"""Number of speeds at which differences are computed."""
_OUT = 10.0
"""Least power of an order over the power of the noise at which the order is compared at a speed."""
_DB = 10.0 / math.log(10.0)
"""Level in dB per unit of a small relative change of power."""
_SIGMAS = 2.0
"""Standard deviations in a stated error."""


@dataclass(frozen=True)
class LevelDifference:
    """The levels of one order in two signals."""

    order: int
    levels: tuple[float, float]
    """Mean power over the shared speeds, dB re one unit rms."""
    errors: tuple[float, float]
    """Errors of the levels, two standard deviations, dB."""
    largest: float
    """The largest difference at one speed, dB; NaN: the order stands out of the noise at no speed."""
    is_seen: bool
    """Whether the order stands out of the noise in both."""

    @property
    def value(self) -> float:
        """Second less first, dB."""
        return self.levels[1] - self.levels[0]

    @property
    def error(self) -> float:
        """Root of the sum of both errors squared, dB."""
        return math.hypot(*self.errors)

    @property
    def finding(self) -> str:
        """The conclusion in words."""
        if not self.is_seen:
            return "not above the noise"
        if abs(self.value) <= self.error:
            return "not shown to differ"
        return "the measured one is louder" if self.value > 0.0 else "the computed one is louder"

    def between(self, unit: str) -> str:
        """Return both levels, and by how much the measured one differs."""
        first, second = self.levels
        return f"{first:.1f} to {second:.1f} dB re 1 {unit} rms, by {self.written}"

    @property
    def written(self) -> str:
        """The difference with its error, both to the last digit that counts; empty of an order in noise."""
        if not self.is_seen:
            return "no more than the noise"
        return f"{to_error(self.value, self.error, '+')} ± {error_text(self.value, self.error)}"


def level_differences(
    sides: tuple[Waterfall, Waterfall], orders: Sequence[int], receipt: Mapping[int, float], overlap: float
) -> tuple[LevelDifference, ...]:
    """Return the differences by order; none if both signals pass no common speed.

    `receipt`: stated errors of the first by order, peak amplitude.
    """
    span = shared_frequencies(*sides)
    if span is None:
        return ()
    differences = []
    for order in orders:
        first, second = (order_power(side, order, span, overlap) for side in sides)
        differences.append(_difference(order, (first, second), receipt[order], span))
    return tuple(differences)


def _difference(
    order: int, powers: tuple[OrderPower, OrderPower], step_error: float, span: tuple[float, float]
) -> LevelDifference:
    computed, measured = map(_error, powers)
    amplitude = math.sqrt(2.0 * max(powers[0].power, 0.0))
    by_steps = 2.0 * _DB * step_error / amplitude if amplitude > 0.0 else 0.0
    return LevelDifference(
        order,
        (_level(powers[0]), _level(powers[1])),
        (math.hypot(computed, by_steps), measured),
        _largest(powers, span),
        powers[0].is_seen and powers[1].is_seen,
    )


def _largest(powers: tuple[OrderPower, OrderPower], span: tuple[float, float]) -> float:
    """Return the largest difference at one speed, dB, where both stand out of the noise; NaN if nowhere."""
    grid = np.linspace(*span, PLACES)
    first, second = (np.interp(grid, power.frequency, power.clean) for power in powers)
    above_noise = (first > _OUT * powers[0].noise) & (second > _OUT * powers[1].noise)
    if not above_noise.any():
        return math.nan
    return float(np.max(np.abs(10.0 * np.log10(second[above_noise] / first[above_noise]))))


def _level(mean: OrderPower) -> float:
    """Return the level of an order, dB; an order in noise has the level below which it lies."""
    return 10.0 * math.log10(max(mean.power, _SIGMAS * mean.deviation, 1e-300))


def _error(mean: OrderPower) -> float:
    return _DB * _SIGMAS * mean.deviation / mean.power if mean.power > 0.0 else math.inf


def levels_table(differences: Sequence[LevelDifference], names: tuple[str, str], unit: str) -> Table:
    """Tabulate the levels of both, their difference with its error, and the largest at one speed."""
    return Table.of(
        "Levels of mesh orders over the shared speeds",
        differences,
        {
            "mesh order": lambda row: str(row.order),
            f"{names[0]}, {unit}": lambda row: f"{row.levels[0]:.2f}",
            f"{names[1]}, {unit}": lambda row: f"{row.levels[1]:.2f}",
            "measured less computed, dB": lambda row: row.written,
            "largest at one speed, dB": lambda row: "" if math.isnan(row.largest) else f"{row.largest:.2f}",
            "finding": lambda row: row.finding,
        },
    )
