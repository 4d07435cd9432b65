"""What rows of balls and of rollers have in common."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bounds import Declared, Kind, above, between, declared, described, integers, required
from dynamics.checks import declared_fields
from dynamics.errors import InputError

# A line of a bearing catalog.


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
    written="um",
)


class Row:
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
    def cage_ratio(self) -> float:
        """Return the speed of the cage over that of the inner ring, the outer at rest and nothing slips."""
        return (1.0 - self.slenderness) / 2.0

    def check_row(self) -> None:
        """Refuse what is no row.

        Raises
        ------
        InputError
            A field out of its bounds, or more elements than their circle holds.
        """
        declared_fields(self)
        least = self.diameter / math.sin(math.pi / self.count)
        if self.pitch_diameter <= least:
            bound = above(least, "m", "where the elements touch each other")
            suggestion = "Check number and diameter of the elements."
            raise InputError("pitch_diameter", self.pitch_diameter, bound, suggestion)


BORE = Declared(Kind.LENGTH, "m", between(1e-4, 10.0), "Bore of the inner ring", 0.025)
OUTSIDE = Declared(Kind.LENGTH, "m", between(1e-4, 20.0), "Outside diameter of the outer ring", 0.062)
RATING = Declared(Kind.FORCE, "N", between(1.0, 1e9), "Basic static load rating C_0", 11600.0)


@described
@dataclass(frozen=True)
class CatalogLine:
    """What a catalog says of a deep groove ball bearing, and its clearance, which it does not."""

    bore: float = required(BORE)
    outside_diameter: float = required(OUTSIDE)
    static_rating: float = required(RATING)
    clearance: float = declared(0.0, CLEARANCE)

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.outside_diameter <= self.bore:
            raise InputError("outside_diameter", self.outside_diameter, above(self.bore, "m", "the bore"))
