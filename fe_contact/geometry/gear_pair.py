"""Pairs of gears on parallel axes: external, and a pinion in a ring gear."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from bounds.brief import concise
from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.pair_feasibility import refuse_infeasible_pair, refuse_strangers
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.ring_gear import RingGear
from fe_contact.geometry.ring_pair_feasibility import refuse_trimming_interference
from fe_contact.geometry.trimming import radial_clearance


@concise
@dataclass(frozen=True)
class GearPair(ParallelAxes):
    """Gear 1 (`pinion`) drives gear 2 (`wheel`).

    Both gears are external; `InternalGearPair` has a ring gear. `ParallelAxes` lists the properties of a
    pair. Both have equal normal module and pressure angle, and opposite helix angles. Raises `InputError`: a
    center distance that is no positive number; `InfeasibleGeometry`: no such pair: "normal module", "pressure
    angle", "helix angle", "profile shift sum", "contact ratio", "interference", "tip clearance".
    """

    wheel: Gear

    def __post_init__(self) -> None:
        refuse_strangers(self.pinion, self.wheel)
        if self.center_distance is None:
            object.__setattr__(self, "center_distance", reference_center_distance(self.pinion, self.wheel))
        refuse_infeasible_pair(self)

    def swapped(self) -> GearPair:
        """Return the pair with the wheel driving: the same flanks loaded, the gears turning back."""
        return replace(
            self,
            pinion=self.wheel.turning_back,
            wheel=self.pinion.turning_back,
            axial_offset=-self.axial_offset,
            shafts=self.shafts[::-1],
        )


@concise
@dataclass(frozen=True)
class InternalGearPair(ParallelAxes):
    """The external gear (`pinion`, gear 1) drives the ring gear (`wheel`, gear 2); see `ParallelAxes`.

    When the ring drives, the same contacts follow in the opposite order: deflections and forces at a position
    are the same, and the position falls with time. Both have equal normal module, pressure angle and helix
    angle, so the hand is the same. The center distance is positive (the standard's -a); backlash falls as it
    grows. With `radial_assembly` the pinion is mounted radially, which "trimming interference" may prevent;
    otherwise it is mounted along the axis. Raises `InputError`: a center distance that is no positive number;
    `InfeasibleGeometry`: no such pair: "normal module", "pressure angle", "helix angle", "tooth number
    difference", "face overlap", "center distance", "profile shift sum", "contact ratio", "tip clearance",
    "interference", "tip interference", "trochoidal interference", "trimming interference".
    """

    wheel: RingGear
    radial_assembly: bool = False

    def __post_init__(self) -> None:
        refuse_strangers(self.pinion, self.wheel)
        if self.center_distance is None:
            object.__setattr__(self, "center_distance", reference_center_distance(self.pinion, self.wheel))
        refuse_infeasible_pair(self)
        if self.radial_assembly:
            refuse_trimming_interference(self.radial_assembly_clearance)

    @property
    def radial_assembly_clearance(self) -> float:
        """Play in m on the pinion's base circle when it is put in radially, in the middle of its backlash.

        Negative: it must be put in along the axis. Infinite if the tips do not hold it.
        """
        gears = (self.pinion, self.wheel)
        first, second = (math.acos(min(1.0, gear.base_radius / gear.tip_radius)) for gear in gears)
        turn = radial_clearance(1.0 / self.speed_ratio, (first, second), self.working_pressure_angle)
        return self.pinion.base_radius * turn + 0.5 * self.transverse_base_backlash
