"""Profile shifts with which pinion and wheel have the same largest specific sliding."""

from __future__ import annotations

import math

from fe_contact.geometry.backlash import tight_shift_sum, working_pressure_angle
from fe_contact.geometry.gear import Gear

_MIN, _MAX = -1.0, 1.5

_HALVINGS = 60


def balanced_shifts(pinion: Gear, wheel: Gear, center_distance: float) -> tuple[float, float]:
    """Return x_1 and x_2 that fill a center distance in m without backlash and balance the specific sliding.

    The specific sliding is then equal in magnitude at both ends of the path of contact, where either root
    meets the mating tip. x_1 is sought from -1 to 1.5; tips are those of the basic rack. Shifts and
    allowances of the gears do not count.
    """
    pressure = working_pressure_angle(pinion, wheel, center_distance)
    total = tight_shift_sum(pinion, wheel, pressure)
    tangent = center_distance * math.sin(pressure)
    ratio = wheel.teeth / pinion.teeth
    low, high = _MIN, _MAX
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        first, second = _tip_roll(pinion, middle), _tip_roll(wheel, total - middle)
        at_start, at_end = tangent - second, tangent - first  # roll lengths of either root
        # specific sliding: 1 - second/(ratio at_start) at the pinion's root, 1 - ratio first/at_end at the
        # wheel's; at_start grows with x_1, at_end falls: the balance is crossed once
        if at_start <= 0.0 or (at_end > 0.0 and second * at_end > ratio**2 * first * at_start):
            low = middle
        else:
            high = middle
    return low, total - low


def _tip_roll(gear: Gear, shift: float) -> float:
    radius = gear.reference_radius + gear.normal_module * (gear.addendum_coefficient + shift)
    return math.sqrt(max(radius**2 - gear.base_radius**2, 0.0))
