"""Energy stored in a system at one instant."""

from __future__ import annotations

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.by_address import by_address
from dynamics.forces.compiled import compiled
from dynamics.forces.element_laws import FLANK, SPATIAL_FLANK, Elements, potential
from dynamics.forces.local_state import LocalState
from dynamics.motion.observation import local_state, observe_laws
from dynamics.types import FloatArray, IntArray


def stored_energy(
    system: SystemArrays, time: float, q: FloatArray, v: FloatArray, moved: IntArray
) -> FloatArray:
    """Return kinetic, bushing and mesh energy, J, (3,).

    Bodies move with the laws' speeds W_k times their kinematic vectors r_k, and their rate in `v` on top:
    T = v M v/2 + sum_k W_k r_k M v + sum_kl W_k W_l r_k M r_l/2.
    """
    at = np.array([time])
    speed = observe_laws(system, at)[2, :, 0]
    kinetic = (
        0.5 * v @ system.mass @ v - speed @ system.inertial @ v + 0.5 * speed @ system.total_inertia @ speed
    )
    mesh, bearing = _in_elements(
        by_address(system.elements), by_address(local_state(system, time, q, v, moved))
    )
    linear = 0.5 * q @ system.stiffness @ q - system.constant @ q
    return np.array([kinetic, linear + bearing, mesh])


@compiled
def _in_elements(elements: Elements, local: LocalState) -> tuple[float, float]:
    """Energies that flanks and that bearings store."""
    mesh, bearing = 0.0, 0.0
    for e in range(elements.law.size):
        if elements.law[e] == FLANK or elements.law[e] == SPATIAL_FLANK:
            mesh += potential(elements, local, e)[0]
        else:
            bearing += potential(elements, local, e)[0]
    return mesh, bearing
