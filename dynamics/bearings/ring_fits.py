"""Rings of a rolling bearing at temperature: how fits, shaft and housing change the play of its row.

References
----------
.. [1] S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed. 1970, section 28: thick cylinders.
.. [2] T. A. Harris, M. N. Kotzalas, Essential Concepts of Bearing Technology, 5th ed. 2006, chapter 3: play
   by interference and temperature.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from bounds import Declared, Kind, above, below, between, declared, described, required
from dynamics.checks import declared_fields
from dynamics.errors import InputError

BORE = Declared(Kind.LENGTH, "m", between(1e-4, 10.0), "Bore of the inner ring", 0.025)
OUTSIDE = Declared(Kind.LENGTH, "m", between(1e-4, 20.0), "Outside diameter of the outer ring", 0.062)
_INTERFERENCE = Declared(Kind.DEVIATION, "m", between(-1e-3, 1e-3), "", 1e-5)
_ON_SHAFT = replace(_INTERFERENCE, description="Interference of the inner ring on the shaft; negative: loose")
_IN_HOUSING = replace(
    _INTERFERENCE, description="Interference of the outer ring in its bore; negative: loose", example=-1e-5
)
_WALL = Declared(Kind.LENGTH, "m", between(1e-4, 100.0), "Outer diameter of the wall around the bore", 0.1)


@described
@dataclass(frozen=True)
class RingFits:
    """Fits of the rings on shaft and in housing as drawn, at the reference temperature."""

    bore: float = required(BORE)
    outside_diameter: float = required(OUTSIDE)
    housing_diameter: float = required(_WALL)
    shaft_interference: float = declared(0.0, _ON_SHAFT)
    housing_interference: float = declared(0.0, _IN_HOUSING)

    def __post_init__(self) -> None:
        declared_fields(self)
        if self.housing_diameter <= self.outside_diameter:
            bound = above(self.outside_diameter, "m", "the outside diameter of the bearing")
            raise InputError("housing_diameter", self.housing_diameter, bound)

    def check_around(self, raceways: tuple[float, float]) -> None:
        """Refuse rings that do not hold the raceways of a row (m); raises `InputError`."""
        inner, outer = raceways
        if self.bore >= inner:
            raise InputError("bore", self.bore, below(inner, "m", "the inner raceway"))
        if self.outside_diameter <= outer:
            raise InputError(
                "outside_diameter", self.outside_diameter, above(outer, "m", "the outer raceway")
            )
