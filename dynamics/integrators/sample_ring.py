"""The state that samples the steps of a run: points seen by the anti-alias filter, and running figures."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import BearingForce, System
from dynamics.forces.elements import make_local
from dynamics.kernels.local_state import LocalState
from dynamics.meshes.packed_tables import PackedTables
from dynamics.motion.motion import MOTION_COLUMNS
from dynamics.types import FloatArray, IntArray


class Sampler(NamedTuple):
    """The filter and the series that sample the steps.

    Attributes
    ----------
    taps : (L,) array
        Weights of the anti-alias filter.
    factor : int
        Points of the inner grid per output sample.
    rate : float
        Points per second.
    static : PackedTables
        Tables of the static transmission error.
    nominal_force : (m,) array
        N.
    bearings : BearingForce
        Of the channels of a point.
    bodies : int
        Freedoms that are not modal.
    filtered : int
        Channels that the filter takes: without the amplitudes of modal freedoms where no output has them.
    """

    taps: FloatArray
    factor: int
    rate: float
    static: PackedTables
    nominal_force: FloatArray
    bearings: BearingForce
    bodies: int
    filtered: int


class Peaks(NamedTuple):
    """Figures of P signals over the inner grid: R local forces, then the forces at the supports.

    Attributes
    ----------
    last : (2, P) array
        Values at the point before the current one, and at that before it.
    now, largest, square : (P,) arrays
        Values; largest magnitude so far, by the parabola through three points; sum of squares.
    """

    last: FloatArray
    now: FloatArray
    largest: FloatArray
    square: FloatArray


class SampleRing(NamedTuple):
    """Points of the inner grid: L as the filter has taps, n freedoms, R local coordinates, m meshes, k laws.

    A point's C channels are the R local forces, q and v of all freedoms but the modal ones, the m static
    deflections, then q and v of the modal ones. Local coordinates are linear in q.

    Attributes
    ----------
    point : (L, C) array
        The last L points, in a ring.
    q, v, a : (n,) arrays
        Scratch: the state at a point, and accelerations.
    local : LocalState
        Of the elements there.
    motion : (k, 4) array
        Of the laws there.
    moved : (k,) int array
        Scratch: quanta of free trains before a step's end.
    peaks : Peaks
    removed, folded : (R,) arrays
        Sums over the output samples of the squares of what the filter took away from the local forces, and
        of their content near half the inner rate.
    high : (R,) array
        Scratch: that content at one output sample.
    """

    point: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    local: LocalState
    motion: FloatArray
    moved: IntArray
    peaks: Peaks
    removed: FloatArray
    folded: FloatArray
    high: FloatArray


def make_sampler(system: System) -> Sampler:
    """Gather what the compiled loop needs."""
    sampling = system.sampling
    static, nominal = system.flanks.static, system.flanks.nominal_force
    rows, n = system.arrays.direction.shape
    bodies, outputs = system.arrays.sparse.modal.first, system.scene.outputs
    column = _channels_of(rows, n, bodies, nominal.size)[system.bearing_map.column]
    bearings = system.bearing_map._replace(column=column)
    amplitudes = n - bodies if outputs.displacements or outputs.accelerations else 0
    filtered = rows + 2 * (bodies + amplitudes) + nominal.size
    rest = (bearings, bodies, filtered)
    return Sampler(sampling.filter_taps(), sampling.factor, sampling.inner_rate, static, nominal, *rest)


def _channels_of(rows: int, freedoms: int, bodies: int, meshes: int) -> IntArray:
    """Return the channels of R local forces, q (n,) and v (n,); `bodies` of the freedoms are not modal."""
    forces, own = np.arange(rows), np.arange(bodies)
    modal = np.arange(rows + 2 * bodies + meshes, rows + 2 * freedoms + meshes)
    q, v = np.split(modal, 2)
    return np.concatenate([forces, rows + own, q, rows + bodies + own, v])


def make_ring(arrays: SystemArrays, sampler: Sampler) -> SampleRing:
    """Allocate."""
    n, rows, laws = arrays.mass.shape[0], arrays.direction.shape[0], arrays.inertial.shape[0]
    channels = _channel_count(arrays, sampler)
    signals = rows + sampler.bearings.constant.size
    return SampleRing(
        np.zeros((sampler.taps.size, channels)),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        make_local(arrays.elements, arrays.turn.shape[0]),
        np.zeros((laws, MOTION_COLUMNS)),
        np.zeros(laws, dtype=np.int64),
        Peaks(np.zeros((2, signals)), *(np.zeros(signals) for _ in range(3))),
        np.zeros(rows),
        np.zeros(rows),
        np.zeros(rows),
    )


def _channel_count(arrays: SystemArrays, sampler: Sampler) -> int:
    rows, n = arrays.direction.shape
    return int(rows + 2 * n + sampler.nominal_force.size)
