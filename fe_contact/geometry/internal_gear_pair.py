"""A pinion inside a ring gear, on parallel axes (ISO 21771-1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.geometry.internal_pair_feasibility import (
    refuse_infeasible_internal_pair,
    refuse_tooth_numbers,
    refuse_trimming_interference,
)
from fe_contact.geometry.pair_feasibility import refuse_strangers
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.ring_gear import RingGear
from fe_contact.geometry.trimming import radial_clearance


@dataclass(frozen=True)
class InternalGearPair(ParallelAxes):
    """The external gear (`pinion`, gear 1) drives the ring gear (`wheel`, gear 2); see `ParallelAxes`.

    When the ring drives, the same contacts follow in the opposite order: deflections and forces at a position
    are the same, and the position falls with time. Both have equal normal module, pressure angle and helix
    angle, so the hand is the same. The center distance is positive (the standard's -a); backlash falls as it
    grows. With `radial_assembly` the pinion is mounted radially, which "trimming interference" may prevent;
    otherwise it is mounted along the axis.

    Raises
    ------
    InputError
        A center distance that is no positive number.
    InfeasibleGeometry
        No such pair: "normal module", "pressure angle", "helix angle", "tooth number difference", "face
        overlap", "center distance", "profile shift sum", "contact ratio", "tip clearance", "interference",
        "tip interference", "trochoidal interference", "trimming interference".
    """

    wheel: RingGear
    radial_assembly: bool = False

    def __post_init__(self) -> None:
        refuse_strangers(self.pinion, self.wheel)
        refuse_tooth_numbers(self.pinion, self.wheel)
        if self.center_distance is None:
            object.__setattr__(self, "center_distance", reference_center_distance(self.pinion, self.wheel))
        refuse_infeasible_internal_pair(self)
        if self.radial_assembly:
            refuse_trimming_interference(self.radial_assembly_clearance)

    @property
    def tooth_number_difference(self) -> int:
        """Teeth of the ring less teeth of the pinion."""
        return self.wheel.teeth - self.pinion.teeth

    @property
    def radial_assembly_clearance(self) -> float:
        """Play in m on the pinion's base circle when it is put in radially, in the middle of its backlash.

        Negative: it must be put in along the axis. Infinite if the tips do not hold it.
        """
        gears = (self.pinion, self.wheel)
        first, second = (math.acos(min(1.0, gear.base_radius / gear.tip_radius)) for gear in gears)
        turn = radial_clearance(1.0 / self.speed_ratio, (first, second), self.working_pressure_angle)
        return self.pinion.base_radius * turn + 0.5 * self.transverse_base_backlash
