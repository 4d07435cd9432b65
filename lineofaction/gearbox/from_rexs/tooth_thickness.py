"""Tooth thickness allowance of a gear, from the deviations of its span (ISO 21771-1, DIN 3967)."""

from __future__ import annotations

import math

from lineofaction.gearbox.from_rexs.toothing import ToothingData
from lineofaction.gearbox.units import UM

_UPPER, _LOWER = (f"{side}_backlash_allowance_referenced_to_span" for side in ("upper", "lower"))

_SERIES = "tooth_thickness_deviation_tolerance_series_din_3967_1978"


def thickness_allowance(gear: ToothingData) -> float:
    """Return the normal tooth thickness removed at the reference circle in m: the mean of its limits.

    The span changes by the thickness times cos(alpha_n). A tolerance series (DIN 3967) without deviations is
    ignored, and so are deviations that thicken the teeth on average: the account says so.
    """
    part = gear.part
    if part.attribute(_SERIES) is not None:
        part.say(_SERIES, "ignored", "no backlash but that of the center distance, without deviations in µm")
    upper = part.number(_UPPER, "thickness_allowance_um")
    lower = part.number(_LOWER, "thickness_allowance_um")
    if upper is None or lower is None:
        return 0.0
    allowance = -0.5 * (upper + lower) / math.cos(gear.pressure_angle)
    if allowance < 0.0:
        for item in (_UPPER, _LOWER):
            part.say(item, "refused", "the mean deviation thickens the teeth: no allowance")
        return 0.0
    text = f"thickness_allowance_um {allowance / UM:.6g} = -(A_u + A_l) / (2 cos alpha_n)"
    for item in (_UPPER, _LOWER):
        part.say(item, "derived", text)
    return allowance
