"""Compiled kinematic motion, mesh positions, local coordinates, external forces, accelerations at a time.

The kinematic motion turns all shafts by exact ratios to k *laws*: speeds over time, which consist of pieces,
each a cubic. Freedoms q are the deviations from it, v their rates. A *free train*, which no drive turns, has
its own rotation in q; whole quanta of it, small parts of a revolution, are moved into the kinematic motion.
Local coordinates are those of force elements; the *drift* of one is its rate in the kinematic motion.
"""

from __future__ import annotations

import math

from dynamics.arrays.arrays import KinematicMotion, SystemArrays
from dynamics.arrays.modal_freedoms import add_modal_motion
from dynamics.arrays.sparse_rows import row_product, row_products
from dynamics.forces.elements import Elements
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.cubics import Cubics, area, cubic, piece_at, value_and_slope
from dynamics.kernels.local_state import LocalState
from dynamics.meshes.table_lookup import wrapped
from dynamics.types import FloatArray, IntArray

# Columns of the motion of the laws (k, 4): whole revolutions, fraction of one, speed (rad/s), acceleration.
FULL_TURNS, FRACTION, SPEED, ACCELERATION = 0, 1, 2, 3
MOTION_COLUMNS = 4  # number of these columns
QUANTA_PER_TURN = 2**20
"""A free train's own rotation is moved into the reference phase in units of this part of a revolution: an
exact power of two, so that counting them loses nothing."""
QUANTUM = 2.0 * math.pi / QUANTA_PER_TURN
"""A quantum of rotation, rad."""


@compiled
def law_value(law: Cubics, index: int, time: float) -> float:
    """Return the value of law `index`."""
    return value_and_slope(law, index, time)[0]


@compiled
def write_motion(reference: KinematicMotion, time: float, quanta: IntArray, motion: FloatArray) -> None:
    """Write the motion of every law at `time` into `motion` (k, 4); the fraction may exceed 1 by `quanta`.

    `quanta` (k,) counts the quanta of a revolution that a free train's own rotation has been moved by.
    """
    for k in range(motion.shape[0]):
        piece = piece_at(reference.speed, k, time)
        angle = area(reference.speed, piece, time - reference.speed.start[piece])
        turns = reference.fraction[piece] + angle / (2.0 * math.pi)
        full = math.floor(turns)
        motion[k, FULL_TURNS] = reference.full_turns[piece] + full + quanta[k] // QUANTA_PER_TURN
        motion[k, FRACTION] = turns - full + (quanta[k] % QUANTA_PER_TURN) / QUANTA_PER_TURN
        motion[k, SPEED], motion[k, ACCELERATION] = cubic(reference.speed, piece, time)


@inner
def _turns_phase(reference: KinematicMotion, mesh: int, law: int, full_turns: float) -> float:
    """Return the base pitches that whole revolutions of a law add to a mesh, without whole periods."""
    # all in integers: pitches times the denominator
    cycle = reference.denominator[mesh, law] * reference.period[mesh]
    remainder = (int(full_turns) % cycle) * reference.numerator[mesh, law] % cycle
    return float(remainder / reference.denominator[mesh, law])


@inner
def set_phases(
    reference: KinematicMotion, motion: FloatArray, position: FloatArray, local: LocalState
) -> None:
    """Write the meshes' positions (base pitches) and their rates (per second) in the kinematic motion.

    Base pitches per revolution of a law are a fraction of integers. So whole revolutions add an integer
    number of periods, which drop exactly, and a remainder in integers: no digit is lost however far the
    shafts turn. The remainder takes divisions of integers; `local` keeps it until a revolution is over.
    """
    for k in range(motion.shape[0]):
        if local.full_turns[k] != motion[k, FULL_TURNS]:
            local.full_turns[k] = motion[k, FULL_TURNS]
            for m in range(position.size):
                local.turns_phase[m, k] = _turns_phase(reference, m, k, motion[k, FULL_TURNS])
    for m in range(position.size):
        phase, pace = reference.offset[m], 0.0
        for k in range(motion.shape[0]):
            phase += local.turns_phase[m, k]
            phase += motion[k, FRACTION] * reference.numerator[m, k] / reference.denominator[m, k]
            pace += reference.per_radian[m, k] * motion[k, SPEED]
        position[m] = wrapped(phase, float(reference.period[m]))
        local.pace[m] = pace


