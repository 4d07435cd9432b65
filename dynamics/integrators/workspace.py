"""Arrays that a run carries from step to step, allocated once.

A stage is an instant within a step at which a Runge-Kutta method evaluates forces. A level is one of the
geometric step sizes.
"""

from __future__ import annotations

from inspect import unwrap
from typing import NamedTuple

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.elements import Elements, is_linear, make_local
from dynamics.kernels.local_state import LocalState
from dynamics.motion.motion import MOTION_COLUMNS
from dynamics.types import BoolArray, FloatArray, IntArray

STAGES = 7  # stages of the method with the most of them
LEVELS_PER_OCTAVE = 4  # step sizes to a factor of 2
_PER_FREEDOM = ("v", "v_rest", "a", "q_new", "v_new", "a_new", "q_error", "v_error", "external", "unloaded")
_PER_ROW = ("force", "free", "free_rate", "free_acceleration", "update", "correction")


class _Powers(NamedTuple):
    """Columns of the powers, integrated to works over the run."""

    DRIVE: int = 0  # supplied by the drive
    LOAD: int = 1  # supplied by the load torques (negative: they resist)
    POSITION: int = 2  # supplied by the table's change with position
    BUSHING: int = 3  # dissipated in bushings
    MESH: int = 4  # dissipated in meshes
    AXES: int = 5  # supplied by the tables' change with misalignment and center distance
    FRICTION: int = 6  # dissipated by sliding flanks


class _Counts(NamedTuple):
    """Entries of the step statistics."""

    LEVEL: int = 0  # level of the current step size
    OUTPUT: int = 1  # next output sample
    ACCEPTED: int = 2
    REJECTED: int = 3
    NEWTON_TOTAL: int = 4
    MAX_NEWTON: int = 5  # most Newton iterations in one stage
    NEWTON_FAILED: int = 6  # steps repeated because Newton failed
    SMALLEST_LEVEL: int = 7  # smallest level of an accepted step: the largest step
    LARGEST_LEVEL: int = 8
    FIRST_ROW: int = 9  # output sample that the first row of the output arrays is for
    POINT: int = 10  # next point of the inner grid


# tuples, not enumerations: numba before 0.68 indexes no array by a member of an enumeration
Power, Count = _Powers(), _Counts()
LOSSES = (Power.BUSHING, Power.MESH, Power.FRICTION)
"""Columns that only grow: dissipated energy does not come back."""


