"""Static equilibrium under the load at one time.

A train without a drive (a free train) has no position of rest: forces that accelerate it as a whole are left
out of the balance. Axis letters: n freedoms q, m meshes, R local coordinates of the force elements. Forces on
rotations are compared by torque over the freedom's scale, a radius, N.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import System
from dynamics.assembly.bearing_rest import bearing_rows, rest_on_bearings
from dynamics.forces.laws import Law, among
from dynamics.meshes.table_lookup import table_deflection
from dynamics.motion.force_balance import (
    ForceBalance,
    at_mean_loads,
    block_diagonal,
    force_balance,
    mean_loads,
    stiffness_across,
)
from dynamics.motion.observation import local_state, observe_laws
from dynamics.types import FloatArray, IntArray, StaticStatus

ITERATION_LIMIT = 50  # most Newton iterations to equilibrium
RESIDUAL_LIMIT = 1e-10  # unbalanced force over the largest force, at which the search ends
CLOSE_LIMIT = 1e-12  # as `RESIDUAL_LIMIT`, for a rest that is compared with a neighboring one
MIN_TOUCH = 1e-3  # force of the first guess without a load, over that of the first level of the table
ROUNDED = 4.0  # unbalanced force over the rounding of all terms of a balance, at which the search ends
TURNS = 8  # iterations of a first guess whose meshes change position by the displacements of the guess
LOST_CONTACT = 1e-6  # force over the largest, below which a search at its limit has lost contact
HALVINGS = 30  # most halvings of a step: the last one is 2e-9 of it
SINGULAR = 1e-14  # singular value over the largest one, below which nothing holds its motion


@dataclass(frozen=True)
class StaticSolution:
    """The rest position of the bodies."""

    status: StaticStatus
    displacement: FloatArray
    """Deviations from the kinematic motion, m and rad. Shape (n,)."""
    mesh_force: FloatArray
    """Transverse force of the driving flank of each mesh, N. Shape (m,)."""
    residual: float
    """Largest unbalanced force (torques over the freedom's scale), N."""
    iterations: int


def static_equilibrium(system: System, time: float = 0.0) -> StaticSolution:
    """Balance bushings and meshes against loads and the inertia of the imposed motion at `time`.

    Newton's method with step halving starts where every mesh is a spring with its stiffness at the nominal
    force, on the flank that the load presses. First, steps keep all meshes in contact. If that leads to no
    equilibrium (a planet whose pin is too far back to carry), meshes may part, and bodies that nothing holds
    then stay where they are. Loads that change with an angle act by their means over a turn.
    """
    system = replace(system, arrays=at_mean_loads(system.arrays))
    external = _external(system, time)
    guess = _first_guess(system, time, external)
    solution = _newton(system, time, guess, external, parting=False)
    if solution.status.usable:
        return solution
    turned = _newton(system, time, _turned_guess(system, time, external), external, parting=False)
    if turned.status.usable:
        return turned
    parted = _newton(system, time, guess, external, parting=True)
    return parted if parted.status.usable else solution


def equilibrium_near(system: System, displacement: FloatArray, time: float = 0.0) -> StaticSolution:
    """Balance a system as `static_equilibrium` does, from displacements (n,) near those of its rest.

    The search ends at `CLOSE_LIMIT`, so that rests of systems that differ a little can be told apart.
    """
    system = replace(system, arrays=at_mean_loads(system.arrays))
    external = _external(system, time)
    return _newton(system, time, displacement, external, parting=False, limit=CLOSE_LIMIT)


@dataclass(frozen=True)
class RestsBeside:
    """Rests of systems that differ a little from one at rest, to first order: one factorization for all."""

    time: float
    displacement: FloatArray
    """Displacement of the system at rest, m and rad. Shape (n,)."""
    force: FloatArray
    """Local forces of the elements at rest, N. Shape (R,)."""
    residual: float
    """Largest unbalanced force at rest, N."""
    compliance: FloatArray
    """Displacements per force on the freedoms. Shape (n, n)."""

    @classmethod
    def of(cls, system: System, displacement: FloatArray, time: float = 0.0) -> RestsBeside:
        """Linearize a system about its rest at displacements (n,)."""
        arrays, n = at_mean_loads(system.arrays), displacement.size
        balance = _balance(arrays, time, displacement, np.zeros(n))
        unit = _accelerating(arrays, np.eye(n))
        compliance = _solve(arrays, balance.stiffness, unit, np.zeros((n, n)))
        return cls(time, displacement, balance.local.force, _size(arrays, balance), compliance)

    def rest(self, system: System) -> StaticSolution:
        """Return the rest of a system whose elements differ a little; the residual is that of this rest."""
        arrays = at_mean_loads(system.arrays)
        local = local_state(arrays, self.time, self.displacement, np.zeros(self.displacement.size))
        shift = self.compliance @ ((self.force - local.force) @ arrays.direction)
        force = local.force + block_diagonal(arrays.elements, local.tangent) @ (arrays.direction @ shift)
        flanks = force[system.driving_rows]
        return StaticSolution(StaticStatus.CONVERGED, self.displacement + shift, flanks, self.residual, 1)


def _external(system: System, time: float) -> FloatArray:
    """Return the forces of mean loads and of the inertia of the imposed motion on the freedoms (n,)."""
    arrays = system.arrays
    torque = np.array([float(load.torque(time)) for load in system.scene.loads])
    acceleration = observe_laws(arrays, np.array([time]))[3, :, 0]  # row 3 of (4, laws, times)
    inertial = acceleration @ arrays.inertial
    return np.asarray(torque @ arrays.load.direction + inertial + arrays.constant)


def _newton(
    system: System,
    time: float,
    q: FloatArray,
    external: FloatArray,
    *,
    parting: bool,
    limit: float = RESIDUAL_LIMIT,
) -> StaticSolution:
    """Search for the rest from `q` (n,) by Newton's method; `parting`: meshes may part on the way."""
    arrays = system.arrays
    balance = _balance(arrays, time, q, external)
    scale = max(
        float(np.max(np.abs(external / arrays.scale), initial=0.0)),
        float(np.max(np.abs(balance.local.force), initial=0.0)),
    )
    for iteration in range(ITERATION_LIMIT + 1):
        size = _size(arrays, balance)
        if size <= limit * scale or size <= ROUNDED * _rounding(arrays, balance, q, external):
            force = balance.local.force[system.driving_rows]
            return StaticSolution(StaticStatus.CONVERGED, q, force, size, iteration)
        update = _solve(arrays, balance.stiffness, balance.force, q)
        q, balance = _line_search(arrays, time, q, update, external, size, parting)
    lost = bool(np.any(_per_mesh(arrays, balance.local.force) <= LOST_CONTACT * scale))
    status = StaticStatus.UNBALANCED if lost else StaticStatus.ITERATION_LIMIT
    return StaticSolution(status, q, balance.local.force[system.driving_rows], size, ITERATION_LIMIT)


def _accelerating(arrays: SystemArrays, values: FloatArray) -> FloatArray:
    """Return forces (n,) or their derivatives (n, n), less the part that accelerates free trains.

    Torques and friction that do not balance turn a free train faster or slower as a whole. The part is that
    of an acceleration along the train's motion: mass times motion times the acceleration.
    """
    free = arrays.reference.freedom >= 0
    if not np.any(free):
        return values
    vector = arrays.reference.vector[free]  # motions of the free trains
    acceleration = np.linalg.solve(vector @ arrays.mass @ vector.T, vector @ values)
    return np.asarray(values - arrays.mass @ vector.T @ acceleration)


def _balance(arrays: SystemArrays, time: float, q: FloatArray, external: FloatArray) -> ForceBalance:
    balance = force_balance(arrays, time, q, np.zeros(q.size), external)
    force, stiffness = (_accelerating(arrays, values) for values in (balance.force, balance.stiffness))
    return replace(balance, force=force, stiffness=stiffness)


def _first_guess(system: System, time: float, external: FloatArray) -> FloatArray:
    """Return the displacements (n,) if every mesh were a spring.

    The spring is on the driving flank, or on the coast flank of a mesh whose driving flank would pull.
    """
    flanks = system.flanks
    carrying = np.arange(flanks.nominal_force.size)  # the driving flanks are the first elements
    loads = _accelerating(system.arrays, external + mean_loads(system.arrays, time))
    q, force = _on_springs(system, time, loads, carrying)
    for element, mesh in enumerate(flanks.coast, start=carrying.size):
        if force[mesh] < 0.0:
            carrying[mesh] = element
    if np.any(carrying >= carrying.size):
        q, _ = _on_springs(system, time, loads, carrying)
    return q


def _turned_guess(system: System, time: float, external: FloatArray) -> FloatArray:
    """Return the displacements of springs at the mesh positions that follow from these displacements.

    At small loads errors of the teeth turn a gear further than the load deflects it, so that the positions
    without displacements are no good guess.
    """
    carrying = np.arange(system.flanks.nominal_force.size)
    loads = _accelerating(system.arrays, external + mean_loads(system.arrays, time))
    q = np.zeros(external.size)
    for _ in range(TURNS):
        q, _ = _on_springs(system, time, loads, carrying, q)
    return q


def _on_springs(
    system: System, time: float, external: FloatArray, carrying: IntArray, turned: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return displacements (n,) and forces (m,) if the flanks `carrying` (m,) were springs.

    A spring's stiffness is the secant from lift-off to the nominal force. Mesh positions follow from the
    displacements `turned` (n,); None: they are 0.
    """
    arrays, n = system.arrays, external.size
    zero = np.zeros(n)
    position = local_state(arrays, time, zero if turned is None else turned, zero).position
    first = arrays.elements.first[carrying]
    table, offset = arrays.elements.laws.flank.table, arrays.elements.offset[first]
    # at lift-off a table may have no stiffness to start from, so unloaded flanks start a little pressed
    # column 4 of the offsets is the first level, lift-off; the next one has a force
    touch = MIN_TOUCH * table.level[table.offset[carrying, 4] + 1]
    force = np.maximum(system.flanks.nominal_force, touch)
    flanks = list(enumerate(carrying))
    touching = np.array([table_deflection(table, flank, position[f], 0.0) for f, flank in flanks])
    deflection = np.array([table_deflection(table, flank, position[f], force[f]) for f, flank in flanks])
    secant, rows = force / (deflection - touching), arrays.direction[first]
    matrix = arrays.stiffness + stiffness_across(arrays, time)
    matrix += np.einsum("fi,f,fj->ij", rows, secant, rows)
    force_on_springs = external + (secant * (touching - offset)) @ rows
    q = _solve(arrays, matrix, force_on_springs, np.zeros(n))
    if bearing_rows(arrays).size:
        q = rest_on_bearings(arrays, matrix, force_on_springs).displacement
    return q, secant * (rows @ q + offset - touching)


def _solve(arrays: SystemArrays, matrix: FloatArray, force: FloatArray, q: FloatArray) -> FloatArray:
    """Return the change of `q` (n,) by `force` (n,) that brings the shaft of each free law to angle 0.

    Nothing holds a free train, and no force acts along its motion: without this condition on its angle the
    train could rest anywhere.
    """
    trains = arrays.reference.freedom[arrays.reference.freedom >= 0]
    constraint = np.zeros((trains.size, len(q)))
    constraint[np.arange(trains.size), trains] = float(np.max(np.abs(matrix), initial=1.0))
    left, right = np.concatenate([matrix, constraint]), np.concatenate([force, -constraint @ q])
    return np.asarray(np.linalg.lstsq(left, right, rcond=SINGULAR)[0])


def _per_mesh(arrays: SystemArrays, values: FloatArray) -> FloatArray:
    """Return the sum of `values` (R,) over the flanks of each mesh, (m,)."""
    elements = arrays.elements
    flank = among(elements.law, (Law.FLANK, Law.SPATIAL_FLANK))
    total = np.zeros(int(np.max(elements.mesh[flank], initial=-1)) + 1)
    np.add.at(total, elements.mesh[flank], values[elements.first[:-1][flank]])
    return total


def _rounding(arrays: SystemArrays, balance: ForceBalance, q: FloatArray, external: FloatArray) -> float:
    """Return the unbalanced force by rounding of displacements, coordinates and forces, N.

    It is the sum of the sizes of all terms times the rounding of a number: a light load on stiff teeth is a
    small difference of large terms.
    """
    local, rows = balance.local, np.abs(arrays.direction)
    coordinate = rows @ np.abs(q) + np.abs(local.coordinate)
    tangent = block_diagonal(arrays.elements, np.abs(local.tangent))
    terms = np.abs(arrays.stiffness) @ np.abs(q) + (tangent @ coordinate + np.abs(local.force)) @ rows
    largest = float(np.max((terms + np.abs(external)) / arrays.scale, initial=0.0))
    return float(np.finfo(float).eps) * largest


def _size(arrays: SystemArrays, balance: ForceBalance) -> float:
    """Return the largest unbalanced force, N."""
    return float(np.max(np.abs(balance.force / arrays.scale), initial=0.0))


def _line_search(
    arrays: SystemArrays,
    time: float,
    q: FloatArray,
    update: FloatArray,
    external: FloatArray,
    size: float,
    parting: bool,
) -> tuple[FloatArray, ForceBalance]:
    """Halve the update until it lowers the residual, or is tiny, and return its end with the balance there.

    Unless `parting`, all meshes stay in contact.
    """
    for halving in range(HALVINGS):
        trial = q + update * 0.5**halving
        balance = _balance(arrays, time, trial, external)
        # beyond lift-off there is no stiffness to come back by, however small the residual is there
        touching = parting or np.all(_per_mesh(arrays, balance.local.tangent[:, 0]) > 0.0)
        if _size(arrays, balance) < size and (touching or np.max(np.abs(balance.force)) == 0.0):
            break
    return trial, balance