@inner
def set_drift(elements: Elements, time: float, motion: FloatArray, local: LocalState) -> None:
    """Write into `local` the time, the drift of the coordinates, and the speeds of rotation of elements.

    Rows before `elements.carried` have no drift, elements before `elements.turned` no speed of rotation.
    """
    local.clock[0] = time
    for r in range(elements.carried, local.drift.size):
        local.drift[r] = 0.0
    for e in range(elements.turned, elements.law.size):
        local.speed[e, 0], local.speed[e, 1] = 0.0, 0.0
    for k in range(motion.shape[0]):
        speed = motion[k, SPEED]
        for r in range(elements.carried, local.drift.size):
            local.drift[r] += elements.drift[k, r] * speed
        for e in range(elements.turned, elements.law.size):
            local.speed[e, 0] += elements.speed[k, e, 0] * speed
            local.speed[e, 1] += elements.speed[k, e, 1] * speed


@inner
def add_motion(
    system: SystemArrays,
    q: FloatArray,
    v: FloatArray,
    position: FloatArray,
    coordinate: FloatArray,
    rate: FloatArray,
) -> None:
    """Add the deviations `q` to the positions of meshes; write the local coordinates and their rates.

    The rates are those by `v`, without the drift.
    """
    add_body_motion(system, q, v, position, coordinate, rate)
    add_modal_motion(system.sparse.modal, q, coordinate)
    add_modal_motion(system.sparse.modal, v, rate)


@inner
def add_body_motion(
    system: SystemArrays,
    q: FloatArray,
    v: FloatArray,
    position: FloatArray,
    coordinate: FloatArray,
    rate: FloatArray,
) -> None:
    """Add motion as `add_motion` does, without the modal freedoms, which `q` and `v` may lack."""
    bodies, position_gradient = system.sparse.bodies, system.sparse.position_gradient
    for r in range(coordinate.size):
        displacement, moving = row_products(bodies, r, bodies.weight, q, bodies.weight, v)
        coordinate[r], rate[r] = system.elements.offset[r] + displacement, moving
    for m in range(position.size):
        position[m] += row_product(position_gradient, position_gradient.weight, m, q)


@inner
def law_speed(reference: KinematicMotion, law: int, motion: FloatArray, velocity: FloatArray) -> float:
    """Return the speed of a law's shaft, rad/s, with the own rotation of a free train in `velocity` (n,)."""
    speed = motion[law, SPEED]
    if reference.freedom[law] >= 0:
        speed += velocity[reference.freedom[law]]
    return float(speed)


@inner
def move_free_trains(reference: KinematicMotion, quanta: IntArray, q: FloatArray) -> None:
    """Move whole quanta of the own rotation of free trains from `q` into the kinematic motion.

    `q` changes along the kinematic vector of the law, so that no transmission error, spring or position
    changes. At most half a quantum stays in `q`, so that no digit is lost however far the train turns.
    """
    for k in range(reference.freedom.size):
        if reference.freedom[k] < 0:  # a drive
            continue
        count = math.floor(q[reference.freedom[k]] / QUANTUM + 0.5)
        if count == 0.0:
            continue
        quanta[k] += int(count)
        for i in range(q.size):
            q[i] -= reference.vector[k, i] * (count * QUANTUM)


@inner
def external_force(system: SystemArrays, time: float, motion: FloatArray, force: FloatArray) -> None:
    """Write loads, pin errors and the inertial force of the kinematic motion into `force` (n,).

    `system.constant` has pin errors, preloads and gravity. Loads and inertia do not reach modal freedoms.
    """
    for i in range(force.size):
        force[i] = system.constant[i]
    for k in range(motion.shape[0]):
        for i in range(system.sparse.modal.first):
            force[i] += system.inertial[k, i] * motion[k, ACCELERATION]
    for load in range(system.load.direction.shape[0]):
        torque = law_value(system.load.torque, load, time)
        for i in range(system.sparse.modal.first):
            force[i] += system.load.direction[load, i] * torque