class Workspace(NamedTuple):
    """State and scratch of a run with n freedoms, m meshes and R local coordinates of elements.

    The step sizes are geometric, LEVELS_PER_OCTAVE to a factor of 2, so that the matrices of the
    implicit stages are inverted once per level and run. L = entries of ``SparseMatrices.coupling``.
    """

    time: FloatArray
    time_rest: FloatArray
    error: FloatArray
    """`time`, `time_rest`, `error`: Current time and its rounding, s; error of the last accepted step over
    the tolerance. Shape (1,) each.
    """
    q: FloatArray
    v: FloatArray
    v_rest: FloatArray
    a: FloatArray
    """`q`, `v`, `v_rest`, `a`: State at `time`: deviations from the kinematic motion, their rates, the
    rounding of these, and accelerations. Shape (n,) each.
    """
    q_new: FloatArray
    v_new: FloatArray
    a_new: FloatArray
    q_error: FloatArray
    v_error: FloatArray
    """`q_new`, `v_new`, `a_new`, `q_error`, `v_error`: State and its error at the end of the step tried.
    Shape (n,) each.
    """
    external: FloatArray
    unloaded: FloatArray
    """`external`, `unloaded`: Scratch: external force; acceleration without the elements' forces. Shape (n,)
    each.
    """
    stage_v: FloatArray
    stage_a: FloatArray
    """`stage_v`, `stage_a`: Rates and accelerations at the stages. Shape (STAGES, n) each."""
    force: FloatArray
    """Local forces at the current stage, as Newton's method found them, N. Shape (R,)."""
    local: LocalState
    """State of the force elements at the current stage."""
    free: FloatArray
    free_rate: FloatArray
    free_acceleration: FloatArray
    """`free`, `free_rate`, `free_acceleration`: Local coordinates, their rates and accelerations without the
    elements' forces. Shape (R,) each.
    """
    free_position: FloatArray
    """Positions without the elements' forces. Shape (m,)."""
    linear: IntArray
    """The p rows of linear elements. Columns: the row; then first and end, in this list, of the rows of its
    element. Shape (p, 3).
    """
    resting: FloatArray
    """Scratch: coordinates, then rates, of the rows `linear` without any local force. Shape (2 p,)."""
    response: FloatArray
    """Accelerations of coordinates and positions by the local forces in `force`. Shape (R + m,)."""
    motion: FloatArray
    """Motion of the laws at the current stage. Shape (k, 4)."""
    speed: FloatArray
    """Speeds of the laws at the start of the step, rad/s, for the energy balance. Shape (k,)."""
    quanta: IntArray
    """Rotation of each free train that was moved from `q` into the reference motion, in quanta of a
    revolution. Shape (k,).
    """
    update: FloatArray
    correction: FloatArray
    """`update`, `correction`: Scratch of Newton's method, N. Shape (R,) each."""
    solved: IntArray
    """Rows that Newton's method solves for in the current step, ended by -1. Shape (R + 1,)."""
    jacobian: FloatArray
    """Newton's matrix in the rows `solved`, transposed, and beside it the inverse. Shape (R, 2 R)."""
    power: FloatArray
    """Powers at each stage, W; columns `Power`. Shape (STAGES, 7)."""
    work: FloatArray
    """Works so far, J, in the order of `Power`. Shape (7,)."""
    highest: FloatArray
    fallen: FloatArray
    """`highest`, `fallen`: Highest work of each of `LOSSES` so far, and its largest fall below the highest
    one before, J: an error, since dissipated energy does not come back. Shape (3,) each.
    """
    counts: IntArray
    """Counts of steps and samples, in the order of `Count`."""
    step_sizes: FloatArray
    """Step sizes, falling, s; the last entry is for a step that ends at a knot of a law. Shape (r,)."""
    matrix: FloatArray
    """Scratch: the matrix to invert, of the freedoms that are not modal. Shape (a, a)."""
    ready: BoolArray
    """Whether the matrices of a level are computed. Shape (r,)."""
    inverse: FloatArray
    """Entries of the inverse of M + h g C + (h g)^2 K, with the step h and the method's diagonal coefficient
    g. Shape (r, L).
    """
    approach: FloatArray
    """Accelerations of local coordinates, then of positions, per local force; linear elements follow, so that
    their own rows are 0. Shape (r, R, R + m).
    """
    linear_response: FloatArray
    """Accelerations by the linear elements, per coordinate and per rate of their rows without local forces.
    Shape (r, R + m, 2 p).
    """

    @classmethod
    def of(cls, system: SystemArrays, step_sizes: FloatArray, q: FloatArray, first_step: float) -> Workspace:
        """Allocate for a run that starts at t = 0 at rest in the displacements `q` (n,)."""
        rows, laws = system.direction.shape[0], system.inertial.shape[0]
        meshes = system.position_gradient.shape[0]
        linear, bodies = _linear_rows(system.elements), system.sparse.modal.first
        return cls(
            time=np.zeros(1),
            time_rest=np.zeros(1),
            error=np.ones(1),
            q=np.array(q, dtype=float),
            **{name: np.zeros(q.size) for name in _PER_FREEDOM},
            **{name: np.zeros((STAGES, q.size)) for name in ("stage_v", "stage_a")},
            **{name: np.zeros(rows) for name in _PER_ROW},
            solved=np.full(rows + 1, -1, dtype=np.int64),
            jacobian=np.zeros((rows, 2 * rows)),
            local=make_local(system.elements, meshes),
            free_position=np.zeros(meshes),
            linear=linear,
            resting=np.zeros(2 * len(linear)),
            response=np.zeros(rows + meshes),
            motion=np.zeros((laws, MOTION_COLUMNS)),
            speed=np.zeros(laws),
            quanta=np.zeros(laws, dtype=np.int64),
            power=np.zeros((STAGES, len(Power))),
            work=np.zeros(len(Power)),
            highest=np.zeros(len(LOSSES)),
            fallen=np.zeros(len(LOSSES)),
            counts=_counts(step_sizes, first_step),
            step_sizes=step_sizes,
            matrix=np.zeros((bodies, bodies)),
            ready=np.zeros(step_sizes.size, dtype=np.bool_),
            inverse=np.zeros((step_sizes.size, system.sparse.coupling.column.size)),
            approach=np.zeros((step_sizes.size, rows, rows + meshes)),
            linear_response=np.zeros((step_sizes.size, rows + meshes, 2 * len(linear))),
        )


def geometric_steps(largest: float, smallest: float) -> FloatArray:
    """Return step sizes falling from `largest` to at most `smallest` by equal factors, and one more entry.

    See ``Workspace.step_sizes``.
    """
    levels = int(np.ceil(LEVELS_PER_OCTAVE * np.log2(largest / smallest))) + 1
    return np.append(largest * 2.0 ** (-np.arange(levels) / LEVELS_PER_OCTAVE), 0.0)


def _counts(step_sizes: FloatArray, first_step: float) -> IntArray:
    counts = np.zeros(len(Count), dtype=np.int64)
    levels = step_sizes.size
    counts[Count.LEVEL] = min(int(np.searchsorted(-step_sizes, -first_step)), levels - 2)
    counts[Count.SMALLEST_LEVEL] = levels - 1
    return counts


def _linear_rows(elements: Elements) -> IntArray:
    rows: list[tuple[int, int, int]] = []
    linear = unwrap(is_linear)  # as Python: not compiled for this alone
    for e in range(elements.law.size):
        if linear(elements, e):
            first, count = int(elements.first[e]), int(elements.first[e + 1] - elements.first[e])
            start = len(rows)
            rows += [(first + k, start, start + count) for k in range(count)]
    return np.array(rows, dtype=np.int64).reshape(-1, 3)
