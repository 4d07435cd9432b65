"""Levels in decibels: sound power, sums, A-weighting.

References
----------
.. [1] IEC 61672-1:2013, Sound level meters - Part 1, annex E: A-weighting in closed form.
.. [2] ISO 3740 series: sound power levels re 1 pW.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.types import FloatArray
from model_studies.spread import quantiles

REFERENCE_POWER = 1e-12  # W
REFERENCE_PRESSURE = 20e-6  # Pa, rms
FLOOR = -200.0
"""Level of no power at all, dB: -inf would spread through sums and plots."""
POLES = (20.598997, 107.65265, 737.86223, 12194.217)  # Hz, of [1]_: twofold, single, single, twofold
ENDS = (0.05, 0.95)
"""Quantiles at which a band ends: nine of ten cases lie between."""
CASES = 64
"""Joint cases of all parameters. A quantile of so many cases leaves out 5 % of the population within 2 %."""
JOINTLY = "jointly"
"""Contribution of parameters that act on each other, and of extremes inside a range."""
SEED = 22
"""Seed of the joint cases, by which equal inputs have equal bands."""


def sound_power_level(power: ArrayLike) -> FloatArray:
    """Return the sound power level re 1e-12 W, dB, at least `FLOOR`.

    `power`: W, any shape. Raises `InputError`: a power is negative or no number.
    """
    values = np.asarray(power, dtype=float)
    if not np.all(values >= 0.0):
        raise InputError("power", float(np.min(values)), "at least 0 W everywhere")
    lowest = REFERENCE_POWER * 10.0 ** (FLOOR / 10.0)
    return np.asarray(10.0 * np.log10(np.maximum(values, lowest) / REFERENCE_POWER))


def mean_square_level(square: FloatArray) -> FloatArray:
    """Return the sound pressure level of mean squares in Pa^2 re 20 uPa, dB, at least `FLOOR`."""
    minimum = 10.0 ** (FLOOR / 10.0)
    return np.asarray(10.0 * np.log10(np.maximum(square / REFERENCE_PRESSURE**2, minimum)))


def a_weighting(frequency: ArrayLike) -> FloatArray:
    """Return the A-weighting in dB, 0 at 1 kHz and never below `FLOOR`, which it reaches at 0 Hz.

    `frequency`: Hz, any shape, at least 0.
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


@dataclass(frozen=True)
class Range:
    """A parameter that is known within bounds; low <= nominal <= high, else InputError."""

    low: float
    nominal: float
    high: float

    def __post_init__(self) -> None:
        if not self.low <= self.nominal <= self.high:
            raise InputError("nominal", self.nominal, f"from {self.low:g} to {self.high:g}")

    def at(self, share: float) -> float:
        """Return the value at a share of the range, 0 at its low end."""
        return self.low + share * (self.high - self.low)


@dataclass(frozen=True)
class LevelBand:
    """A level and how far it may lie below and above in nine of ten cases.

    Contributions are independent: their deviations add up in squares.
    """

    nominal: float
    """dB."""
    below: dict[str, float]
    above: dict[str, float]
    """`below`, `above`: Deviations by parameter, dB, at least 0."""

    @property
    def low(self) -> float:
        """Return the lower end, dB."""
        return self.nominal - float(np.sqrt(sum(value**2 for value in self.below.values())))

    @property
    def high(self) -> float:
        """Return the upper end, dB."""
        return self.nominal + float(np.sqrt(sum(value**2 for value in self.above.values())))

    @property
    def width(self) -> float:
        """Return the distance of the ends, dB."""
        return self.high - self.low

    @property
    def widths_without(self) -> dict[str, float]:
        """Return the width of the band without each contribution, by its name, the narrowest first, dB."""
        left = {
            name: LevelBand(self.nominal, self.below | {name: 0.0}, self.above | {name: 0.0}).width
            for name in self.below
        }
        return dict(sorted(left.items(), key=lambda item: item[1]))

    def with_error(self, name: str, below: float, above: float) -> LevelBand:
        """Return the band with one more contribution, e.g. the error of the radiation model, dB.

        Raises `InputError`: a deviation is negative.
        """
        if not (below >= 0.0 and above >= 0.0):
            raise InputError(name, min(below, above), "deviations of at least 0 dB")
        return LevelBand(self.nominal, {**self.below, name: below}, {**self.above, name: above})


