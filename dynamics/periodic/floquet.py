"""Floquet multipliers of a periodic motion: whether and how it loses stability."""

from __future__ import annotations

from enum import Enum

import numpy as np

from dynamics.types import ComplexArray, FloatArray

ON_THE_CIRCLE = 1e-6  # multipliers of undamped motions lie on it but for rounding


class Instability(Enum):
    """Through which point the largest multiplier has left the unit circle."""

    NONE = "stable"
    FOLD = "real, above 1"
    PERIOD_DOUBLING = "real, below -1"
    NEIMARK_SACKER = "complex pair"


def floquet_multipliers(monodromy: FloatArray) -> ComplexArray:
    """Return the eigenvalues of the derivative of the map over one period, by falling size, (2n,)."""
    values = np.linalg.eigvals(monodromy).astype(complex)
    return np.asarray(values[np.argsort(-np.abs(values), kind="stable")])


def instability(multipliers: ComplexArray) -> Instability:
    """Return what the largest of `multipliers` (2n,) says."""
    largest = complex(multipliers[0])
    if abs(largest) <= 1.0 + ON_THE_CIRCLE:
        return Instability.NONE
    if abs(largest.imag) > ON_THE_CIRCLE * abs(largest):
        return Instability.NEIMARK_SACKER
    return Instability.FOLD if largest.real > 0.0 else Instability.PERIOD_DOUBLING
