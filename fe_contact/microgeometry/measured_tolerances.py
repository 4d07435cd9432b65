"""Deviations of a population of measured gears, in place of those that a tolerance allows.

A *figure* is one deviation of a gear, named ``gear.quantity``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bounds import SiNote
from fe_contact.errors import InputError, finite, within
from fe_contact.microgeometry.tolerances import PROCESS_SPREAD, Tolerances
from fe_contact.types import FloatArray, Json

_LEAST = 1e-9
"""Least standard deviation of a figure, m. A population without scatter gets it too, because no deviation of
a study may have the width zero."""
_ROUNDING = 1e-9
"""An eigenvalue of a correlation matrix down to minus this is a zero with the rounding of its input."""


@dataclass(frozen=True)
class MeasuredTolerances(Tolerances):
    """Tolerances in which some figures have the means, deviations and correlations of measured gears.

    The width of a measured figure is three of its standard deviations. Its normal distribution is truncated
    at this width, as that of every other figure is.
    """

    mean: Mapping[str, float] = field(default_factory=dict)
    """``gear.quantity`` to the mean deviation of the measured gears, m."""
    correlation: Mapping[tuple[str, str], float] = field(default_factory=dict)
    """Two names of measured figures to their correlation, -1 to 1; a pair that is not named has 0."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, mean in self.mean.items():
            finite(f"tolerances.mean.{name}", mean, SiNote("In m: 10 µm is 1e-5."))
            if name not in self.modification:
                raise InputError("tolerances.mean", name, "a figure with a standard deviation")
        for pair, value in self.correlation.items():
            within("tolerances.correlation", value, -1.0, 1.0)
            if pair[0] == pair[1] or not {*pair} <= {*self.mean}:
                raise InputError("tolerances.correlation", "*".join(pair), "of two figures with a mean")
        _ = self._factor  # raises where no gears can have the correlations

    @property
    def _factor(self) -> FloatArray:
        """Symmetric square root (m, m) of the correlation matrix of the m measured figures."""
        names = list(self.mean)
        matrix = np.eye(len(names))
        for (first, second), value in self.correlation.items():
            i, j = names.index(first), names.index(second)
            matrix[[i, j], [j, i]] = value
        values, vectors = np.linalg.eigh(matrix)
        if values.min(initial=1.0) < -_ROUNDING:
            remedy = "State fewer or smaller correlations."
            raise InputError("tolerances.correlation", self._pairs, "one of gears that can exist", remedy)
        return np.asarray((vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)

    @property
    def _pairs(self) -> dict[str, float]:
        return {"*".join(pair): value for pair, value in self.correlation.items()}

    def sample(self, count: int, seed: int) -> FloatArray:
        """Draw deviations (count, d) in m; those of measured figures correlate about their means."""
        deviation = super().sample(count, seed)
        names, widths = list(self.widths), np.array(list(self.widths.values()))
        columns = [names.index(name) for name in self.mean]
        standard = widths[columns] / PROCESS_SPREAD
        correlated = deviation[:, columns] / standard @ self._factor.T
        deviation[:, columns] = np.array(list(self.mean.values())) + correlated * standard
        return deviation

    @property
    def distributions(self) -> tuple[Any, ...]:
        """Distributions of single deviations in the order of `widths`, each a frozen one of scipy."""
        from scipy.stats import truncnorm  # noqa: PLC0415 (start-up time)

        distributions = dict(zip(self.widths, super().distributions, strict=True))
        for name, mean in self.mean.items():
            deviation = self.widths[name] / PROCESS_SPREAD
            distributions[name] = truncnorm(-PROCESS_SPREAD, PROCESS_SPREAD, loc=mean, scale=deviation)
        return tuple(distributions.values())

    def to_json(self) -> Json:
        """Return plain JSON."""
        return super().to_json() | {"mean_m": dict(self.mean), "correlation": self._pairs}


def measured_tolerances(
    of_class: Tolerances,
    mean: Mapping[str, float],
    deviation: Mapping[str, float],
    correlation: Mapping[tuple[str, str], float],
) -> MeasuredTolerances:
    """Return tolerances with figures of measured gears in place of those of a class.

    Raises `InputError`: a figure that no flank has, or a correlation that no gears can have.

    Parameters
    ----------
    mean, deviation : mapping
        ``gear.quantity`` to the mean deviation from the design and its standard deviation, m.
    correlation : mapping
        Two of these names to their correlation.
    """
    if of_class.distribution != "normal":
        raise InputError("distribution", of_class.distribution, '"normal" with measured gears')
    widths = {name: PROCESS_SPREAD * max(value, _LEAST) for name, value in deviation.items()}
    modification = {**of_class.modification, **widths}
    return MeasuredTolerances(of_class.misalignment, modification, of_class.distribution, mean, correlation)
