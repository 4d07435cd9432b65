"""Levels in decibels: sound power, sums, A-weighting.

References
----------
.. [1] IEC 61672-1:2013, Sound level meters - Part 1, annex E: A-weighting in closed form.
.. [2] ISO 3740 series: sound power levels re 1 pW.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.types import FloatArray

REFERENCE_POWER = 1e-12  # W
REFERENCE_PRESSURE = 20e-6  # Pa, rms
FLOOR = -200.0
"""Level of no power at all, dB: -inf would spread through sums and plots."""
POLES = (20.598997, 107.65265, 737.86223, 12194.217)  # Hz, of [1]_: twofold, single, single, twofold


def sound_power_level(power: ArrayLike) -> FloatArray:
    """Return the sound power level re 1e-12 W, dB, at least `FLOOR`.

    Parameters
    ----------
    power : array
        W, any shape.

    Raises
    ------
    InputError
        If a power is negative or no number.
    """
    values = np.asarray(power, dtype=float)
    if not np.all(values >= 0.0):
        raise InputError("power", float(np.min(values)), "at least 0 W everywhere")
    lowest = REFERENCE_POWER * 10.0 ** (FLOOR / 10.0)
    return np.asarray(10.0 * np.log10(np.maximum(values, lowest) / REFERENCE_POWER))


def a_weighting(frequency: ArrayLike) -> FloatArray:
    """Return the A-weighting in dB, 0 at 1 kHz; `FLOOR` at most below at 0 Hz.

    Parameters
    ----------
    frequency : array
        Hz, any shape, at least 0.
    """
    weight = _response(np.asarray(frequency, dtype=float)) / _response(np.array(1000.0))
    return np.asarray(20.0 * np.log10(np.maximum(weight, 10.0 ** (FLOOR / 20.0))))


def _response(frequency: FloatArray) -> FloatArray:
    """Return the gain of the weighting network, not normalized."""
    square = frequency**2
    first, second, third, fourth = (pole**2 for pole in POLES)
    middle = np.sqrt((square + second) * (square + third))
    return np.asarray(fourth * square**2 / ((square + first) * middle * (square + fourth)))


def free_field_pressure(power: ArrayLike, distance: float, impedance: float) -> FloatArray:
    """Return the rms sound pressure at a distance from a source that radiates evenly to all sides, Pa.

    Parameters
    ----------
    power : array
        W.
    distance : float
        m; no floor, no room.
    impedance : float
        rho c of the air, Pa s/m.
    """
    return np.asarray(np.sqrt(np.asarray(power, dtype=float) * impedance / (4.0 * np.pi)) / distance)


STEPS = 9
"""Values of a range that are tried, ends included: a resonance may lie inside it."""
JOINTLY = "jointly"
"""Contribution of parameters that act on each other."""
SEED = 22
"""Of the joint cases: bands are the same each time."""


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


def level_bands(
    levels: Callable[[Mapping[str, float]], FloatArray],
    ranges: Mapping[str, Range],
    steps: int = STEPS,
    joint: int = 0,
) -> tuple[LevelBand, ...]:
    """Return the bands of several levels, by varying one parameter at a time over its range.

    A wider range never narrows a band where its level is monotone in each parameter. An extremum inside a
    range is found as far as it shows at `steps` equal steps. Where parameters act on each other, as one
    resonance that meets another, sums in squares fall short: the bands then reach as far as the levels of
    `joint` cases, all parameters at once, spread evenly over the ranges. What
    that adds is the contribution `JOINTLY`.

    Parameters
    ----------
    levels : callable
        From the values of all parameters by name to levels in dB, (L,).
    steps : int
        Values of each range that are tried, at least its ends.
    joint : int
        Joint cases, best a power of two.

    Raises
    ------
    InputError
        Fewer than two steps, or a negative number of cases.
    """
    integer("steps", steps, 2, 1000)
    integer("joint", joint, 0, 4096)
    nominal = {name: span.nominal for name, span in ranges.items()}
    middle = levels(nominal)
    deviation = {
        name: [
            levels({**nominal, name: float(value)}) - middle
            for value in np.linspace(span.low, span.high, steps)
            if value != span.nominal
        ]
        for name, span in ranges.items()
    }
    below = {name: -np.min([0.0 * middle, *rows], axis=0) for name, rows in deviation.items()}
    above = {name: np.max([0.0 * middle, *rows], axis=0) for name, rows in deviation.items()}
    if joint and len(ranges) > 1:
        together = np.array([levels(values) for values in _cases(ranges, joint)]) - middle
        below[JOINTLY] = _beyond(-together.min(axis=0), below)
        above[JOINTLY] = _beyond(together.max(axis=0), above)
    return tuple(
        LevelBand(float(middle[k]), _entries(below, k), _entries(above, k)) for k in range(middle.size)
    )


def _cases(ranges: Mapping[str, Range], count: int) -> Iterator[dict[str, float]]:
    """Yield values of all parameters, spread evenly: scrambled points of Sobol's sequence."""
    from scipy.stats.qmc import Sobol  # noqa: PLC0415 (start-up time)

    for shares in Sobol(len(ranges), seed=SEED).random(count):
        yield {
            name: span.low + share * (span.high - span.low)
            for share, (name, span) in zip(shares.tolist(), ranges.items(), strict=True)
        }


def _beyond(reached: FloatArray, deviations: Mapping[str, FloatArray]) -> FloatArray:
    """Return what is to be added in squares to the deviations so that they reach as far."""
    squares = np.sum([value**2 for value in deviations.values()], axis=0)
    return np.asarray(np.sqrt(np.maximum(np.maximum(reached, 0.0) ** 2 - squares, 0.0)))


def _entries(deviations: Mapping[str, FloatArray], index: int) -> dict[str, float]:
    return {name: float(values[index]) for name, values in deviations.items()}
