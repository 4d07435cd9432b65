"""Times at which all meshes of a system stand evenly spread over their cycles."""

from __future__ import annotations

import math

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.linearize.common_period import common_period
from dynamics.types import FloatArray


def cycle_times(system: System, positions: int) -> FloatArray:
    """Return the times (K,), s, at which every mesh takes K evenly spaced positions of its cycle, each once.

    K evenly spaced moments of the common period of all meshes are a lattice: a mesh of C base pitches in that
    period stands at k C / K, all different modulo 1 if C and K share no divisor. K is the least number of at
    least `positions` for which that is so of all meshes, so that their phases towards each other vary too.
    """
    period = common_period(system)
    cycles = [abs(pitches) for pitches in period.pitches if pitches]
    count = positions
    while any(math.gcd(cycle, count) > 1 for cycle in cycles):
        count += 1
    drive = system.scene.drives[period.law]
    return np.arange(count) / count * period.duration(drive.speed.extreme)
