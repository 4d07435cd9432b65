"""Deep groove and angular contact ball bearings by their internal geometry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from bounds import Declared, Kind, below, between, declared, described, required
from dynamics.bearing_rows.elliptic_contact import EllipticContact
from dynamics.bearing_rows.row import ANGLE, CLEARANCE, COUNT, DIAMETER, PITCH, Row
from dynamics.bodies.steel import STEEL_POISSON_RATIO, STEEL_YOUNGS_MODULUS
from dynamics.errors import InputError

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
