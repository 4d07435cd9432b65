"""Observation of the flanks and the laws at given states: position, transmission error, force, speeds."""

from __future__ import annotations

import numpy as np

from dynamics.forces.compiled import compiled
from dynamics.forces.flank_force import flank_force
from dynamics.forces.packed_tables import PackedTables
from dynamics.forces.table_lookup import table_deflection, wrapped
from dynamics.system.arrays import SystemArrays
from dynamics.system.motion import MOTION_COLUMNS, flank_phase, write_motion
from dynamics.types import FloatArray, IntArray


def observe_flanks(
    system: SystemArrays, time: FloatArray, q: FloatArray, v: FloatArray, moved: IntArray | None = None
) -> FloatArray:
    """Return position, transmission error and force of every flank at T states, (3, m, T).

    `time` (T,), `q` and `v` (T, n); `moved` (T, k) counts the quanta of free trains moved into the reference.
    """
    flanks, laws = system.direction.shape[0], system.inertial.shape[0]
    observed = np.empty((3, flanks, time.size))
    counted = np.zeros((time.size, laws), dtype=np.int64) if moved is None else moved
    _observe_flanks(system, time, counted, q, v, np.empty((laws, MOTION_COLUMNS)), observed)
    return observed


@compiled
def _observe_flanks(
    system: SystemArrays,
    time: FloatArray,
    moved: IntArray,
    q: FloatArray,
    v: FloatArray,
    motion: FloatArray,
    observed: FloatArray,
) -> None:
    """Write what `observe_flanks` returns."""
    for k in range(time.size):
        write_motion(system.reference, time[k], moved[k], motion)
        for f in range(system.direction.shape[0]):
            position = flank_phase(system.reference, f, motion)
            deflection, rate = 0.0, 0.0
            for i in range(q.shape[1]):
                position += system.turn[f, i] * q[k, i]
                deflection += system.direction[f, i] * q[k, i]
                rate += system.direction[f, i] * v[k, i]
            observed[0, f, k] = wrapped(position, float(system.reference.period[f]))
            observed[1, f, k] = deflection
            observed[2, f, k] = flank_force(system.flank, f, position, deflection, rate, 0)[0]


def observe_laws(system: SystemArrays, time: FloatArray) -> FloatArray:
    """Return whole revolutions, fraction, speed (rad/s) and acceleration of every law, (4, k, T)."""
    laws = system.inertial.shape[0]
    observed = np.empty((time.size, laws, MOTION_COLUMNS))
    _observe_laws(system, time, np.zeros(laws, dtype=np.int64), observed)
    return np.ascontiguousarray(np.moveaxis(observed, (2, 1), (0, 1)))


@compiled
def _observe_laws(system: SystemArrays, time: FloatArray, moved: IntArray, observed: FloatArray) -> None:
    """Write the motion of the laws into `observed` (T, k, 4)."""
    for k in range(time.size):
        write_motion(system.reference, time[k], moved, observed[k])


@compiled
def static_deflections(
    table: PackedTables, flank: int, position: FloatArray, force: float, deflection: FloatArray
) -> None:
    """Write the table's deflection at `force` for every position into `deflection`, both (T,)."""
    for k in range(position.size):
        deflection[k] = table_deflection(table, flank, position[k], force)
