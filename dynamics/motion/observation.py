"""Observation of the elements and the laws at given states: positions, local coordinates, forces, speeds.

A law is a drive, or the free rotation of a train without a drive; quanta are the parts of a revolution by
which the rotation of a free train moved into the kinematic motion.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import row_product, subtract_columns, subtract_resistance
from dynamics.forces.elements import evaluate_all, has_unbalance, make_local
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.local_state import LocalState
from dynamics.meshes.packed_tables import PackedTables
from dynamics.meshes.table_lookup import table_deflection, wrapped
from dynamics.motion.local_accelerations import settle_unbalance
from dynamics.motion.motion import (
    MOTION_COLUMNS,
    add_body_motion,
    add_motion,
    external_force,
    set_drift,
    set_phases,
    write_motion,
)
from dynamics.types import FloatArray, IntArray


class Observed(NamedTuple):
    """Elements of m meshes with R rows at T times."""

    position: FloatArray
    """Base pitches in [0, period); then turns of frames against each other, revolutions in [0, 1). Shape (m +
    f, T).
    """
    coordinate: FloatArray
    force: FloatArray
    elastic: FloatArray
    """`coordinate`, `force`, `elastic`: Local coordinates, m, local forces, N, and what tables give of those
    of flanks, N, without damping. Shape (R, T) each.
    """


def observe(
    system: SystemArrays,
    time: FloatArray,
    q: FloatArray,
    v: FloatArray,
    quanta: IntArray | None = None,
    carried: FloatArray | None = None,
) -> Observed:
    """Return coordinates and forces of the elements at T states.

    `time` (T,), `q` and `v` (T, n); `quanta` (T, k) counts those of free trains moved into the reference.
    Amplitudes of housings may be missing in `q` and `v` if there is what is `carried` (see `States`).
    """
    local = make_local(system.elements, system.position_gradient.shape[0])
    return _look(system, local, time, quanta, q, v, carried)


def local_state(
    system: SystemArrays, time: float, q: FloatArray, v: FloatArray, quanta: IntArray | None = None
) -> LocalState:
    """Return coordinates, forces and derivatives of the elements in the state `q`, `v` (n,) at `time`."""
    local = make_local(system.elements, system.position_gradient.shape[0])
    counted = None if quanta is None else quanta[np.newaxis]
    _look(system, local, np.array([time]), counted, q[np.newaxis], v[np.newaxis])
    return local


def _look(
    system: SystemArrays,
    local: LocalState,
    time: FloatArray,
    quanta: IntArray | None,
    q: FloatArray,
    v: FloatArray,
    carried: FloatArray | None = None,
) -> Observed:
    """Observe T states, and leave the last one in `local`."""
    rows, laws = system.direction.shape[0], system.inertial.shape[0]
    meshes = system.position_gradient.shape[0]
    observed = Observed(*(np.empty((size, time.size)) for size in (meshes, rows, rows, rows)))
    counted = np.zeros((time.size, laws), dtype=np.int64) if quanta is None else quanta
    seats = np.empty((time.size, 0)) if carried is None else carried
    motion = np.empty((laws, MOTION_COLUMNS))
    scratch = np.empty((2, q.shape[1]))
    into = scratch, by_address(observed)
    _observe(by_address(system), by_address(local), motion, time, counted, q, v, seats, *into)
    return observed


@compiled
def _observe(
    system: SystemArrays,
    local: LocalState,
    motion: FloatArray,
    time: FloatArray,
    quanta: IntArray,
    q: FloatArray,
    v: FloatArray,
    carried: FloatArray,
    scratch: FloatArray,
    observed: Observed,
) -> None:
    for k in range(time.size):
        write_motion(system.reference, time[k], quanta[k], motion)
        set_phases(system.reference, motion, local.position, local)
        set_drift(system.elements, time[k], motion, local)
        if carried.shape[1] > 0:
            add_body_motion(system, q[k], v[k], local.position, local.coordinate, local.rate)
            _set_carried(system.sparse.modal.row, carried[k], local)
        else:
            add_motion(system, q[k], v[k], local.position, local.coordinate, local.rate)
        evaluate_all(system.elements, local)
        if has_unbalance(system.elements):
            _settle(system, local, motion, time[k], q[k], v[k], scratch)
        for m in range(local.position.size):
            observed.position[m, k] = wrapped(local.position[m], float(system.reference.period[m]))
        for r in range(local.force.size):
            observed.coordinate[r, k], observed.force[r, k] = local.coordinate[r], local.force[r]
            observed.elastic[r, k] = local.elastic[r]


@inner
def _set_carried(row: IntArray, carried: FloatArray, local: LocalState) -> None:
    """Write coordinates and rates of the rows that modal freedoms move."""
    for r in range(row.size):
        local.coordinate[row[r]], local.rate[row[r]] = carried[r], carried[row.size + r]


@inner
def _settle(
    system: SystemArrays,
    local: LocalState,
    motion: FloatArray,
    time: float,
    q: FloatArray,
    v: FloatArray,
    scratch: FloatArray,
) -> None:
    """Let unbalances agree with the accelerations in this state; `scratch` is (2, n)."""
    external, acceleration = scratch[0], scratch[1]
    external_force(system, time, motion, external)
    subtract_columns(system.sparse.direction, local.force, external)
    subtract_resistance(system.sparse, q, v, external)
    mobility = system.sparse.mobility
    for i in range(q.size):
        acceleration[i] = row_product(mobility, mobility.weight, i, external)
    settle_unbalance(system, motion, local, external, acceleration)


def observe_laws(system: SystemArrays, time: FloatArray) -> FloatArray:
    """Return whole revolutions, fraction, speed (rad/s) and acceleration of every law, (4, k, T)."""
    laws = system.inertial.shape[0]
    observed = np.empty((time.size, laws, MOTION_COLUMNS))
    _observe_laws(by_address(system), time, np.zeros(laws, dtype=np.int64), observed)
    return np.ascontiguousarray(np.moveaxis(observed, (2, 1), (0, 1)))


@compiled
def _observe_laws(system: SystemArrays, time: FloatArray, quanta: IntArray, observed: FloatArray) -> None:
    """Write the motion of the laws into `observed` (T, k, 4)."""
    for k in range(time.size):
        write_motion(system.reference, time[k], quanta, observed[k])


@compiled
def static_deflections(
    table: PackedTables, flank: int, position: FloatArray, force: float, deflection: FloatArray
) -> None:
    """Write the table's deflection at `force` for every position into `deflection`, both (T,)."""
    for k in range(position.size):
        deflection[k] = table_deflection(table, flank, position[k], force)
