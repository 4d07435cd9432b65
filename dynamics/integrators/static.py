"""Static equilibrium under the load at one time.

A train without a drive has no position of rest: forces that accelerate it as a whole are left out of the
balance.
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
CLOSE_LIMIT = 1e-12  # the same for a rest that is compared with a neighboring one
MIN_TOUCH = 1e-3  # over the first level: force of the first guess without a load
ROUNDED = 4.0  # times the rounding of all terms of a balance
TURNS = 8  # iterations of a first guess, whose meshes turn on under their load
LOST_CONTACT = 1e-6  # force over the largest, below which an endless search has lost contact


@dataclass(frozen=True)
class StaticSolution:
    """The rest position of the bodies."""

    status: StaticStatus
    displacement: FloatArray
    """Deviations from the kinematic motion, m and rad. Shape (n,)."""
    mesh_force: FloatArray
    """Transverse, of the driving flanks, N. Shape (m,)."""
    residual: float
    """Largest unbalanced force (torques over the freedom's scale), N."""
    iterations: int


def static_equilibrium(system: System, time: float = 0.0) -> StaticSolution:
    """Balance bushings and meshes against loads and the inertia of the imposed motion at `time`.

    Newton's method with step halving, from the state in which every mesh is a spring of its nominal force,
    on the flank that the load presses. Meshes stay in contact on the way; where that leads to no equilibrium
    (a planet whose pin is too far back to carry), they may part, and what nothing holds then stays where it
    is. Loads that change with an angle act by their means over a turn.
    """
    system = replace(system, arrays=at_mean_loads(system.arrays))
    external = _external(system, time)
    guess = _first_guess(system, time, external)
    solution = _newton(system, time, guess, external, parting=False)
    if solution.status.usable:
        return solution
    nearer = _newton(system, time, _turned_guess(system, time, external), external, parting=False)
    if nearer.status.usable:
        return nearer
    parted = _newton(system, time, guess, external, parting=True)
    return parted if parted.status.usable else solution


def equilibrium_near(system: System, displacement: FloatArray, time: float = 0.0) -> StaticSolution:
    """Balance a system as `static_equilibrium` does, from displacements (n,) near those of its rest.

    It is closer to balance, so that rests of systems that differ a little can be told apart.
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
        """Return the rest of a system whose elements differ a little; its residual is that of the other."""
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
    inertial = observe_laws(arrays, np.array([time]))[3, :, 0] @ arrays.inertial
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
    """Search from `q`, with meshes that may part on the way or not."""
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
    lost_contact = bool(np.any(_per_mesh(arrays, balance.local.force) <= LOST_CONTACT * scale))
    status = StaticStatus.UNBALANCED if lost_contact else StaticStatus.ITERATION_LIMIT
    return StaticSolution(status, q, balance.local.force[system.driving_rows], size, ITERATION_LIMIT)


def _accelerating(arrays: SystemArrays, values: FloatArray) -> FloatArray:
    """Return forces (n,) or their derivatives (n, n), less the part that accelerates free trains.

    Torques and friction that do not balance turn a free train faster or slower as a whole.
    """
    free = arrays.reference.freedom >= 0
    if not np.any(free):
        return values
    vector = arrays.reference.vector[free]
    reaction = np.linalg.solve(vector @ arrays.mass @ vector.T, vector @ values)
    return np.asarray(values - arrays.mass @ vector.T @ reaction)


def _balance(arrays: SystemArrays, time: float, q: FloatArray, external: FloatArray) -> ForceBalance:
    balance = force_balance(arrays, time, q, np.zeros(q.size), external)
    force, stiffness = (_accelerating(arrays, values) for values in (balance.force, balance.stiffness))
    return replace(balance, force=force, stiffness=stiffness)


def _first_guess(system: System, time: float, external: FloatArray) -> FloatArray:
    """Displacements if every mesh were a spring, on the coast flank where the driving one would pull."""
    flanks = system.flanks
    carrying = np.arange(flanks.nominal_force.size)
    loads = _accelerating(system.arrays, external + mean_loads(system.arrays, time))
    q, force = _on_springs(system, time, loads, carrying)
    for element, mesh in enumerate(flanks.coast, start=carrying.size):
        if force[mesh] < 0.0:
            carrying[mesh] = element
    if np.any(carrying >= carrying.size):
        q, _ = _on_springs(system, time, loads, carrying)
    return q


def _turned_guess(system: System, time: float, external: FloatArray) -> FloatArray:
    """Return the first guess at the positions to which its own rotations turn the meshes on.

    At small loads errors of the teeth turn a gear further than the load deflects them.
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
    """Displacements (n,) and forces (m,) if the flanks `carrying` (m,) were springs of their nominal force.

    A spring's stiffness is the secant from lift-off to the nominal force. Positions are those of the
    displacements `turned` (n,); None: of none.
    """
    arrays, n = system.arrays, external.size
    still = np.zeros(n)
    position = local_state(arrays, time, still if turned is None else turned, still).position
    first = arrays.elements.first[carrying]
    table, offset = arrays.elements.laws.flank.table, arrays.elements.offset[first]
    # at lift-off a table may have no stiffness to start from, so unloaded flanks start a little pressed
    touch = MIN_TOUCH * table.level[table.offset[carrying, 4] + 1]
    force = np.maximum(system.flanks.nominal_force, touch)
    flanks = list(enumerate(carrying))
    touching = np.array([table_deflection(table, flank, position[f], 0.0) for f, flank in flanks])
    deflection = np.array([table_deflection(table, flank, position[f], force[f]) for f, flank in flanks])
    secant, rows = force / (deflection - touching), arrays.direction[first]
    matrix = arrays.stiffness + stiffness_across(arrays, time)
    matrix += np.einsum("fi,f,fj->ij", rows, secant, rows)
    pushed = external + (secant * (touching - offset)) @ rows
    q = _solve(arrays, matrix, pushed, np.zeros(n))
    if bearing_rows(arrays).size:
        q = rest_on_bearings(arrays, matrix, pushed).displacement
    return q, secant * (rows @ q + offset - touching)


def _solve(arrays: SystemArrays, matrix: FloatArray, force: FloatArray, q: FloatArray) -> FloatArray:
    """Return the change of `q` that `force` makes, with the law's shaft of each free train at its angle.

    Nothing holds a free train, and no force is left along its motion: without that it could rest anywhere.
    """
    trains = arrays.reference.freedom[arrays.reference.freedom >= 0]
    constraint = np.zeros((trains.size, len(q)))
    constraint[np.arange(trains.size), trains] = float(np.max(np.abs(matrix), initial=1.0))
    left, right = np.concatenate([matrix, constraint]), np.concatenate([force, -constraint @ q])
    return np.asarray(np.linalg.lstsq(left, right, rcond=1e-14)[0])


def _per_mesh(arrays: SystemArrays, values: FloatArray) -> FloatArray:
    """Return the sum of `values` (R,) over the flanks of each mesh, (m,)."""
    elements = arrays.elements
    flank = among(elements.law, (Law.FLANK, Law.SPATIAL_FLANK))
    total = np.zeros(int(np.max(elements.mesh[flank], initial=-1)) + 1)
    np.add.at(total, elements.mesh[flank], values[elements.first[:-1][flank]])
    return total


def _rounding(arrays: SystemArrays, balance: ForceBalance, q: FloatArray, external: FloatArray) -> float:
    """Return the unbalanced force by rounding of displacements, coordinates and forces, N.

    Every term of the balance counts by its size: light loads on stiff teeth are their small difference.
    """
    local, rows = balance.local, np.abs(arrays.direction)
    strained = rows @ np.abs(q) + np.abs(local.coordinate)
    tangent = block_diagonal(arrays.elements, np.abs(local.tangent))
    terms = np.abs(arrays.stiffness) @ np.abs(q) + (tangent @ strained + np.abs(local.force)) @ rows
    largest = float(np.max((terms + np.abs(external)) / arrays.scale, initial=0.0))
    return float(np.finfo(float).eps) * largest


def _size(arrays: SystemArrays, balance: ForceBalance) -> float:
    """Largest unbalanced force, torques over the freedom's scale, N."""
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
    """Halve the update until it lowers the residual (or is tiny), all meshes in contact unless parting."""
    for halving in range(30):
        trial = q + update * 0.5**halving
        balance = _balance(arrays, time, trial, external)
        # beyond lift-off there is no stiffness to come back by, however small the residual is there
        touching = parting or np.all(_per_mesh(arrays, balance.local.tangent[:, 0]) > 0.0)
        if _size(arrays, balance) < size and (touching or np.max(np.abs(balance.force)) == 0.0):
            break
    return trial, balance
