"""Basic reference rating life of rolling bearings under load cases, and over all of them.

References
----------
.. [1] ISO/TS 16281:2008, Rolling bearings - Methods for calculating the modified reference rating life for
   universally loaded bearings.
.. [2] A. Palmgren, Die Lebensdauer von Kugellagern, VDI-Zeitschrift 68 (1924), 339-341: linear damage.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.joints import RollingBearing
from dynamics.rolling_bearings import rating_life
from dynamics.rolling_bearings.row_law import row_law
from dynamics.types import FloatArray


def life_of(bearing: RollingBearing, displacement: FloatArray) -> float:
    """Return L_10r of a row in revolutions; NaN without a capacity, infinite where no element is loaded.

    The inner ring turns against a load that stands still. Loads of the elements are averaged over their
    passing.

    Parameters
    ----------
    bearing : RollingBearing
    displacement : (5,) array
        Of the inner ring against the outer, x, y, z, tilt_x, tilt_y, m and rad, without what makes the axial
        preload.
    """
    if bearing.dynamic_capacity is None:
        return math.nan
    law = row_law(bearing)
    moved = np.array(displacement, dtype=float)
    moved[2] += law.shift
    return rating_life(bearing.row, law.loaded.evaluate(moved).load, bearing.dynamic_capacity).revolutions


def life_duration(revolutions: Sequence[float], speed: Sequence[float], share: Sequence[float]) -> float:
    """Return the life under C load cases by linear damage, s: 1 / sum (q n / L) [2]_.

    Parameters
    ----------
    revolutions : (C,) sequence
        Life L under each case alone; may be infinite, NaN if not known.
    speed : (C,) sequence
        rad/s, >= 0.
    share : (C,) sequence
        Shares q of the duration, in any unit, not all 0.
    """
    part = np.asarray(share, dtype=float) / float(np.sum(share))
    turned = part * np.asarray(speed, dtype=float) / (2.0 * math.pi)  # revolutions per s
    damage = float(np.sum(turned / np.asarray(revolutions, dtype=float)))
    return math.inf if damage == 0.0 else 1.0 / damage
