"""Rolling bearings by their internal geometry: rows of balls and of rollers, their contacts, their seats.

References
----------
.. [1] ISO/TS 16281:2008, Rolling bearings - Methods for calculating the modified reference rating life for
   universally loaded bearings: stiffness of line contact, profiles of rollers.
.. [2] ISO 5593:2019, Rolling bearings - Vocabulary: locating and non-locating bearing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bounds import (
    Choice,
    Declared,
    Kind,
    above,
    below,
    between,
    declared,
    described,
    inside,
    integers,
    required,
)
from dynamics.bearings.elliptic_contact import EllipticContact
from dynamics.bearings.ring_fits import BORE, OUTSIDE, RingFits
from dynamics.bearings.seat import POSITION, SEAT_TEMPERATURE, Bushing
from dynamics.checks import declared_fields, one_of
from dynamics.errors import InputError
from dynamics.shafts.bodies import (
    EXPANSION,
    STEEL_EXPANSION,
    STEEL_POISSON_RATIO,
    STEEL_YOUNGS_MODULUS,
    TEMPERATURE,
)
from dynamics.types import FloatArray

COUNT = Declared(Kind.COUNT, "", integers(3, 500), "Number of rolling elements", 8)
DIAMETER = Declared(Kind.LENGTH, "m", between(1e-4, 10.0), "Diameter of a rolling element", 0.008)
PITCH = Declared(Kind.LENGTH, "m", between(1e-4, 100.0), "Diameter of the circle of their centers", 0.039)
ANGLE = Declared(
    Kind.ANGLE,
    "rad",
    between(-math.radians(85.0), math.radians(85.0)),
    "Free contact angle; positive: the bearing holds a shaft that is pushed along z, negative: against z",
    math.radians(40.0),
)
CLEARANCE = Declared(
    Kind.LENGTH,
    "m",
    between(-0.01, 0.01),
    "Play: across the axis between both extremes where the contact angle is 0, otherwise along the axis to "
    "contact; negative: preload",
    1e-5,
    written="µm",
)
RATING = Declared(Kind.FORCE, "N", between(1.0, 1e9), "Basic static load rating C_0", 11600.0)
GROOVE = Declared(Kind.RATIO, "", between(0.501, 1.0), "Groove radius over ball diameter", 0.52)
MODULUS = Declared(Kind.STIFFNESS, "Pa", between(1e9, 1e12), "Young's modulus of rings and balls", 206e9)
POISSON = Declared(Kind.RATIO, "", between(0.0, 0.49), "Poisson's ratio of rings and balls", 0.3)
LOGARITHMIC, CROWNED, STRAIGHT = "logarithmic", "crowned", "straight"
PROFILES = (LOGARITHMIC, CROWNED, STRAIGHT)
LINE_STIFFNESS = 35948e6  # N/m^2: 35948 N/mm^2 of [1]_, of steel rollers between steel raceways
LONG = 2.5  # diameters: longer cylindrical rollers are straight in their middle
LENGTH = Declared(Kind.LENGTH, "m", between(1e-4, 10.0), "Effective length of a roller", 0.0136)
PROFILE = Declared(Kind.CHOICE, "", Choice(PROFILES), "Profile of a roller", LOGARITHMIC)
CROWN = Declared(
    Kind.AMOUNT,
    "m",
    between(0.0, 1e-3),
    "Drop of a crowned profile at the ends of the roller, at each contact",
    1e-5,
)
LAMINAE = Declared(Kind.COUNT, "", integers(1, 1000), "Laminae of a roller; ISO/TS 16281: at least 30", 30)
BOTH, POSITIVE, NEGATIVE, NONE = "both", "positive", "negative", "none"
LOCATING = Declared(
    Kind.CHOICE,
    "",
    Choice((BOTH, POSITIVE, NEGATIVE, NONE)),
    "Directions along z in which its rings are held in their seats. positive, negative: only against a shaft "
    "that is pushed along z, against z, as in a cross-located pair; none: a non-locating (floating) bearing, "
    "one ring of which slides",
    BOTH,
    omit_default=True,
)  # [2]_
ALONG, AGAINST = 1, 2  # bits of the directions in which the seats hold the rings: along z, against z
LOCATED = {BOTH: ALONG | AGAINST, POSITIVE: ALONG, NEGATIVE: AGAINST, NONE: 0}
"""The directions as bits."""
AXIAL_PRELOAD = Declared(
    Kind.FORCE,
    "N",
    between(-1e9, 1e9),
    "Axial force of the inner ring on the outer where the shaft is not displaced; along z, with the sign of "
    "the contact angle",
    500.0,
)
DAMPING_RATIO = Declared(
    Kind.RATIO,
    "",
    between(0.0, 10.0),
    "Damping ratio of the shaft bouncing on its bearings under the nominal mesh forces",
    0.05,
)
DYNAMIC_CAPACITY = Declared(
    Kind.FORCE,
    "N",
    between(1.0, 1e9),
    "Basic dynamic load rating C of the row (ISO 281), from which its rating life follows; default: no life",
    22500.0,
    omit_default=True,
)
_FITS = Declared(
    Kind.PART,
    "",
    None,
    "Fits of its rings; left out: at temperature the rings expand by themselves",
    part=RingFits,
    omit_default=True,
)
_INNER = replace(TEMPERATURE, description="Steady temperature of the inner ring")
_OUTER = replace(TEMPERATURE, description="Steady temperature of the outer ring", example=70.0)


class _Row:
    """A row of equal elements, evenly spaced by a cage."""

    count: int
    diameter: float
    pitch_diameter: float
    contact_angle: float
    clearance: float

    @property
    def slenderness(self) -> float:
        """Return gamma: element diameter times the cosine of the contact angle, over the pitch diameter."""
        return self.diameter * math.cos(self.contact_angle) / self.pitch_diameter

    @property
    def raceways(self) -> tuple[float, float]:
        """Return the diameters of the inner and the outer raceway where they touch an element, m."""
        across = self.diameter * math.cos(self.contact_angle)
        return self.pitch_diameter - across, self.pitch_diameter + across

    @property
    def cage_ratio(self) -> float:
        """Return the speed of the cage over that of the inner ring, the outer at rest and nothing slips."""
        return (1.0 - self.slenderness) / 2.0

    def check_row(self) -> None:
        """Refuse a value that is no row.

        Raises `InputError`: a field out of its bounds, or more elements than their circle holds.
        """
        declared_fields(self)
        minimum = self.diameter / math.sin(math.pi / self.count)
        if self.pitch_diameter <= minimum:
            bound = above(minimum, "m", "where the elements touch each other")
            suggestion = "Check number and diameter of the elements."
            raise InputError("pitch_diameter", self.pitch_diameter, bound, suggestion)


@described
@dataclass(frozen=True)
class CatalogLine:
    """Catalog data of a deep groove ball bearing, and its clearance, which no catalog states."""

    bore: float = required(BORE)
    outside_diameter: float = required(OUTSIDE)
    static_rating: float = required(RATING)
    clearance: float = declared(0.0, CLEARANCE)

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.outside_diameter <= self.bore:
            raise InputError("outside_diameter", self.outside_diameter, above(self.bore, "m", "the bore"))


@described
@dataclass(frozen=True)
class BallBearing(_Row):
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
        """Return the number of laminae, of which a ball has one."""
        return 1

    def peak_pressure(self, load: float) -> float:
        """Return the larger of the peak pressures of a ball under `load` (N) on both rings, Pa."""
        return max(contact.peak_pressure(load) for contact in self.contacts()) if load > 0.0 else 0.0


@described
@dataclass(frozen=True)
class RollerBearing(_Row):
    """A single row of steel rollers, each cut into laminae.

    A contact angle of 0 is a cylindrical roller bearing, which carries no axial force: state its ribs as a
    spring curve in z. The rib of a tapered one carries what the raceways leave over and yields nothing.
    Rollers have no mass, and lie halfway between raceways that tilt against each other. The bearing's center
    is the plane of the rollers' middles.
    """

    count: int = required(COUNT)
    diameter: float = required(DIAMETER)
    length: float = required(LENGTH)
    pitch_diameter: float = required(PITCH)
    contact_angle: float = declared(0.0, ANGLE)
    clearance: float = declared(0.0, CLEARANCE)
    profile: str = declared(LOGARITHMIC, PROFILE)
    crown: float = declared(0.0, CROWN)
    laminae: int = declared(30, LAMINAE)

    def __post_init__(self) -> None:
        self.check_row()

    @property
    def play(self) -> float:
        """Return the approach along the normal at which the middle of a roller just touches, m."""
        tapered = self.contact_angle != 0.0
        return self.clearance * (abs(math.sin(self.contact_angle)) if tapered else 0.5)

    @property
    def lamina_places(self) -> FloatArray:
        """Return the middles of the laminae along a roller, (laminae,), m from its middle."""
        return np.asarray((np.arange(self.laminae) + 0.5) / self.laminae - 0.5) * self.length

    @property
    def lamina_stiffness(self) -> float:
        """Return c of one lamina, N/m^(10/9): both contacts in series (ISO/TS 16281)."""
        return float(LINE_STIFFNESS * self.length ** (8.0 / 9.0) / self.laminae)

    @property
    def element_stiffness(self) -> float:
        """Return c of load = c approach^(10/9) of a straight roller between both raceways, N/m^(10/9)."""
        return self.laminae * self.lamina_stiffness

    def drop(self, coordinate: FloatArray) -> FloatArray:
        """Return the drop of the profile below the middle at a `coordinate`, m; one contact."""
        length, diameter, tapered = self.length, self.diameter, self.contact_angle != 0.0
        if self.profile != LOGARITHMIC:
            crown = self.crown if self.profile == CROWNED else 0.0
            return np.asarray(crown * (2.0 * coordinate / length) ** 2)
        straight = 0.0  # length of the straight middle, m
        factor = 0.00045 if tapered else 0.00035  # of [1]_, as the factor of long rollers
        if not tapered and length > LONG * diameter:
            straight, factor = length - LONG * diameter, 0.0005
        ratio = np.maximum(2.0 * np.abs(coordinate) - straight, 0.0) / (length - straight)
        return np.asarray(-factor * diameter * np.log1p(-(ratio**2)))

    def peak_pressure(self, load: float) -> float:
        """Return the Hertz pressure of a lamina under `load` (N) on the inner ring, the smaller one, Pa.

        Steel on steel: p_0 = sqrt(q E*/(pi R)), q load over length, R = D (1 - gamma)/2.
        """
        modulus = STEEL_YOUNGS_MODULUS / (2.0 * (1.0 - STEEL_POISSON_RATIO**2))
        radius = self.diameter * (1.0 - self.slenderness) / 2.0
        return math.sqrt(load * self.laminae / self.length * modulus / (math.pi * radius))


def check_locating(row: BallBearing | RollerBearing, locating: str) -> None:
    """Refuse a row with a contact angle of which a ring slides: it would carry nothing at all.

    Raises `InputError`: `locating` is none of the choices, or the row has a contact angle and not both
    directions are held.
    """
    one_of("locating", locating, list(LOCATED))
    if locating != BOTH and row.contact_angle != 0.0:
        bound = f'"{BOTH}" with a contact angle, whose sign is the direction in which the row holds'
        raise InputError("locating", locating, bound, "State the contact angle's sign instead.")


@described
@dataclass(frozen=True)
class RollingBearing:
    """One row of balls or rollers whose inner ring sits on the shaft and whose outer ring the ground holds.

    Its five displacements are those of the shaft's section; force and moment are about the row's center. Rows
    of one bearing, or bearings side by side, are several of these, each at its own position.

    Its rings are held in their seats along the axis, or one slides (`locating`): a non-locating ball bearing
    carries no axial force. Rows of cylindrical rollers carry none in either case.

    An element of load Q pushes back with ``Q (1 + d p')``, p' the rate at which it is pressed, and never
    pulls (Hunt and Crossley); d follows from `damping_ratio` with the mass of the shaft and its gears divided
    by the number of its bearings.

    `axial_shift` (m) is the displacement of the inner ring along z against the outer, in addition to that by
    the preload. Of a bearing at temperature it also holds that of the preload as drawn.
    """

    name: str
    shaft: str
    row: BallBearing | RollerBearing
    position: float = required(POSITION)
    axial_preload: float = declared(0.0, AXIAL_PRELOAD)
    damping_ratio: float = declared(0.05, DAMPING_RATIO)
    dynamic_capacity: float | None = declared(None, DYNAMIC_CAPACITY)
    locating: str = declared(BOTH, LOCATING)
    inner_temperature: float | None = declared(None, _INNER)
    outer_temperature: float | None = declared(None, _OUTER)
    seat_temperature: float | None = declared(None, SEAT_TEMPERATURE)
    thermal_expansion: float = declared(STEEL_EXPANSION, EXPANSION)
    fits: RingFits | None = declared(None, _FITS)
    axial_shift: float = 0.0

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.fits is not None:
            with inside("fits"):
                self.fits.check_around(self.row.raceways)
        angle, preload = self.row.contact_angle, self.axial_preload
        if preload != 0.0 and angle == 0.0 and isinstance(self.row, RollerBearing):
            bound = "0: cylindrical rollers carry no axial force"
            raise InputError("axial_preload", preload, bound)
        if preload * angle < 0.0:
            bound = f"{'positive' if angle > 0.0 else 'negative'}, as the contact angle is"
            raise InputError("axial_preload", preload, bound, "The row carries no other axial force.")
        check_locating(self.row, self.locating)
        if preload != 0.0 and self.locating != BOTH:
            bound = f'0 where a ring slides (locating = "{self.locating}")'
            raise InputError("axial_preload", preload, bound, f'State locating = "{BOTH}", or no preload.')

    @property
    def bushing(self) -> str:
        """Name of the support whose force it is."""
        return self.name

    @property
    def support(self) -> Bushing:
        """The support at which it acts, without any stiffness of its own."""
        return Bushing(self.name, self.shaft, self.position)
