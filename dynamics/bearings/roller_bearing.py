"""In which axial directions a bearing's rings are held in their seats: locating and non-locating bearings.

References
----------
.. [1] ISO 5593:2019, Rolling bearings - Vocabulary: locating and non-locating bearing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bounds import Choice, Declared, Kind, between, declared, described, integers, required
from dynamics.bearings.ball_bearing import BallBearing
from dynamics.bearings.row import ANGLE, CLEARANCE, COUNT, DIAMETER, PITCH, Row
from dynamics.checks import one_of
from dynamics.errors import InputError
from dynamics.shafts.inertia import STEEL_POISSON_RATIO, STEEL_YOUNGS_MODULUS
from dynamics.types import FloatArray

# Profiles of rollers, and the stiffness of their laminae, by ISO/TS 16281.


LOGARITHMIC, CROWNED, STRAIGHT = "logarithmic", "crowned", "straight"
PROFILES = (LOGARITHMIC, CROWNED, STRAIGHT)
LINE_STIFFNESS = 35948e6  # N/m^2: 35948 N/mm^2 of [1]_, of steel rollers between steel raceways
LONG = 2.5  # diameters: longer cylindrical rollers are straight in their middle


def lamina_places(length: float, laminae: int) -> FloatArray:
    """Return the middles of equal laminae along a roller of `length` (m), (laminae,), m from its middle."""
    return np.asarray((np.arange(laminae) + 0.5) / laminae - 0.5) * length


def lamina_stiffness(length: float, laminae: int) -> float:
    """Return c of one lamina of a roller of `length` (m), N/m^(10/9): both contacts in series [1]_."""
    return float(LINE_STIFFNESS * length ** (8.0 / 9.0) / laminae)


def _logarithmic_drop(place: FloatArray, diameter: float, length: float, tapered: bool) -> FloatArray:
    """Return how far the logarithmic profile [1]_ of a roller lies below its middle at `place`, m.

    Diameter and effective length in m.
    """
    straight = 0.0 if tapered or length <= LONG * diameter else length - LONG * diameter
    factor = 0.00045 if tapered else 0.0005 if straight > 0.0 else 0.00035
    ratio = np.maximum(2.0 * np.abs(place) - straight, 0.0) / (length - straight)
    return np.asarray(-factor * diameter * np.log1p(-(ratio**2)))


def _crowned_drop(place: FloatArray, crown: float, length: float) -> FloatArray:
    """Return how far a circular crowning lies below its middle at `place`, m; `crown` (m) at the ends."""
    return np.asarray(crown * (2.0 * place / length) ** 2)


# Cylindrical and tapered roller bearings by their internal geometry, in laminae.


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


@described
@dataclass(frozen=True)
class RollerBearing(Row):
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
    def element_stiffness(self) -> float:
        """Return c of load = c approach^(10/9) of a straight roller between both raceways, N/m^(10/9)."""
        return self.laminae * lamina_stiffness(self.length, self.laminae)

    def drop(self, place: FloatArray) -> FloatArray:
        """Return how far the profile lies below the middle at `place` along the roller, m; one contact."""
        if self.profile == LOGARITHMIC:
            return _logarithmic_drop(place, self.diameter, self.length, self.contact_angle != 0.0)
        return _crowned_drop(place, self.crown if self.profile == CROWNED else 0.0, self.length)

    def peak_pressure(self, load: float) -> float:
        """Return the Hertz pressure of a lamina under `load` (N) on the inner ring, the smaller one, Pa.

        Steel on steel: p_0 = sqrt(q E*/(pi R)), q load over length, R = D (1 - gamma)/2.
        """
        modulus = STEEL_YOUNGS_MODULUS / (2.0 * (1.0 - STEEL_POISSON_RATIO**2))
        radius = self.diameter * (1.0 - self.slenderness) / 2.0
        return math.sqrt(load * self.laminae / self.length * modulus / (math.pi * radius))


BOTH, POSITIVE, NEGATIVE, NONE = "both", "positive", "negative", "none"
LOCATING = Declared(
    Kind.CHOICE,
    "",
    Choice((BOTH, POSITIVE, NEGATIVE, NONE)),
    "Directions along z in which its rings are held in their seats. positive, negative: only against a shaft "
    "that is pushed along z, against z, as in a cross-located pair; none: a non-locating (floating) bearing, "
    "one ring of which slides",
    BOTH,
    later=True,
)
ALONG, AGAINST = 1, 2
HELD = {BOTH: ALONG | AGAINST, POSITIVE: ALONG, NEGATIVE: AGAINST, NONE: 0}
"""The directions as bits."""


def check_locating(row: BallBearing | RollerBearing, locating: str) -> None:
    """Refuse a row with a contact angle of which a ring slides: it would carry nothing at all.

    Raises
    ------
    InputError
        `locating` is none of the choices, or the row has a contact angle and not both directions are held.
    """
    one_of("locating", locating, list(HELD))
    if locating != BOTH and row.contact_angle != 0.0:
        bound = f'"{BOTH}" with a contact angle, whose sign is the direction in which the row holds'
        raise InputError("locating", locating, bound, "State the contact angle's sign instead.")
