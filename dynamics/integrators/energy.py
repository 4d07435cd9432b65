"""Energy stored in a system at one instant."""

from __future__ import annotations

import numpy as np

from dynamics.forces.table_energy import table_energy
from dynamics.system.arrays import SystemArrays
from dynamics.system.observation import observe_drive, observe_flanks
from dynamics.types import FloatArray


def stored_energy(system: SystemArrays, time: float, q: FloatArray, v: FloatArray) -> FloatArray:
    """Return kinetic, bushing and mesh energy, J, (3,).

    Rotations turn with the drive's speed times their ratio, and their rate in `v` on top:
    T = v M v/2 + W sum(I ratio v_rotation) + W^2 sum(I ratio^2)/2 with W the speed of the drive.
    """
    at = np.array([time])
    motion = np.empty((4, 1))
    observe_drive(system, at, motion)
    speed = motion[2, 0]
    kinetic = 0.5 * v @ system.mass @ v - speed * system.inertial @ v + 0.5 * speed**2 * system.total_inertia
    flank = np.empty((3, system.drive_direction.size, 1))
    observe_flanks(system, at, q[None, :], v[None, :], flank)
    table = system.flank.table
    mesh = sum(table_energy(table, f, flank[0, f, 0], flank[1, f, 0], 0)[0] for f in range(flank.shape[1]))
    return np.array([kinetic, 0.5 * q @ system.stiffness @ q, mesh])
