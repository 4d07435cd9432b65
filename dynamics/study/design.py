"""The design of a study: which values of its factors are run together."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from bounds import above, at_least, at_most
from dynamics.checks import finite, integer, positive
from dynamics.errors import InputError
from dynamics.types import FloatArray
from host.optional_modules import special

MAX_POINTS = 1_000_000  # most points of a design


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
    """A normal distribution, cut off at `low` and `high`."""

    mean: float
    standard_deviation: float
    """`mean`, `standard_deviation`: Mean and standard deviation of the distribution before it is cut off."""
    low: float = -math.inf
    high: float = math.inf
    """`low`, `high`: Bounds at which the distribution is cut off; infinite: none."""
    kind: ClassVar[str] = "normal"

    def __post_init__(self) -> None:
        finite("normal.mean", self.mean)
        positive("normal.standard_deviation", self.standard_deviation)
        if not self.low < self.high:
            raise InputError("normal.high", self.high, above(self.low, note=", which is low"))

    def quantile(self, fraction: FloatArray) -> FloatArray:
        """Return the values below which the `fraction` of all lies."""
        low, high = (
            special.ndtr((end - self.mean) / self.standard_deviation) for end in (self.low, self.high)
        )
        inside = self.mean + self.standard_deviation * special.ndtri(low + (high - low) * fraction)
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


Factor = Levels | Listed | Normal | Uniform


def _check_values(field: str, values: tuple[float, ...]) -> None:
    if not values:
        raise InputError(field, values, "at least one value")
    for index, value in enumerate(values):
        finite(f"{field}[{index}]", value)


@dataclass(frozen=True)
class Design:
    """Grid x list x sample: every combination of levels meets every entry of the list and every sample.

    All combinations meet the same samples, so that differences between them are not those of two samples.
    """

    factors: Mapping[str, Factor]
    """Factors by name. Levels form a grid, the last factor changing fastest; listed values change together;
    distributions are sampled.
    """
    samples: int = 1
    """Number of samples of the distributions; 1 without any."""
    seed: int = 0
    """Equal seeds give equal samples; a larger sample begins with a smaller one."""

    def __post_init__(self) -> None:
        if not self.factors:
            raise InputError("factors", {}, "at least one factor")
        integer("samples", self.samples, 1, MAX_POINTS)
        integer("seed", self.seed, 0, 2**63 - 1)
        if bool(self._sampled) != (self.samples > 1):
            remedy = "Samples are of factors with a distribution."
            bound = "above 1 with a distribution, and 1 without"
            raise InputError("samples", self.samples, bound, remedy)
        lengths = {len(factor.values) for factor in self.factors.values() if isinstance(factor, Listed)}
        if len(lengths) > 1:
            raise InputError("values", sorted(lengths), "lists of one length: their values change together")
        cells = math.prod(self.shape) * max(lengths, default=1)
        if cells * self.samples > MAX_POINTS:
            raise InputError("factors", cells * self.samples, at_most(MAX_POINTS, note=" points"))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the factors."""
        return tuple(self.factors)

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of the factors."""
        return tuple(factor.kind for factor in self.factors.values())

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of levels of each factor of the grid."""
        return tuple(len(f.values) for f in self.factors.values() if isinstance(f, Levels))

    @cached_property
    def cells(self) -> FloatArray:
        """Combinations of grid and list (C, f): NaN where a factor is sampled."""
        grid = [np.array(f.values) for f in self.factors.values() if isinstance(f, Levels)]
        listed = [np.array(f.values) for f in self.factors.values() if isinstance(f, Listed)]
        entries = np.arange(len(listed[0]) if listed else 1)
        *levels, entry = (axis.ravel() for axis in np.meshgrid(*grid, entries, indexing="ij"))
        values = np.full((entry.size, len(self.factors)), np.nan)
        levels_of, others = iter(levels), iter(listed)
        for column, factor in enumerate(self.factors.values()):
            if isinstance(factor, Levels):
                values[:, column] = next(levels_of)
            elif isinstance(factor, Listed):
                values[:, column] = next(others)[entry]
        return values

    @cached_property
    def points(self) -> FloatArray:
        """Values of all factors at all points (C x samples, f), the samples of a combination in a row."""
        cells = self.cells
        values = np.repeat(cells, self.samples, axis=0)
        kinds = [f for f in self.factors.values() if isinstance(f, Normal | Uniform)]
        uniform = np.random.Generator(np.random.PCG64(self.seed)).random((self.samples, len(kinds)))
        columns = zip(kinds, uniform.T, strict=True)
        drawn = np.array([kind.quantile(column) for kind, column in columns]).T
        values[:, self._sampled] = np.tile(drawn, (len(cells), 1))
        return values

    @property
    def _sampled(self) -> list[int]:
        return [k for k, f in enumerate(self.factors.values()) if isinstance(f, Normal | Uniform)]
