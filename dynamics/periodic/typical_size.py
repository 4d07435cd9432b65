"""The typical sizes of forces and motions, by which a search for periodic motions measures its steps."""

from __future__ import annotations

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.linearize import Modes
from dynamics.types import FloatArray

MOST_GAIN = 100.0


def largest_force(system: System, mesh_force: FloatArray) -> float:
    """Return the largest force of meshes and loads at the largest speed, N."""
    laws, extreme = system.arrays.elements.laws, [part.speed.extreme for part in system.scene.references]
    speed = float(np.max(np.abs(system.kinematics.float_ratio @ np.array(extreme))))
    turning = laws.applied_force.size, laws.unbalance.amount * speed**2
    forces = (mesh_force, system.flanks.nominal_force, *turning)
    return max(float(np.max(np.abs(force), initial=0.0)) for force in forces)


def stiffest(system: System) -> float:
    """Return the stiffness of the stiffest mesh; without one that of the stiffest freedom, N/m."""
    arrays, meshes = system.arrays, system.flanks.mean_stiffness
    if meshes.size:
        return float(np.max(meshes))
    return float(np.max(np.diag(arrays.stiffness) / arrays.scale**2)) or 1.0


def resonant_gain(system: System, modes: Modes) -> float:
    """Return by how much loads move a system without meshes more at a resonance than at rest; with them 1."""
    held = modes.damping_ratio[modes.frequency > 0.0]
    if system.scene.meshes or not held.size:
        return 1.0
    return min(MOST_GAIN, 0.5 / max(float(np.min(held)), 0.5 / MOST_GAIN))
