"""A system whose clock starts in the middle of a run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.kernels.by_address import by_address
from dynamics.motion.motion import QUANTA_PER_TURN
from dynamics.types import IntArray


def starting_at(system: System, time: float, moved: IntArray) -> System:
    """Return `system` as it is from `time` (s) on, with that time as 0.

    `moved` (k,) counts the quanta of free trains that are in the reference by then.
    """
    arrays, reference = system.arrays, system.arrays.reference
    pieces = np.diff(reference.speed.first)
    turned = np.repeat(moved, pieces)
    fraction = reference.fraction + (turned % QUANTA_PER_TURN) / QUANTA_PER_TURN
    moved_on = reference._replace(
        speed=reference.speed._replace(start=reference.speed.start - time),
        whole=reference.whole + turned // QUANTA_PER_TURN,
        fraction=fraction,
    )
    torque = arrays.load.torque
    load = arrays.load._replace(torque=torque._replace(start=torque.start - time))
    laws = arrays.elements.laws
    elements = arrays.elements._replace(
        laws=laws._replace(applied_force=laws.applied_force.starting_at(time))
    )
    return replace(
        system, arrays=by_address(arrays._replace(reference=moved_on, load=load, elements=elements))
    )
