"""Profile shifts that a file leaves out, from the center distance and the mates (ISO 21771-1, clause 5.5)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fe_contact.flank.involute import involute_function
from lineofaction.gearbox.from_rexs.part import Part
from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM, as_typed

_ITEM = "addendum_modification_coefficient"


@dataclass(frozen=True)
class ToothedPair:
    """Two gears of a stage at a center distance in m; the second may be a ring gear."""

    stage: Part
    pinion: ToothingData
    wheel: ToothingData
    center_distance: float

    @property
    def working_pressure_angle(self) -> float:
        """Transverse working pressure angle alpha_wt, rad.

        Raises
        ------
        BadInput
            The base circles overlap, or one encloses the other, at this distance.
        """
        pinion, wheel = self.pinion, self.wheel
        reference = abs(0.5 * (pinion.reference_diameter + wheel.sign * wheel.reference_diameter))
        cosine = reference * math.cos(pinion.transverse_pressure_angle) / self.center_distance
        if not 0.0 < cosine < 1.0:
            least = 1e3 * reference * math.cos(pinion.transverse_pressure_angle)
            field = f"{self.stage.place}, center_distance"
            raise BadInput.of(field, as_typed(self.center_distance, MM), f"above {least:.7g} mm")
        return math.acos(cosine)

    @property
    def shift_sum(self) -> float:
        """x_1 + x_2 without backlash."""
        pinion, wheel = self.pinion, self.wheel
        involutes = involute_function(self.working_pressure_angle)
        involutes -= involute_function(pinion.transverse_pressure_angle)
        teeth = pinion.teeth + wheel.sign * wheel.teeth
        return involutes * teeth / (2.0 * math.tan(pinion.pressure_angle))


def derived_shifts(pairs: Sequence[ToothedPair]) -> dict[int, float]:
    """Return the profile shift coefficients by gear, missing ones derived mate by mate.

    A gear whose mates have none either stays without. Every pair's working pressure angle must exist.
    """
    gears = [gear for pair in pairs for gear in (pair.pinion, pair.wheel)]
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
    for gear, mate in ((pair.pinion, pair.wheel), (pair.wheel, pair.pinion)):
        if gear.part.id not in shifts and mate.part.id in shifts:
            shift = pair.shift_sum - shifts[mate.part.id]
            shifts[gear.part.id] = 0.0 if abs(shift) < 1e-9 else shift
            total = "x_1 + x_2 = (z_1 + z_2) (inv alpha_wt - inv alpha_t) / (2 tan alpha_n)"
            gear.part.say(
                _ITEM, "derived", f"x = {shifts[gear.part.id]:.6g} from {total} with {mate.part.name}"
            )
