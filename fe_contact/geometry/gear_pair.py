"""A pair of external gears on parallel axes (ISO 21771-1)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.geometry.gear import Gear
from fe_contact.geometry.pair_feasibility import refuse_infeasible_pair, refuse_strangers
from fe_contact.geometry.parallel_axes import ParallelAxes


@dataclass(frozen=True)
class GearPair(ParallelAxes):
    """Gear 1 (`pinion`) drives gear 2 (`wheel`).

    Both gears are external; `InternalGearPair` has a ring gear. `ParallelAxes` lists the properties of a
    pair. Both have equal normal module and pressure angle, and opposite helix angles.

    Raises
    ------
    InputError
        A center distance that is no positive number.
    InfeasibleGeometry
        No such pair: "normal module", "pressure angle", "helix angle", "profile shift sum", "contact ratio",
        "interference", "tip clearance".
    """

    wheel: Gear

    def __post_init__(self) -> None:
        refuse_strangers(self.pinion, self.wheel)
        if self.center_distance is None:
            object.__setattr__(self, "center_distance", reference_center_distance(self.pinion, self.wheel))
        refuse_infeasible_pair(self)

    def swapped(self) -> GearPair:
        """Return the same pair with the wheel driving: the same flanks loaded, the gears turning back."""
        return replace(
            self,
            pinion=_turning_back(self.wheel),
            wheel=_turning_back(self.pinion),
            axial_offset=-self.axial_offset,
            shafts=self.shafts[::-1],
        )


def _turning_back(gear: Gear) -> Gear:
    """Return the gear with its teeth in the order in which they mesh the other way round."""
    if gear.pitch_deviation.neutral:
        return gear
    return replace(gear, pitch_deviation=gear.pitch_deviation.reversed)
