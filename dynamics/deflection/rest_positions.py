"""Rest positions of a system over the mesh cycle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.forces.laws import Law
from dynamics.integrators import static_equilibrium
from dynamics.mechanism.flank_gradients import common_face_width, middle_from_driver
from dynamics.motion.observation import observe
from dynamics.types import FloatArray, StaticStatus


@dataclass(frozen=True)
class Rest:
    """K rest positions of a system of N freedoms of all rotors, m meshes and b bearings."""

    status: StaticStatus
    """The worst of all positions."""
    residual: float
    """Largest unbalanced force of all positions over the largest mesh force."""
    motion: FloatArray
    """Six freedoms of every rotor, then elastic coordinates, m and rad. Shape (K, N)."""
    element: FloatArray
    """Local coordinates of all force elements, m. Shape (K, R)."""
    mesh_force: FloatArray
    """Transverse mesh force, N. Shape (K, m)."""
    load_arm: FloatArray
    """Axial distance of the mesh force from mid-face of the driving gear, m, as in a table; NaN where the
    force acts at mid-face. Shape (K, m).
    """
    bearing_force: FloatArray
    """Force and moment on the part that holds each bearing, N and N m. Shape (K, b, 5)."""


def rest_over(system: System, times: FloatArray) -> Rest:
    """Return where the bodies of `system` rest at `times` (K,)."""
    solutions = [static_equilibrium(system, float(time)) for time in times]
    q = np.array([solution.displacement for solution in solutions])
    v = np.zeros_like(q)
    observed = observe(system.arrays, times, q, v)
    on_bearings = system.bearing_force(observed.force, q, v)
    force = np.zeros((times.size, len(system.supports.name), 5))
    rows = min(on_bearings.shape[1], 5)  # 3 without moments; the sixth, about the axis, is left out
    force[:, :, :rows] = np.moveaxis(on_bearings, 2, 0)[:, :, :rows]
    mesh_force = observed.force[system.driving_rows].T
    largest = float(np.max(np.abs(mesh_force), initial=0.0))
    residual = float(np.max([solution.residual for solution in solutions]))
    return Rest(
        status=max(solution.status for solution in solutions),
        residual=residual / largest if largest > 0.0 else float("inf"),
        motion=q @ system.freedoms.motion.T,
        element=observed.coordinate.T,
        mesh_force=mesh_force,
        load_arm=_load_arms(system, observed.force).T,
        bearing_force=force,
    )


def _load_arms(system: System, force: FloatArray) -> FloatArray:
    """Return the arms (m, K) of the driving flanks by the forces (R, K) of all rows, m; NaN: no arm.

    The force on the row of the misalignment is the moment of the mesh force about mid-face over the face
    width, with a minus sign.
    """
    elements, scene = system.arrays.elements, system.scene
    arm = np.full((len(scene.meshes), force.shape[1]), np.nan)
    for mesh in range(len(scene.meshes)):
        row, laws = elements.first[mesh], elements.laws.spatial_flank
        if elements.law[mesh] != Law.SPATIAL_FLANK or laws.per_face[elements.entry[mesh]] == 0.0:
            continue
        tilting = force[row + laws.row[elements.entry[mesh], 0]]
        line, sense = system.lines[mesh], system.kinematics.mesh_sense[mesh]
        middle = middle_from_driver(scene, mesh, line, sense)
        loaded = np.where(force[row] != 0.0, force[row], np.nan)
        arm[mesh] = middle - common_face_width(scene, mesh) * tilting / loaded
    return arm
