"""Hertz contact of two elastic bodies over an ellipse, by exact integrals."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dynamics.checks import positive

MIN_RATIO = 1e-12  # least ratio of the axes: that of radii which differ by 23 orders of magnitude


@dataclass(frozen=True)
class EllipticContact:
    """A Hertz contact."""

    small_radius: float
    large_radius: float
    """`small_radius`, `large_radius`: Relative radii of curvature in the two principal planes, m, > 0."""
    modulus: float
    """E*, Pa."""

    def __post_init__(self) -> None:
        for name in ("small_radius", "large_radius", "modulus"):
            positive(name, getattr(self, name))

    @property
    def axis_ratio(self) -> float:
        """Return b/a, from 0 to 1."""
        from scipy.optimize import brentq  # noqa: PLC0415 (start-up time)
        from scipy.special import elliprd  # noqa: PLC0415 (start-up time)

        ratio = self.small_radius / self.large_radius
        if ratio > 1.0:
            return EllipticContact(self.large_radius, self.small_radius, self.modulus).axis_ratio
        if math.isclose(ratio, 1.0, rel_tol=1e-14):
            return 1.0

        def residual(logarithm: float) -> float:
            """Return how far radii are off that give an ellipse with b/a of this logarithm."""
            square = math.exp(2.0 * logarithm)
            return math.log(elliprd(0.0, square, 1.0) / elliprd(0.0, 1.0, square)) - math.log(ratio)

        # the root is at most 0, but rounding may lift that of almost equal radii: the bracket ends above 0
        return math.exp(float(brentq(residual, math.log(MIN_RATIO), 1e-12, xtol=1e-15)))

    @property
    def spring_constant(self) -> float:
        """Return c of load = c approach^1.5, N/m^1.5."""
        return float((1.0 / self.approach(1.0)) ** 1.5)

    def axes(self, load: float) -> tuple[float, float]:
        """Return the half-axes a >= b of the ellipse under `load` (N), m."""
        from scipy.special import elliprd  # noqa: PLC0415 (start-up time)

        q, radius = self.axis_ratio, min(self.small_radius, self.large_radius)
        a = (load * radius * float(elliprd(0.0, 1.0, q * q)) / (math.pi * self.modulus)) ** (1.0 / 3.0)
        return a, q * a

    def approach(self, load: float) -> float:
        """Return the approach of the bodies under `load` (N, > 0), m."""
        from scipy.special import elliprf  # noqa: PLC0415 (start-up time)

        a, b = self.axes(load)
        return 1.5 * load * float(elliprf(0.0, (b / a) ** 2, 1.0)) / (math.pi * self.modulus * a)

    def peak_pressure(self, load: float) -> float:
        """Return the peak pressure under `load` (N, > 0), Pa."""
        a, b = self.axes(load)
        return 1.5 * load / (math.pi * a * b)
