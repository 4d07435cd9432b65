"""Static equilibrium under the load at one time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.forces.table_lookup import table_deflection, table_force
from dynamics.system.arrays import SystemArrays
from dynamics.system.assemble import System
from dynamics.system.observation import observe_flanks, observe_laws
from dynamics.types import FloatArray, StaticStatus

ITERATION_LIMIT = 50
RESIDUAL_LIMIT = 1e-10  # of the largest force
LEAST_TOUCH = 1e-3  # of the first level: force of the first guess where there is no load
LOST_CONTACT = 1e-6  # of the largest force: below it a search without end has run out of contact


@dataclass(frozen=True)
class StaticSolution:
    """Where the bodies rest.

    Attributes
    ----------
    status : StaticStatus
    displacement : (n,) array
        Deviations from the kinematic motion, m and rad.
    mesh_force : (m,) array
        Transverse, N.
    residual : float
        Largest unbalanced force (torques over the freedom's scale), N.
    iterations : int
    """

    status: StaticStatus
    displacement: FloatArray
    mesh_force: FloatArray
    residual: float
    iterations: int


def static_equilibrium(system: System, time: float = 0.0) -> StaticSolution:
    """Balance bushings and meshes against loads and the inertia of the imposed motion at `time`.

    Newton's method with step halving, from the state in which every mesh is a spring of its nominal force.
    """
    arrays = system.arrays
    external = _external(system, time)
    q = _first_guess(system, time, external)
    residual, stiffness, force = _residual(arrays, time, q, external)
    scale = max(
        float(np.max(np.abs(external / arrays.scale), initial=0.0)), float(np.max(force, initial=0.0))
    )
    for iteration in range(ITERATION_LIMIT + 1):
        size = float(np.max(np.abs(residual / arrays.scale), initial=0.0))
        if size <= RESIDUAL_LIMIT * scale:
            return StaticSolution(StaticStatus.CONVERGED, q, force, size, iteration)
        matrix = arrays.stiffness + np.einsum("fi,f,fj->ij", arrays.direction, stiffness, arrays.direction)
        update = _solve(arrays, matrix, residual, q)
        q, residual, stiffness, force = _line_search(arrays, time, q, update, external, size)
    lost = bool(np.any(force <= LOST_CONTACT * scale))
    status = StaticStatus.UNBALANCED if lost else StaticStatus.ITERATION_LIMIT
    return StaticSolution(status, q, force, size, ITERATION_LIMIT)


def _external(system: System, time: float) -> FloatArray:
    """Return loads and inertial forces, (n,): of the laws, and of free trains that the loads accelerate."""
    arrays = system.arrays
    acceleration = observe_laws(arrays, np.array([time]))[3, :, 0]
    torque = np.array([float(load.torque(time)) for load in system.scene.loads])
    force = torque @ arrays.load.direction + acceleration @ arrays.inertial + arrays.constant
    free = arrays.reference.freedom >= 0
    if np.any(free):
        vector = arrays.reference.vector[free]
        taken = np.linalg.solve(vector @ arrays.mass @ vector.T, vector @ force)
        force = force - arrays.mass @ vector.T @ taken
    return np.asarray(force)


def _first_guess(system: System, time: float, external: FloatArray) -> FloatArray:
    """Displacements if every mesh were a spring: its secant from lift-off to the nominal force."""
    arrays, flanks = system.arrays, system.flanks
    n, m = external.size, flanks.nominal_force.size
    position = _observe(arrays, time, np.zeros(n))[0]
    table = arrays.flank.table
    # at lift-off a table may have no stiffness to start from, so unloaded flanks start a little pressed
    touch = LEAST_TOUCH * table.level[table.offset[:, 4] + 1]
    force = np.maximum(flanks.nominal_force, touch)
    touching = np.array([table_deflection(table, f, position[f], 0.0) for f in range(m)])
    deflection = np.array([table_deflection(table, f, position[f], force[f]) for f in range(m)])
    secant = force / (deflection - touching)
    matrix = arrays.stiffness + np.einsum("fi,f,fj->ij", arrays.direction, secant, arrays.direction)
    return _solve(arrays, matrix, external + (secant * touching) @ arrays.direction, np.zeros(n))


def _solve(arrays: SystemArrays, matrix: FloatArray, force: FloatArray, q: FloatArray) -> FloatArray:
    """Return the change of `q` that `force` makes, with the law's shaft of each free train at its place.

    Nothing holds a free train, and no force is left along its motion: without that it could rest anywhere.
    """
    own = arrays.reference.freedom[arrays.reference.freedom >= 0]
    held = np.zeros((own.size, q.size))
    held[np.arange(own.size), own] = float(np.max(np.abs(matrix), initial=1.0))
    left, right = np.concatenate([matrix, held]), np.concatenate([force, -held @ q])
    return np.asarray(np.linalg.lstsq(left, right, rcond=1e-14)[0])


def _observe(arrays: SystemArrays, time: float, q: FloatArray) -> FloatArray:
    """Position, transmission error and force of every flank at rest in `q`, (3, m)."""
    return observe_flanks(arrays, np.array([time]), q[None, :], np.zeros((1, q.size)))[:, :, 0]


def _residual(
    arrays: SystemArrays, time: float, q: FloatArray, external: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unbalanced force (n,), tangent stiffness (m,) and force (m,) of the flanks."""
    position, deflection, force = _observe(arrays, time, q)
    table = arrays.flank.table
    stiffness = np.array([table_force(table, f, position[f], deflection[f], 0)[1] for f in range(force.size)])
    return external - arrays.stiffness @ q - force @ arrays.direction, stiffness, force


def _line_search(
    arrays: SystemArrays, time: float, q: FloatArray, update: FloatArray, external: FloatArray, size: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Halve the update until it lowers the residual with all flanks in contact (or is tiny)."""
    for halving in range(30):
        trial = q + update * 0.5**halving
        residual, stiffness, force = _residual(arrays, time, trial, external)
        better = float(np.max(np.abs(residual / arrays.scale))) < size
        # beyond lift-off there is no stiffness to come back by, however small the residual is there
        if better and (np.all(stiffness > 0.0) or np.max(np.abs(residual)) == 0.0):
            break
    return trial, residual, stiffness, force
