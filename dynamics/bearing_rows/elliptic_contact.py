"""Hertz contact of two elastic bodies over an ellipse, by exact integrals.

With the gap x^2/(2 R_x) + y^2/(2 R_y) of the bodies where they touch, 1/E* = 2 (1 - nu^2)/E for equal bodies,
the axes a >= b of the ellipse, q = b/a and Carlson's symmetric integrals of (0, q^2, 1) [1]_:

    R_small/R_large = R_D(0, q^2, 1)/R_D(0, 1, q^2),    a^3 = Q R_small R_D(0, 1, q^2)/(pi E*),
    approach = 3 Q R_F(0, q^2, 1)/(2 pi E* a),          p_0 = 3 Q/(2 pi a b).

References
----------
.. [1] K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, section 4.2, in Carlson's integrals:
   NIST Digital Library of Mathematical Functions, 19.25(i).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from dynamics.checks import positive

LEAST_RATIO = 1e-12  # of the axes: radii that differ by 23 orders of magnitude


@dataclass(frozen=True)
class EllipticContact:
    """A Hertz contact.

    Attributes
    ----------
    small_radius, large_radius : float
        Relative radii of curvature in the two principal planes, m, > 0.
    modulus : float
        E*, Pa.
    """

    small_radius: float
    large_radius: float
    modulus: float

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

        def missed(logarithm: float) -> float:
            square = math.exp(2.0 * logarithm)
            return math.log(elliprd(0.0, square, 1.0) / elliprd(0.0, 1.0, square)) - math.log(ratio)

        # below 0 by as much as rounding needs where the radii are almost equal
        return math.exp(float(brentq(missed, math.log(LEAST_RATIO), 1e-12, xtol=1e-15)))

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
        """Return how far the bodies approach under `load` (N, > 0), m."""
        from scipy.special import elliprf  # noqa: PLC0415 (start-up time)

        a, b = self.axes(load)
        return 1.5 * load * float(elliprf(0.0, (b / a) ** 2, 1.0)) / (math.pi * self.modulus * a)

    def peak_pressure(self, load: float) -> float:
        """Return the peak pressure under `load` (N, > 0), Pa."""
        a, b = self.axes(load)
        return 1.5 * load / (math.pi * a * b)
