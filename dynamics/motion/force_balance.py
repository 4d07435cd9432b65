"""All forces in one state and their derivatives, and loads at their means, from which statics starts.

Shapes: n freedoms, R rows of local coordinates of all elements, P rows of the largest element, m meshes, f
frames. G (R, n) is `SystemArrays.direction`: local coordinates by freedoms.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.elements import Elements
from dynamics.forces.laws import Law, among
from dynamics.kernels.local_state import LocalState
from dynamics.motion.observation import local_state
from dynamics.types import FloatArray

LOADS = (Law.SPEED_TORQUE, Law.APPLIED_FORCE)


@dataclass(frozen=True)
class ForceBalance:
    """Forces on n freedoms in a state (q, v) at a time, without inertia."""

    force: FloatArray
    """Accelerating force, M q'' = external - C v - K q - G^T f, N and N m. Shape (n,)."""
    stiffness: FloatArray
    damping: FloatArray
    """`stiffness`, `damping`: K + G^T (df/dy) G and C + G^T (df/dy') G: minus the derivatives of `force` in q
    and v. The change of forces with the meshes' positions is left out: it is of the order of a deflection
    over a base pitch. Shape (n, n) each.
    """
    local: LocalState
    """State of the force elements."""


def force_balance(
    arrays: SystemArrays,
    time: float,
    q: FloatArray,
    v: FloatArray,
    external: FloatArray,
    gyroscopic: bool = True,
) -> ForceBalance:
    """Return the balance of `external` (n,), supports and elements in the state `q`, `v` (n,) at `time`.

    Without `gyroscopic` the derivatives leave out gyroscopic, Coriolis and centripetal terms, and the part of
    dampers across frames from the rotation of these.
    """
    local = local_state(arrays, time, q, v)
    force = external - arrays.damping @ v - arrays.stiffness @ q - local.force @ arrays.direction
    rows = np.repeat(arrays.elements.law == Law.ROTATING_FRAME, np.diff(arrays.elements.first))
    weight = np.where(rows & (not gyroscopic), 0.0, 1.0)[:, None]
    tangent = weight * local.tangent
    if not gyroscopic:
        tangent = tangent - swept_by_frames(arrays.elements, local, local.pace)
    return ForceBalance(
        force,
        arrays.stiffness + _on_freedoms(arrays, tangent),
        arrays.damping + _on_freedoms(arrays, weight * local.viscous),
        local,
    )


def swept_by_frames(elements: Elements, local: LocalState, pace: FloatArray) -> FloatArray:
    """Return the part of the tangents (R, P) that dampers across frames have from the rotation of these.

    A coupling has n rows a in its first and n rows b in its second frame. The second frame turns at psi'
    against the first by the rotation R, and with it b, which subtracts psi' J R b (J a quarter turn) from the
    rate of the strain. `pace` (m + f,): revolutions per second of the frames behind the paces of the meshes.
    """
    swept = np.zeros_like(local.tangent)
    for e in np.flatnonzero(elements.law == Law.FRAME_COUPLING):
        rows = slice(elements.first[e], elements.first[e + 1])
        n = (rows.stop - rows.start) // 2
        quarter = np.kron(np.eye(n // 2), [[0.0, -1.0], [1.0, 0.0]])
        angular_speed = 2.0 * np.pi * pace[elements.mesh[e]]
        swept[rows, n : 2 * n] = angular_speed * local.viscous[rows, n : 2 * n] @ quarter
    return swept


def _on_freedoms(arrays: SystemArrays, derivative: FloatArray) -> FloatArray:
    """Return G^T D G with D the elements' blocks in `derivative` (R, P)."""
    return np.asarray(arrays.direction.T @ block_diagonal(arrays.elements, derivative) @ arrays.direction)


def block_diagonal(elements: Elements, derivative: FloatArray) -> FloatArray:
    """Return the (R, R) matrix of the elements' square blocks; `derivative` (R, P) has their rows."""
    rows = elements.offset.size
    matrix = np.zeros((rows, rows))
    for first, end in zip(elements.first[:-1], elements.first[1:], strict=True):
        matrix[first:end, first:end] = derivative[first:end, : end - first]
    return matrix


def at_mean_loads(arrays: SystemArrays) -> SystemArrays:
    """Return `arrays` with the mean over a revolution of every load that changes with an angle.

    The mean of an unbalance, whose force and weight turn, is zero.
    """
    laws = arrays.elements.laws
    if laws.applied_force.size.size + laws.unbalance.amount.size == 0:
        return arrays
    steady = np.ones(1, dtype=np.bool_)
    mean = laws._replace(
        applied_force=laws.applied_force._replace(steady=steady),
        unbalance=laws.unbalance._replace(steady=steady),
    )
    return arrays._replace(elements=arrays.elements._replace(laws=mean))


def mean_loads(arrays: SystemArrays, time: float) -> FloatArray:
    """Return the mean forces (n,) of loads over a revolution, at the kinematic speeds at `time`."""
    rest, loads = np.zeros(arrays.mass.shape[0]), among(arrays.elements.law, LOADS)
    if not np.any(loads):
        return rest
    local = local_state(at_mean_loads(arrays), time, rest, rest)
    rows = np.repeat(loads, np.diff(arrays.elements.first))
    return np.asarray(-local.force[rows] @ arrays.direction[rows])


def stiffness_across(arrays: SystemArrays, time: float) -> FloatArray:
    """Return the stiffness (n, n) of all couplings across frames, at their angles at `time`."""
    elements, n = arrays.elements, arrays.mass.shape[0]
    stiffness, crossing = np.zeros((n, n)), np.flatnonzero(elements.law == Law.FRAME_COUPLING)
    if crossing.size:
        tangent = local_state(arrays, time, np.zeros(n), np.zeros(n)).tangent
        for e in crossing:
            rows = slice(elements.first[e], elements.first[e + 1])
            direction = arrays.direction[rows]
            stiffness += direction.T @ tangent[rows, : direction.shape[0]] @ direction
    return stiffness
