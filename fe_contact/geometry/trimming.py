"""Trimming interference: whether a pinion or a cutter can be moved radially into a ring gear.

On the way out along the line of centers every tooth tip of the pinion must pass the ring's tip beside it. The
clearance of the two edges across the line of centers is least where both move across at the same speed; the
condition is JGMA's, in closed form, as e.g. in the gear handbooks of KHK and SDP/SI (eq. 5-9).
"""

from __future__ import annotations

import math

from fe_contact.involute import involute_function


def radial_clearance(
    ratio: float, pressure_angles: tuple[float, float], working_pressure_angle: float
) -> float:
    """Angle in rad the pinion may turn towards the ring's flank before the tips touch on the way in.

    Parameters
    ----------
    ratio : float
        z_1 / z_2 < 1.
    pressure_angles : tuple of float
        Transverse pressure angles at the tip of the pinion and at the tip of the ring, rad.
    working_pressure_angle : float
        Transverse, rad.

    Returns
    -------
    float
        From flanks in contact; < 0 is trimming interference, -inf a pinion larger than the ring's bore, inf a
        ring whose tips do not reach over the pinion's.
    """
    first, second = pressure_angles
    cosines = math.cos(second) / math.cos(first)
    if cosines <= 1.0:
        return math.inf
    if ratio * cosines >= 1.0:
        return -math.inf
    pinion_edge = math.asin(math.sqrt((1.0 - cosines**-2) / (1.0 - ratio**2)))
    ring_edge = math.asin(math.sqrt((cosines**2 - 1.0) / (ratio**-2 - 1.0)))
    working = involute_function(working_pressure_angle)
    pinion_turn = pinion_edge + involute_function(first) - working
    return pinion_turn - (ring_edge + involute_function(second) - working) / ratio
