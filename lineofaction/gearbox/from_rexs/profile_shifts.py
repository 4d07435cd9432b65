"""Profile shifts that a file leaves out, from center distance and mates (ISO 21771-1, clause 5.5)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fe_contact.involute import involute_function
from lineofaction.gearbox.from_rexs.gear_unit import Part
from lineofaction.gearbox.from_rexs.meshing import Meshing
from lineofaction.gearbox.from_rexs.toothing import SHIFT, ToothingData
from lineofaction.gearbox.units import MM, as_typed

_ROUNDING = 1e-9
"""A derived coefficient smaller than this is the rounding of the file's numbers, and 0."""


@dataclass(frozen=True)
class ToothedPair:
    """Two gears of a stage as the file states them; the second may be a ring gear."""

    meshing: Meshing
    pinion: ToothingData
    wheel: ToothingData
    center_distance: float
    """Center distance, m."""
    axial_offset: float
    """Offset of the wheel's mid-face from the pinion's towards +z, m."""
    torques: tuple[float, ...]
    """Torques on the driving gear, N m, all of one sign."""

    @property
    def stage(self) -> Part:
        """The stage."""
        return self.meshing.stage

    @property
    def gears(self) -> tuple[ToothingData, ToothingData]:
        """Pinion and wheel."""
        return self.pinion, self.wheel

    @property
    def working_pressure_angle(self) -> float:
        """Transverse working pressure angle alpha_wt, rad."""
        pinion, wheel = self.pinion, self.wheel
        reference = abs(0.5 * (pinion.reference_diameter + wheel.sign * wheel.reference_diameter))
        cosine = reference * math.cos(pinion.transverse_pressure_angle) / self.center_distance
        if not 0.0 < cosine < 1.0:
            minimum = 1e3 * reference * math.cos(pinion.transverse_pressure_angle)
            value, bound = as_typed(self.center_distance, MM), f"above {minimum:.7g} mm"
            raise self.stage.refusal("center_distance", value, bound)
        return math.acos(cosine)

    @property
    def shift_sum(self) -> float:
        """Sum x_1 + x_2 of the profile shift coefficients of a pair that meshes without backlash."""
        pinion, wheel = self.pinion, self.wheel
        involutes = involute_function(self.working_pressure_angle)
        involutes -= involute_function(pinion.transverse_pressure_angle)
        teeth = pinion.teeth + wheel.sign * wheel.teeth
        return involutes * teeth / (2.0 * math.tan(pinion.pressure_angle))


def derived_shifts(pairs: Sequence[ToothedPair]) -> dict[int, float]:
    """Return the profile shift coefficients by the id of the gear.

    A coefficient that the file leaves out is derived from that of a mate, which may itself be derived. A gear
    without a mate that has one is left out. Every pair's working pressure angle must exist.
    """
    gears = [gear for pair in pairs for gear in pair.gears]
    shifts = {
        gear.part.id: gear.profile_shift_coefficient
        for gear in gears
        if gear.profile_shift_coefficient is not None
    }
    while True:
        count = len(shifts)
        for pair in pairs:
            _derive(pair, shifts)
        if len(shifts) == count:
            return shifts


def _derive(pair: ToothedPair, shifts: dict[int, float]) -> None:
    """Add the shift of the gear of a pair that has none, if its mate has one."""
    for gear, mate in (pair.gears, pair.gears[::-1]):
        if gear.part.id not in shifts and mate.part.id in shifts:
            shift = pair.shift_sum - shifts[mate.part.id]
            shifts[gear.part.id] = 0.0 if abs(shift) < _ROUNDING else shift
            total = "x_1 + x_2 = (z_1 + z_2) (inv alpha_wt - inv alpha_t) / (2 tan alpha_n)"
            gear.part.say(
                SHIFT, "derived", f"x = {shifts[gear.part.id]:.6g} from {total} with {mate.part.name}"
            )
