"""Deep groove and angular contact ball bearings by their internal geometry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from bounds import Declared, Kind, below, between, declared, described, required
from dynamics.bearings.row import ANGLE, CLEARANCE, COUNT, DIAMETER, PITCH, Row
from dynamics.checks import positive
from dynamics.errors import InputError
from dynamics.shafts.inertia import STEEL_POISSON_RATIO, STEEL_YOUNGS_MODULUS

# Hertz contact of two elastic bodies over an ellipse, by exact integrals.


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


GROOVE = Declared(Kind.RATIO, "", between(0.501, 1.0), "Groove radius over ball diameter", 0.52)
MODULUS = Declared(Kind.STIFFNESS, "Pa", between(1e9, 1e12), "Young's modulus of rings and balls", 206e9)
POISSON = Declared(Kind.RATIO, "", between(0.0, 0.49), "Poisson's ratio of rings and balls", 0.3)


@described
@dataclass(frozen=True)
class BallBearing(Row):
    """A single row of balls, without shoulders: with clearance both flanks of the grooves carry.

    Balls have neither mass nor friction: no centrifugal force, no gyroscopic moment, so that inner and outer
    contact have the same angle. Rings are rigid but for the contacts. The bearing's center is the plane of
    the balls' centers where they just touch. A contact angle of 0 is a deep groove bearing, whose free
    contact angle follows from its clearance.
    """

    count: int = required(COUNT)
    diameter: float = required(DIAMETER)
    pitch_diameter: float = required(PITCH)
    inner_groove: float = declared(0.52, GROOVE)
    outer_groove: float = declared(0.53, GROOVE)
    contact_angle: float = declared(0.0, ANGLE)
    clearance: float = declared(0.0, CLEARANCE)
    youngs_modulus: float = declared(STEEL_YOUNGS_MODULUS, MODULUS)
    poisson_ratio: float = declared(STEEL_POISSON_RATIO, POISSON)

    def __post_init__(self) -> None:
        self.check_row()
        if self.contact_angle == 0.0 and self.clearance >= 2.0 * self.groove_distance:
            bound = below(2.0 * self.groove_distance, "m", "where the grooves hold nothing")
            raise InputError("clearance", self.clearance, bound, "Reduce it, or widen the grooves.")

    @property
    def groove_distance(self) -> float:
        """Return A, the distance of both grooves' centers of curvature around a ball that just touches, m."""
        return (self.inner_groove + self.outer_groove - 1.0) * self.diameter

    @property
    def free_contact_angle(self) -> float:
        """Return the angle of the contacts where the balls just touch under an axial force, rad."""
        if self.contact_angle != 0.0:
            return self.contact_angle
        return math.acos(min(1.0, 1.0 - self.clearance / (2.0 * self.groove_distance)))

    def contacts(self) -> tuple[EllipticContact, EllipticContact]:
        """Return the contacts of a ball with the inner and the outer groove."""
        modulus = self.youngs_modulus / (2.0 * (1.0 - self.poisson_ratio**2))
        radius = self.diameter / 2.0

        def contact(rolling: float, groove: float) -> EllipticContact:
            return EllipticContact(radius * rolling, 1.0 / (1.0 / radius - 1.0 / groove), modulus)

        inner, outer = self.inner_groove * self.diameter, self.outer_groove * self.diameter
        return contact(1.0 - self.slenderness, inner), contact(1.0 + self.slenderness, outer)

    @cached_property
    def element_stiffness(self) -> float:
        """Return c of load = c approach^1.5 of a ball between both grooves, N/m^1.5."""
        compliance = sum(contact.spring_constant ** (-2.0 / 3.0) for contact in self.contacts())
        return float(compliance**-1.5)

    @property
    def laminae(self) -> int:
        """Return the number of parts of an element: a ball is whole."""
        return 1

    def peak_pressure(self, load: float) -> float:
        """Return the larger of the peak pressures of a ball under `load` (N) on both rings, Pa."""
        return max(contact.peak_pressure(load) for contact in self.contacts()) if load > 0.0 else 0.0
