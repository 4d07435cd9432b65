"""The band of a level in dB from the ranges of what is only guessed: damping, joints, mounts, the model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.types import FloatArray

STEPS = 9
"""Values of a range that are tried, ends included: a resonance may lie inside it."""


@dataclass(frozen=True)
class Range:
    """A parameter that is known within bounds; low <= nominal <= high, else InputError."""

    low: float
    nominal: float
    high: float

    def __post_init__(self) -> None:
        if not self.low <= self.nominal <= self.high:
            raise InputError("nominal", self.nominal, f"from {self.low:g} to {self.high:g}")


@dataclass(frozen=True)
class LevelBand:
    """A level and how far it may lie below and above.

    Contributions are independent, so that their deviations add up in squares. Where each is even over its
    range this is at least 1.7 standard deviations: 9 of 10 cases, all of them with one contribution.

    Attributes
    ----------
    nominal : float
        dB.
    below, above : mapping of str to float
        Deviations by parameter, dB, at least 0.
    """

    nominal: float
    below: Mapping[str, float]
    above: Mapping[str, float]

    @property
    def low(self) -> float:
        """Return the lower end, dB."""
        return self.nominal - float(np.sqrt(sum(value**2 for value in self.below.values())))

    @property
    def high(self) -> float:
        """Return the upper end, dB."""
        return self.nominal + float(np.sqrt(sum(value**2 for value in self.above.values())))

    def with_error(self, name: str, below: float, above: float) -> LevelBand:
        """Return the band with one more contribution, e.g. the error of the radiation model, dB.

        Raises
        ------
        InputError
            A deviation is negative.
        """
        if not (below >= 0.0 and above >= 0.0):
            raise InputError(name, min(below, above), "deviations of at least 0 dB")
        return LevelBand(self.nominal, {**self.below, name: below}, {**self.above, name: above})


def level_band(level: Callable[[Mapping[str, float]], float], ranges: Mapping[str, Range]) -> LevelBand:
    """Return the band of `level` (dB), by varying one parameter at a time over its range.

    A wider range never narrows the band where the level is monotone in each parameter. An extremum inside a
    range is found as far as it shows at `STEPS` equal steps.

    Parameters
    ----------
    level : callable
        From the values of all parameters by name to a level in dB.
    ranges : mapping of str to Range
    """
    nominal = {name: span.nominal for name, span in ranges.items()}
    middle = level(nominal)
    varied = {
        name: _levels(level, nominal, name, np.linspace(span.low, span.high, STEPS))
        for name, span in ranges.items()
    }
    below = {name: max(middle - float(np.min(levels)), 0.0) for name, levels in varied.items()}
    above = {name: max(float(np.max(levels)) - middle, 0.0) for name, levels in varied.items()}
    return LevelBand(middle, below, above)


def _levels(
    level: Callable[[Mapping[str, float]], float],
    nominal: Mapping[str, float],
    name: str,
    values: Sequence[float] | FloatArray,
) -> FloatArray:
    """Return the levels for values of one parameter, the others as they are."""
    return np.array([level({**nominal, name: float(value)}) for value in values])