def band_cases(ranges: Mapping[str, Range], count: int = CASES) -> list[dict[str, float]]:
    """Return the values of all parameters for which `level_bands` takes levels, by name.

    First the nominal ones, then so many joint cases, spread evenly (best a power of two), then each parameter
    alone at the two `ENDS` of its range. Raises `InputError`: no case, or more than 4096.
    """
    integer("cases", count, 1, 4096)
    nominal = {name: span.nominal for name, span in ranges.items()}
    joint = list(_cases(ranges, count)) if ranges else []
    alone = [{**nominal, name: span.at(end)} for name, span in ranges.items() for end in ENDS]
    return [nominal, *joint, *alone]


def level_bands(ranges: Mapping[str, Range], levels: FloatArray) -> tuple[LevelBand, ...]:
    """Return the bands of several levels over the ranges of their parameters.

    The ends are quantiles (`ENDS`) of joint cases, in which all parameters are even over their ranges and
    independent. The nominal level always lies inside. The contribution of a parameter is the change that it
    causes alone between the same quantiles of its range. If the squares of the contributions add up to less
    than the band, as where one resonance meets another, the rest is `JOINTLY`. If they add up to more, all
    are reduced by the same factor.

    Parameters
    ----------
    levels : (C, L) array
        Levels of the `band_cases` of the ranges, dB.
    """
    middle, deviation = levels[0], levels - levels[0]
    first = len(levels) - len(ENDS) * len(ranges)  # row of the first case in which one parameter varies alone
    low, high = quantiles(deviation[1:first] if ranges else deviation, ENDS)
    ends = deviation[first:].reshape(len(ranges), len(ENDS), middle.size)
    alone = dict(zip(ranges, ends, strict=True))
    below = _parts(-low, {name: -np.min(rows, axis=0) for name, rows in alone.items()})
    above = _parts(high, {name: np.max(rows, axis=0) for name, rows in alone.items()})
    return tuple(
        LevelBand(float(middle[k]), _entries(below, k), _entries(above, k)) for k in range(middle.size)
    )


def _cases(ranges: Mapping[str, Range], count: int) -> Iterator[dict[str, float]]:
    """Yield values of all parameters, spread evenly: scrambled points of Sobol's sequence."""
    from scipy.stats.qmc import Sobol  # noqa: PLC0415 (start-up time)

    for shares in Sobol(len(ranges), seed=SEED).random(count).tolist():
        yield {name: span.at(share) for share, (name, span) in zip(shares, ranges.items(), strict=True)}


def _parts(total: FloatArray, alone: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Return deviations, at least 0, whose squares add up to `total` squared; the rest is `JOINTLY`."""
    square = np.maximum(total, 0.0) ** 2
    squares = {name: np.maximum(value, 0.0) ** 2 for name, value in alone.items()}
    sum_of_squares = np.sum([np.zeros_like(square), *squares.values()], axis=0)  # zeros: no parameter at all
    share = np.minimum(square / np.maximum(sum_of_squares, 1e-300), 1.0)  # 1e-300: no division by zero
    deviations = {name: np.sqrt(share * value) for name, value in squares.items()}
    return {**deviations, JOINTLY: np.sqrt(np.maximum(square - sum_of_squares, 0.0))}


def _entries(deviations: Mapping[str, FloatArray], index: int) -> dict[str, float]:
    return {name: float(values[index]) for name, values in deviations.items()}
