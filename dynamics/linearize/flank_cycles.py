"""The driving flanks over the positions of their tables, each with its static force held."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import sparse_matrices
from dynamics.assembly.assemble import System
from dynamics.kernels.by_address import by_address
from dynamics.kernels.local_state import LocalState
from dynamics.linearize.linear_system import LinearSystem
from dynamics.motion.observation import Watch, local_state, observe, static_deflections
from dynamics.types import FloatArray

SAMPLES, LEAST_SAMPLES, MOST_POSITIONS = 512, 64, 8192
ITERATIONS = 60
HELD = 1e-12  # of the force: where the search for a deflection ends
LEAST_FORCE = 1e-3  # of the first level: an unloaded flank just touches


@dataclass(frozen=True)
class FlankCycle:
    """A driving flank of p rows at T positions, uniform over one period of its table.

    Attributes
    ----------
    rows : slice
        Of its local coordinates.
    coordinate, force : (T, p) arrays
        Local coordinates in m: the transmission error that carries the static mesh force, and the others as
        the bodies rest; local forces, N. The first force is the static one everywhere.
    tangent : (p, p) array
        Derivatives of the forces in the coordinates, mean over the positions, N/m.
    blocked : (T, p) array
        Forces while the transmission error is held at its mean, N.
    stiffness : (T,) array
        Derivative of the mesh force in the transmission error, N/m.
    """

    rows: slice
    coordinate: FloatArray
    force: FloatArray
    tangent: FloatArray
    blocked: FloatArray
    stiffness: FloatArray

    @property
    def static_error(self) -> FloatArray:
        """Static transmission error at the static mesh force, (T,) m."""
        return np.asarray(self.coordinate[:, 0])


def flank_cycles(
    system: System, linear: LinearSystem, time: float = 0.0, orders: int = 1, samples: int = SAMPLES
) -> tuple[FlankCycle, ...]:
    """Return the cycle of every driving flank about the equilibrium of `linear`, loads taken at `time`.

    The coordinates beside the transmission error (misalignment, center distance, sliding) are those of the
    bodies at rest, so tables are read where these are. `orders` harmonics per base pitch are wanted, at up to
    `samples` positions per base pitch.
    """
    arrays, rest = system.arrays, np.zeros(system.arrays.mass.shape[0])
    at_rest = local_state(arrays, time, linear.equilibrium.displacement, rest)
    probe = by_address(_by_coordinates(arrays))  # laid out once for thousands of look-ups
    origin = local_state(probe, time, *_states(probe, np.zeros(at_rest.coordinate.size), 0.0)).position
    force = linear.equilibrium.mesh_force
    cycles = []
    for index, mesh in enumerate(system.scene.meshes):
        period = mesh.table.period
        count = max(min(samples, MOST_POSITIONS // period), min(samples, LEAST_SAMPLES), 4 * orders)
        position = np.arange(count * period) / count
        cycles.append(_cycle(system, probe, time, at_rest, origin, index, float(force[index]), position))
    return tuple(cycles)


def averaged(
    system: System, linear: LinearSystem, cycles: tuple[FlankCycle, ...], time: float
) -> LinearSystem:
    """Return `linear` with the mean tangents of all driving flanks instead of those at its position."""
    arrays, rest = system.arrays, np.zeros(system.arrays.mass.shape[0])
    tangent = local_state(arrays, time, linear.equilibrium.displacement, rest).tangent
    stiffness, spring = linear.stiffness.copy(), linear.spring_stiffness.copy()
    for index, cycle in enumerate(cycles):
        gradient, p = arrays.direction[cycle.rows], cycle.tangent.shape[0]
        stiffness += gradient.T @ (cycle.tangent - tangent[cycle.rows, :p]) @ gradient
        spring[index] = cycle.tangent[0, 0]
    return replace(linear, stiffness=stiffness, spring_stiffness=spring)


def _by_coordinates(arrays: SystemArrays) -> SystemArrays:
    """Return arrays whose freedoms are the R local coordinates and the m positions themselves."""
    rows, meshes = arrays.direction.shape[0], arrays.turn.shape[0]
    direction, turn = np.eye(rows, rows + meshes), np.eye(meshes, rows + meshes, rows)
    none = np.zeros((rows + meshes, rows + meshes))
    return arrays._replace(
        direction=direction,
        turn=np.ascontiguousarray(turn),
        sparse=sparse_matrices(np.eye(rows + meshes), none, none, direction, turn),
        elements=arrays.elements._replace(offset=np.zeros(rows)),
    )


def _states(probe: SystemArrays, coordinate: FloatArray, moved: float) -> tuple[FloatArray, FloatArray]:
    """Return q and v of the probe: coordinates (R,), and all positions moved alike."""
    q = np.concatenate([coordinate, np.full(probe.turn.shape[0], moved)])
    return q, np.zeros(q.size)


def _cycle(
    system: System,
    probe: SystemArrays,
    time: float,
    at_rest: LocalState,
    origin: FloatArray,
    index: int,
    force: float,
    position: FloatArray,
) -> FlankCycle:
    """Walk one flank over the positions (T,)."""
    first, end = (int(row) for row in system.arrays.elements.first[index : index + 2])
    rows = slice(first, end)
    level = system.flanks.tables[index].level
    force = max(force, LEAST_FORCE * float(level[1] - level[0]))
    guess = np.empty_like(position)
    static_deflections(system.flanks.law.table, index, position, force, guess)
    watch = Watch(probe)
    samples = [
        _held(watch, rows, time, *_states(probe, at_rest.coordinate, x - origin[index]), force, d)
        for x, d in zip(position, guess, strict=True)
    ]
    coordinate, force_here, tangents = (np.array(part) for part in zip(*samples, strict=True))
    tangent = np.mean(tangents, axis=0)
    held = np.tile(_states(probe, at_rest.coordinate, 0.0)[0], (position.size, 1))
    held[:, first] = np.mean(coordinate[:, 0])
    held[:, -origin.size :] = (position - origin[index])[:, None]
    seen = observe(probe, np.full(position.size, time), held, np.zeros_like(held))
    return FlankCycle(rows, coordinate, force_here, tangent, seen.force[rows].T, tangents[:, 0, 0])


def _held(
    watch: Watch, rows: slice, time: float, q: FloatArray, v: FloatArray, force: float, guess: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return coordinates (p,), forces (p,) and tangents (p, p) of `rows` where the first carries `force`.

    Newton's method, from `guess`; pressed on where flanks part.
    """
    row, size = rows.start, rows.stop - rows.start
    q[row] = guess
    step = abs(guess)
    for _ in range(ITERATIONS):
        seen = watch.look(time, q, v)
        left = force - seen.force[row]
        if abs(left) <= HELD * force:
            break
        stiffness = seen.tangent[row, 0]
        q[row] += left / stiffness if stiffness > 0.0 else step
    return seen.coordinate[rows].copy(), seen.force[rows].copy(), seen.tangent[rows, :size].copy()
