"""The laws by which a relief grows from nothing to its amount."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fe_contact.types import FloatArray

Shape = Literal["linear", "parabolic", "circular", "exponential", "logarithmic"]
"""Names of the shapes, as in REXS 2.0 (attribute ``shape_of_relief``)."""

_GROWTH = math.e - 1.0  # scales the exponential and the logarithm to a depth of 1 at the end


@dataclass(frozen=True)
class ReliefShape:
    """The depth of a relief over the fraction of its length, both 0 where it starts and 1 at its end."""

    depth: Callable[[FloatArray, float], FloatArray]
    """Depth (...) at fractions (...) from 0 to 1, of a relief whose amount is `ratio` times its length."""
    slope: float
    """Derivative of the depth where it starts; 0 = tangential."""
    bend: Callable[[float], float]
    """Second derivative where it starts, as a function of the ratio."""

    def __call__(self, fraction: FloatArray, ratio: float) -> FloatArray:
        """Return the relative depth at fractions of the length: 0 before it starts, 1 from its end on."""
        return self.depth(np.minimum(np.maximum(fraction, 0.0), 1.0), ratio)


def _arc(fraction: FloatArray, ratio: float) -> FloatArray:
    """Return the depth of a circle of radius (1 + ratio^2) / (2 ratio) lengths, valid for ratio 0, too."""
    diameter = 1.0 + ratio**2
    rise = np.sqrt(diameter**2 - (2.0 * ratio * fraction) ** 2)
    return np.asarray(2.0 * fraction**2 / (diameter + rise))


SHAPES: dict[Shape, ReliefShape] = {
    "linear": ReliefShape(lambda u, _: u, 1.0, lambda _: 0.0),
    "parabolic": ReliefShape(lambda u, _: u**2, 0.0, lambda _: 2.0),
    "circular": ReliefShape(_arc, 0.0, lambda ratio: 2.0 / (1.0 + ratio**2)),
    "exponential": ReliefShape(lambda u, _: np.expm1(u) / _GROWTH, 1.0 / _GROWTH, lambda _: 1.0 / _GROWTH),
    "logarithmic": ReliefShape(lambda u, _: np.log1p(_GROWTH * u), _GROWTH, lambda _: -(_GROWTH**2)),
}
"""The shapes by their names.

The arc touches the involute where it starts. Exponential is (e^u - 1)/(e - 1), logarithmic its mirror image
at the diagonal, ln(1 + (e - 1) u): the laws of these names without a further parameter.
"""
