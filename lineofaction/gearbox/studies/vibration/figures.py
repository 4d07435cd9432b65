"""Figures of a vibration at each point, and contributions to it at one speed and order, in SI."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bounds.types import ComplexArray, FloatArray
from dynamics.vibration.vibration_analysis import Shares


@dataclass(frozen=True)
class PointVelocity:
    """Velocity of a point at S speeds in H orders, root mean square, m/s."""

    velocity: FloatArray
    """Velocity of all axes together. Shape (H, S)."""
    velocity_xyz: FloatArray
    """Velocity along x, y, z. Shape (3, H, S)."""
    overall: FloatArray
    """Velocity of all orders together. Shape (S,)."""
    left_out: FloatArray
    overall_error: FloatArray
    """`left_out`, `overall_error`: Part of `overall` in orders that are not listed, and the error of
    `overall` for these orders. Shape (S,) each.
    """
    level: FloatArray
    """Level of `velocity`, dB. Shape (H, S)."""


def root_mean_square(velocity: ComplexArray) -> FloatArray:
    """Return root mean squares (3, S, H) of peak amplitudes along x, y, z."""
    return np.asarray(np.abs(velocity) / np.sqrt(2.0))


@dataclass(frozen=True)
class Contribution:
    """Share of a bearing or mode in the mean square of points and hull; the shares sum to 1."""

    name: str
    frequency: float
    """Natural frequency, Hz; NaN for a bearing."""
    points: dict[str, float]
    surface: float
    """Share in the mean square of the outer hull; NaN without a surface."""


@dataclass(frozen=True)
class Contributions:
    """Contributions at one speed, rad/s, and order, whose frequency is in Hz."""

    speed: float
    order: float
    frequency: float
    bearings: list[Contribution]
    modes: list[Contribution]


def contributions_of(shares: Shares, points: Sequence[str]) -> list[Contribution]:
    """Return the parts of shares, each by the names of points."""
    return [
        Contribution(
            name,
            float(shares.frequency[part]),
            dict(zip(points, shares.point[:, part].tolist(), strict=True)),
            float(shares.surface[part]),
        )
        for part, name in enumerate(shares.name)
    ]
