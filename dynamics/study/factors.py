"""Factors of a study: levels that form a grid, values in a list, and distributions that are sampled."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.special import ndtr, ndtri

from bounds import above, at_least
from dynamics.checks import finite, positive
from dynamics.errors import InputError
from dynamics.types import FloatArray


@dataclass(frozen=True)
class Levels:
    """Levels of a factor, each of which meets every level of the others."""

    values: tuple[float, ...]
    kind: ClassVar[str] = "grid"

    def __post_init__(self) -> None:
        _check_values("levels", self.values)


@dataclass(frozen=True)
class Listed:
    """Values of a factor that change together with those of the other listed factors, entry by entry."""

    values: tuple[float, ...]
    kind: ClassVar[str] = "list"

    def __post_init__(self) -> None:
        _check_values("values", self.values)


@dataclass(frozen=True)
class Normal:
    """A normal distribution, cut off at `low` and `high`.

    Attributes
    ----------
    mean, standard_deviation : float
        Before it is cut off.
    low, high : float
        What lies beyond is rejected; infinite: nothing.
    """

    mean: float
    standard_deviation: float
    low: float = -math.inf
    high: float = math.inf
    kind: ClassVar[str] = "normal"

    def __post_init__(self) -> None:
        finite("normal.mean", self.mean)
        positive("normal.standard_deviation", self.standard_deviation)
        if not self.low < self.high:
            raise InputError("normal.high", self.high, above(self.low, note=", which is low"))

    def quantile(self, fraction: FloatArray) -> FloatArray:
        """Return the values below which the `fraction` of all lies."""
        low, high = (ndtr((end - self.mean) / self.standard_deviation) for end in (self.low, self.high))
        inside = self.mean + self.standard_deviation * ndtri(low + (high - low) * fraction)
        return np.asarray(np.clip(inside, self.low, self.high))


@dataclass(frozen=True)
class Uniform:
    """A uniform distribution between `low` and `high`."""

    low: float
    high: float
    kind: ClassVar[str] = "uniform"

    def __post_init__(self) -> None:
        if finite("uniform.high", self.high) < finite("uniform.low", self.low):
            raise InputError("uniform.high", self.high, at_least(self.low, note=", which is low"))

    def quantile(self, fraction: FloatArray) -> FloatArray:
        """Return the values below which the `fraction` of all lies."""
        return np.asarray(self.low + (self.high - self.low) * fraction)


Distribution = Normal | Uniform
Factor = Levels | Listed | Normal | Uniform


def _check_values(field: str, values: tuple[float, ...]) -> None:
    """Refuse an empty list, and what is no number."""
    if not values:
        raise InputError(field, values, "at least one value")
    for index, value in enumerate(values):
        finite(f"{field}[{index}]", value)
