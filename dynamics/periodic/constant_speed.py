"""A system at one constant speed under constant loads: what has a period."""

from __future__ import annotations

import numpy as np

from bounds import above, below
from dynamics.arrays.arrays import LawArrays, SystemArrays
from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.forces.by_address import by_address
from dynamics.linearize.common_period import CommonPeriod
from dynamics.types import FloatArray


def at_constant_speed(system: System, period: CommonPeriod, speed: float, time: float) -> SystemArrays:
    """Return the arrays with the drives at `speed` (rad/s, of the leading law) for ever.

    Loads by time keep the values that they have at `time`.

    Raises
    ------
    InputError
        If the speed is 0 or of the other sense, in which other flanks carry.
    """
    extreme = system.scene.drives[period.law].speed.extreme
    if not np.isfinite(speed) or speed * extreme <= 0.0:
        bound = (above if extreme > 0.0 else below)(0.0, note=", the sense in which the scene turns")
        raise InputError("speed", speed, bound, "Reverse the scene's drive for the other flanks.")
    speeds = _constant(speed * period.proportion)
    none = np.zeros(period.proportion.size)
    torque = np.array([float(load.torque(time)) for load in system.scene.loads])
    arrays = system.arrays
    laws = arrays.elements.laws
    laws = laws._replace(applied_force=laws.applied_force.held_at(time))
    changed = arrays._replace(
        reference=arrays.reference._replace(speed=speeds, whole=none, fraction=none),
        load=arrays.load._replace(torque=_constant(torque)),
        elements=arrays.elements._replace(laws=laws),
    )
    return by_address(changed)


def _constant(values: FloatArray) -> LawArrays:
    """Lay out laws that never change."""
    coefficient = np.zeros((values.size, 4))
    coefficient[:, 0] = values
    return LawArrays(np.arange(values.size + 1), np.zeros(values.size), coefficient)
