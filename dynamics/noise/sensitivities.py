"""What a change of a design costs or gains in dB(A): sensitivities of the largest sound power level."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from dynamics.checks import finite
from dynamics.errors import InputError

CURVED = 0.25
"""Share of the change by slope that the curvature may add where a level counts as linear."""


@dataclass(frozen=True)
class DesignFigure:
    """A figure of a design, and a small step of it.

    Attributes
    ----------
    name, unit : str
    value, step : float
        In `unit`; the step is not zero.
    """

    name: str
    unit: str
    value: float
    step: float

    def __post_init__(self) -> None:
        finite("value", self.value)
        if not (math.isfinite(self.step) and self.step != 0.0):
            raise InputError("step", self.step, "a number other than zero")


@dataclass(frozen=True)
class Sensitivity:
    """The change of a level with a figure, from two steps of it.

    Attributes
    ----------
    figure : DesignFigure
    change, change_of_two : float
        Of the level with one step and with two, dB.
    """

    figure: DesignFigure
    change: float
    change_of_two: float

    @property
    def slope(self) -> float:
        """Return the derivative of the level, dB per unit: that of the parabola through all three levels."""
        return (4.0 * self.change - self.change_of_two) / (2.0 * self.figure.step)

    @property
    def curvature(self) -> float:
        """Return the second derivative, dB per unit squared."""
        return (self.change_of_two - 2.0 * self.change) / self.figure.step**2

    @property
    def linear_range(self) -> float:
        """Return how far the slope alone holds within `CURVED`, in units of the figure; inf: anywhere."""
        bend = 0.5 * abs(self.curvature)
        return CURVED * abs(self.slope) / bend if bend > 0.0 else math.inf

    @property
    def for_one_db_less(self) -> float:
        """Return the change of the figure that lowers the level by 1 dB, by the slope; inf: none does."""
        return -1.0 / self.slope if self.slope != 0.0 else math.inf

    @property
    def linear(self) -> bool:
        """Whether that change is within the linear range."""
        return abs(self.for_one_db_less) <= self.linear_range


def sensitivity(figure: DesignFigure, level: Callable[[float], float]) -> Sensitivity:
    """Return the sensitivity of a level to a figure.

    Parameters
    ----------
    figure : DesignFigure
    level : callable
        From a value of the figure to the level, dB, all else as it is. It is called three times: smooth in
        the value, as `largest_level` is and a level at a fixed speed near a resonance is not.
    """
    nominal, one, two = (level(figure.value + count * figure.step) for count in range(3))
    return Sensitivity(figure, one - nominal, two - nominal)


def ranked(rows: Iterable[Sensitivity]) -> tuple[Sensitivity, ...]:
    """Return sensitivities by what a step changes, the largest first."""
    return tuple(sorted(rows, key=lambda row: -abs(row.change)))
