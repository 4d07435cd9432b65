"""A line of a bearing catalog."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, above, between, declared, described, required
from dynamics.bearings.row import CLEARANCE
from dynamics.checks import declared_fields
from dynamics.errors import InputError

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
