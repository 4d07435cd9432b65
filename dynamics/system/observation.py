"""Compiled observation of the flanks at given states: position, transmission error, force."""

from __future__ import annotations

from dynamics.forces.compiled import compiled
from dynamics.forces.flank_force import flank_force
from dynamics.forces.packed_tables import PackedTables
from dynamics.forces.table_lookup import table_deflection, wrapped
from dynamics.system.arrays import SystemArrays
from dynamics.system.motion import drive_motion, flank_phase
from dynamics.types import FloatArray


@compiled
def observe_flanks(
    system: SystemArrays, time: FloatArray, q: FloatArray, v: FloatArray, observed: FloatArray
) -> None:
    """Write position, transmission error and force of every flank at every time into `observed` (3, m, T)."""
    for k in range(time.size):
        whole, fraction, _, _ = drive_motion(system.reference, time[k])
        for f in range(system.drive_direction.size):
            position = flank_phase(system.reference, f, whole, fraction)
            deflection, rate = 0.0, 0.0
            for i in range(q.shape[1]):
                position += system.turn[f, i] * q[k, i]
                deflection += system.direction[f, i] * q[k, i]
                rate += system.direction[f, i] * v[k, i]
            observed[0, f, k] = wrapped(position, float(system.reference.period[f]))
            observed[1, f, k] = deflection
            observed[2, f, k] = flank_force(system.flank, f, position, deflection, rate, 0)[0]


@compiled
def observe_drive(system: SystemArrays, time: FloatArray, observed: FloatArray) -> None:
    """Write whole revolutions, fraction, speed (rad/s) and acceleration (rad/s^2) into `observed` (4, T)."""
    for k in range(time.size):
        whole, fraction, speed, acceleration = drive_motion(system.reference, time[k])
        observed[0, k], observed[1, k] = whole, fraction
        observed[2, k], observed[3, k] = speed, acceleration


@compiled
def static_deflections(
    table: PackedTables, flank: int, position: FloatArray, force: float, deflection: FloatArray
) -> None:
    """Write the table's deflection at `force` for every position into `deflection`, both (T,)."""
    for k in range(position.size):
        deflection[k] = table_deflection(table, flank, position[k], force)
