"""Compiled samples of the steps: an inner grid, an anti-alias filter, peaks and what the filter took away.

At every point of the inner grid the step's polynomials give displacements and rates, and the force laws give
local forces. All of them are channels of a ring that holds as many points as the filter has taps. When the
ring's middle lies on the output grid, the filtered channels and the state in the middle are stored: the
output trails the integration by half the filter, and its delay is compensated.
"""

from __future__ import annotations

import math
from inspect import unwrap
from typing import NamedTuple

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import System
from dynamics.assembly.bearing_force import NO_SIGNALS, BearingForce
from dynamics.forces.elements import evaluate_all, has_unbalance, make_local
from dynamics.integrators.workspace import Count, Workspace
from dynamics.kernels.by_address import by_address, with_numbers
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.meshes.packed_tables import PackedTables
from dynamics.meshes.table_lookup import deflection_from, level_below
from dynamics.motion.local_accelerations import set_acceleration
from dynamics.motion.motion import (
    MOTION_COLUMNS,
    QUANTUM,
    add_motion,
    move_free_trains,
    set_drift,
    set_phases,
    write_motion,
)
from dynamics.motion.sampled_states import States
from dynamics.types import FloatArray, IntArray

HIGH_PASS = np.array([1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0]) / 64.0
"""Sixth difference: 1 at half the rate, sin^6 below."""

THIRD = 1.0 / 3.0


@with_numbers("level", "modal_samples")
class Sampler(NamedTuple):
    """The filter and the series that sample the steps."""

    taps: FloatArray
    """Weights of the anti-alias filter. Shape (L,)."""
    high_pass: FloatArray
    """Weights of a filter that passes the content near half the inner rate. Shape (7,)."""
    factor: int
    """Points of the inner grid per output sample."""
    rate: float
    """Points of the inner grid per second."""
    static: PackedTables
    """Tables of the static transmission error."""
    nominal_force: FloatArray
    """Nominal mesh forces, N. Shape (m,)."""
    level: IntArray
    """Level intervals of these forces in the tables. Shape (m,)."""
    bearings: BearingForce
    """Bearing forces from the channels of a point; without signals where no output holds bearing forces."""
    bodies: int
    """Number of freedoms that are not modal."""
    freedoms: int
    """Freedoms that samples have: all, or without the amplitudes of housings where nothing asks for them."""
    filtered: int
    """Channels that the filter takes: without the amplitudes of modal freedoms where no output has them."""
    modal_samples: IntArray
    """Samples of which the amplitudes are kept in any case. Shape (W,)."""

    @classmethod
    def of(cls, system: System, modal_samples: IntArray) -> Sampler:
        """Gather the arrays that the compiled loop needs."""
        sampling = system.sampling
        static, nominal = system.flanks.static, system.flanks.nominal_force
        rows, n = system.arrays.direction.shape
        bodies, outputs = system.arrays.sparse.modal.first, system.scene.outputs
        body, modal, first = (
            np.arange(bodies),
            np.arange(n - bodies),
            rows + 2 * bodies + nominal.size,
        )
        q, v = first + modal, first + modal.size + modal
        channels = np.concatenate([np.arange(rows), rows + body, q, rows + bodies + body, v])
        signals = system.bearing_map if outputs.bearing_forces else NO_SIGNALS
        bearings = signals._replace(column=channels[signals.column])
        all_coordinates = outputs.displacements or outputs.accelerations
        filtered = rows + 2 * (n if all_coordinates else bodies) + nominal.size
        displacements = n if all_coordinates or not _dispensable(system) else bodies
        level = [level_below(by_address(static), m, float(force)) for m, force in enumerate(nominal)]
        rest = (np.array(level, dtype=np.int64), bearings, bodies, displacements, filtered, modal_samples)
        taps, rate = sampling.filter_taps(), sampling.inner_rate
        return cls(taps, HIGH_PASS, sampling.factor, rate, static, nominal, *rest)


def _dispensable(system: System) -> bool:
    """Return whether samples do without modal freedoms: they are of housings, and no law accelerates."""
    columns = system.freedoms.column[system.arrays.sparse.modal.first :]
    unbalanced = unwrap(has_unbalance)(system.arrays.elements)  # as Python: not compiled for this alone
    return bool(np.all(columns >= system.rotors.first_of_housings)) and not unbalanced


class _Peaks(NamedTuple):
    """Figures of P signals over the inner grid: R local forces, then the forces at the supports."""

    last: FloatArray
    """Values at the three points before the current one, the nearest first; NaN before the start. Shape (3,
    P).
    """
    now: FloatArray
    largest: FloatArray
    square: FloatArray
    """`now`, `largest`, `square`: Values; largest magnitude so far, by the cubic through four points; sum of
    squares. Shape (P,) each.
    """


class SampleRing(NamedTuple):
    """Points of the inner grid: L as the filter has taps, n freedoms, R local coordinates, m meshes, k laws.

    A point's C channels are the R local forces, q and v of all freedoms but the modal ones, the m static
    deflections, then q and v of the modal ones, or what they carry (see `States`). Local coordinates are
    linear in q.
    """

    point: FloatArray
    """The last L points, in a ring. Shape (L, C)."""
    q: FloatArray
    v: FloatArray
    a: FloatArray
    """`q`, `v`, `a`: Scratch: the state at a point, and accelerations. Shape (n,) each."""
    local: LocalState
    """State of the force elements at a point."""
    motion: FloatArray
    """Motion of the laws at a point. Shape (k, 4)."""
    quanta: IntArray
    """Scratch: quanta of free trains before a step's end. Shape (k,)."""
    peaks: _Peaks
    removed: FloatArray
    folded: FloatArray
    """`removed`, `folded`: Sums over the output samples of the squares of the part of the local forces that
    the filter removes, and of their content near half the inner rate. Shape (R,) each.
    """
    high: FloatArray
    """Scratch: that content at one output sample. Shape (R,)."""
    modal_states: FloatArray
    """q and v of the b modal freedoms at the samples ``Sampler.modal_samples``. Shape (W, 2, b)."""

    @classmethod
    def of(cls, arrays: SystemArrays, sampler: Sampler) -> SampleRing:
        """Allocate."""
        n, rows, laws = arrays.mass.shape[0], arrays.direction.shape[0], arrays.inertial.shape[0]
        channels = int(rows + 2 * sampler.freedoms + sampler.nominal_force.size)
        channels += carried_signals(arrays, sampler)
        signals = rows + sampler.bearings.constant.size
        return cls(
            point=np.zeros((sampler.taps.size, channels)),
            q=np.zeros(n),
            v=np.zeros(n),
            a=np.zeros(n),
            local=make_local(arrays.elements, arrays.position_gradient.shape[0]),
            motion=np.zeros((laws, MOTION_COLUMNS)),
            quanta=np.zeros(laws, dtype=np.int64),
            peaks=_Peaks(np.full((3, signals), np.nan), *(np.zeros(signals) for _ in range(3))),
            removed=np.zeros(rows),
            folded=np.zeros(rows),
            high=np.zeros(rows),
            modal_states=np.zeros((sampler.modal_samples.size, 2, n - sampler.bodies)),
        )


def carried_signals(arrays: SystemArrays, sampler: Sampler) -> int:
    """Return the number of signals that a sample has in place of amplitudes, 2 s of `States`."""
    return 0 if sampler.freedoms == arrays.mass.shape[0] else 2 * arrays.sparse.modal.row.size


@routine
def sample_step(
    system: SystemArrays,
    work: Workspace,
    sampler: Sampler,
    ring: SampleRing,
    step: float,
    end: float,
    out: States,
) -> None:
    """Take the inner points of the step from ``work.time`` to `end`; a step that ends at 0 has that point."""
    counts = work.counts
    while counts[Count.POINT] / sampler.rate <= end:
        point = counts[Count.POINT]
        time = point / sampler.rate
        row = point % sampler.taps.size
        _interpolate(work, ring, step, time - work.time[0], has_unbalance(system.elements))
        _look(system, work, sampler, ring, time, row)
        _store_modal_states(sampler, ring, point)
        if point <= sampler.taps.size // 2:
            _mirror(ring, 0, point, -point)
        _see_peaks(ring, sampler, row)
        counts[Count.POINT] = point + 1
        store_if_due(work, sampler, ring, point, out)


@compiled
def continue_past_the_end(
    work: Workspace, sampler: Sampler, ring: SampleRing, points: int, out: States
) -> None:
    """Add `points` points, the motion before the last one turned about it."""
    counts = work.counts
    last = counts[Count.POINT] - 1
    for ahead in range(1, points + 1):
        _mirror(ring, last, max(last - ahead, 0), last + ahead)
        if last + ahead <= points:
            _mirror(ring, 0, last + ahead, -last - ahead)
        counts[Count.POINT] += 1
        store_if_due(work, sampler, ring, last + ahead, out)


@inner
def _mirror(ring: SampleRing, center: int, source: int, target: int) -> None:
    """Write the point `source`, turned about the point `center`, to `target`: values and trends go on."""
    size = ring.point.shape[0]
    middle, origin, at = center % size, source % size, target % size
    for c in range(ring.point.shape[1]):
        ring.point[at, c] = 2.0 * ring.point[middle, c] - ring.point[origin, c]


@inner
def move_sampled_trains(system: SystemArrays, work: Workspace, ring: SampleRing) -> None:
    """Move the own rotation of free trains into the reference, in the state and in the ring alike."""
    for k in range(work.quanta.size):
        ring.quanta[k] = work.quanta[k]
    move_free_trains(system.reference, work.quanta, work.q)
    first = ring.local.force.size
    for k in range(work.quanta.size):
        count = work.quanta[k] - ring.quanta[k]
        if count == 0:
            continue
        for row in range(ring.point.shape[0]):
            for i in range(system.sparse.modal.first):
                ring.point[row, first + i] -= system.reference.vector[k, i] * (count * QUANTUM)


@inner
def _interpolate(work: Workspace, ring: SampleRing, step: float, elapsed: float, accelerations: bool) -> None:
    """Cubic Hermite interpolation of displacements (with rates) and of rates (with accelerations).

    Where laws depend on `accelerations`, these are the derivative of the latter.
    """
    u = elapsed / step
    end = u * u * (3.0 - 2.0 * u)
    first, last = step * u * (1.0 - u) ** 2, -step * u * u * (1.0 - u)
    q, v = ring.q, ring.v
    if accelerations:
        slope = 6.0 * u * (1.0 - u) / step
        for i in range(q.size):
            ring.a[i] = slope * (work.v_new[i] - work.v[i])
            ring.a[i] += (1.0 - u) * (1.0 - 3.0 * u) * work.a[i] + u * (3.0 * u - 2.0) * work.a_new[i]
    for i in range(q.size):
        q[i] = work.q[i] + end * (work.q_new[i] - work.q[i]) + first * work.v[i] + last * work.v_new[i]
        v[i] = work.v[i] + end * (work.v_new[i] - work.v[i]) + first * work.a[i] + last * work.a_new[i]


@inner
def _look(
    system: SystemArrays, work: Workspace, sampler: Sampler, ring: SampleRing, time: float, row: int
) -> None:
    """Write the channels of the state in the ring's `q` and `v` at `time` into its point `row`."""
    local, q, v = ring.local, ring.q, ring.v
    write_motion(system.reference, time, work.quanta, ring.motion)
    set_phases(system.reference, ring.motion, local.position, local)
    set_drift(system.elements, time, ring.motion, local)
    add_motion(system, q, v, local.position, local.coordinate, local.rate)
    if has_unbalance(system.elements):
        set_acceleration(system, ring.motion, ring.a, local.acceleration)
    evaluate_all(system.elements, local)
    rows, n, point = local.force.size, sampler.bodies, ring.point[row]
    modes, meshes = q.size - n, sampler.nominal_force.size
    for r in range(rows):
        point[r] = local.force[r]
    for i in range(n):
        point[rows + i], point[rows + n + i] = q[i], v[i]
    for m in range(meshes):
        force, level = sampler.nominal_force[m], sampler.level[m]
        point[rows + 2 * n + m] = deflection_from(sampler.static, m, local.position[m], force, level)
    first = rows + 2 * n + meshes
    if sampler.freedoms > n:
        for i in range(modes):
            point[first + i], point[first + modes + i] = q[n + i], v[n + i]
        return
    carried = system.sparse.modal.row
    for r in range(carried.size):
        point[first + r] = local.coordinate[carried[r]]
        point[first + carried.size + r] = local.rate[carried[r]]


@inner
def _store_modal_states(sampler: Sampler, ring: SampleRing, point: int) -> None:
    """Keep the amplitudes at `point` if it is a sample that needs them."""
    first, modes = np.uint64(sampler.bodies), np.uint64(ring.modal_states.shape[2])
    for w in range(sampler.modal_samples.size):
        if sampler.modal_samples[w] * sampler.factor == point:
            for i in range(modes):
                ring.modal_states[w, 0, i], ring.modal_states[w, 1, i] = ring.q[first + i], ring.v[first + i]


@inner
def _see_peaks(ring: SampleRing, sampler: Sampler, row: int) -> None:
    """Add the point `row` to the running figures; a peak lies between the middle two of four points."""
    rows, point, peaks, bearings = ring.local.force.size, ring.point, ring.peaks, sampler.bearings
    for r in range(rows):
        peaks.now[r] = point[row, r]
    for s in range(bearings.constant.size):
        force = bearings.constant[s]
        for entry in range(bearings.first[s], bearings.first[s + 1]):
            force += bearings.weight[entry] * point[row, bearings.column[entry]]
        peaks.now[rows + s] = force
    for p in range(peaks.now.size):
        now, right, left, far = peaks.now[p], peaks.last[0, p], peaks.last[1, p], peaks.last[2, p]
        peaks.largest[p] = max(peaks.largest[p], abs(now), _between(far, left, right, now))
        peaks.square[p] += now * now
        peaks.last[2, p], peaks.last[1, p], peaks.last[0, p] = left, right, now


@inner
def _between(far: float, left: float, right: float, now: float) -> float:
    """Return the magnitude of the cubic through four points where it turns between the middle two, else 0.

    It is left + a u + b u^2 + c u^3, u from 0 to 1; one root of the slope lies there if the slope changes
    its sign. NaN has none.
    """
    a = right - 0.5 * left - (far + 0.5 * now) * THIRD
    b = 0.5 * (far + right) - left
    c = 0.5 * (left - right + (now - far) * THIRD)
    if not a * (a + 2.0 * b + 3.0 * c) < 0.0:
        return 0.0
    u = abs(a) / (math.sqrt(b * b - 3.0 * a * c) - math.copysign(b, a * b))
    return abs(left + u * (a + u * (b + u * c)))


@routine
def store_if_due(work: Workspace, sampler: Sampler, ring: SampleRing, point: int, out: States) -> None:
    """Store the output sample in the middle of the ring if there is one."""
    counts = work.counts
    middle = point - sampler.taps.size // 2
    row = counts[Count.OUTPUT] - counts[Count.FIRST_ROW]
    if middle < 0 or middle % sampler.factor != 0 or row >= out.q.shape[0]:
        return
    taps = sampler.taps.size
    center = middle % taps
    _filter(ring, sampler.taps, center, out.filtered[row])
    rows, n = ring.local.force.size, sampler.bodies
    for i in range(n):
        out.q[row, i], out.v[row, i] = ring.point[center, rows + i], ring.point[center, rows + n + i]
    first, modes = rows + 2 * n + sampler.nominal_force.size, sampler.freedoms - n
    for i in range(modes):
        out.q[row, n + i] = ring.point[center, first + i]
        out.v[row, n + i] = ring.point[center, first + modes + i]
    for r in range(out.carried.shape[1]):
        out.carried[row, r] = ring.point[center, first + r]
    for k in range(work.quanta.size):
        out.quanta[row, k] = work.quanta[k]
    _see_extremes(ring, sampler.factor, center, out, row)
    _see_removed(ring, sampler.high_pass, center, point, out, row)
    counts[Count.OUTPUT] += 1


@inner
def _see_extremes(ring: SampleRing, factor: int, center: int, out: States, row: int) -> None:
    """Store least and largest local forces over the points nearest to the output sample."""
    taps = ring.point.shape[0]
    half = min((factor + 1) // 2, taps // 2)
    minimum, largest = out.minimum[row], out.largest[row]
    for r in range(minimum.size):
        minimum[r], largest[r] = ring.point[center, r], ring.point[center, r]
    for step in range(-half, half + 1):
        near = ring.point[(center + step) % taps]
        for r in range(minimum.size):
            minimum[r], largest[r] = min(minimum[r], near[r]), max(largest[r], near[r])


@inner
def _see_removed(
    ring: SampleRing, high_pass: FloatArray, center: int, point: int, out: States, row: int
) -> None:
    """Add up the squares of the part that the filter removes, and of the content near half the inner rate."""
    taps, high = ring.point.shape[0], ring.high
    for r in range(high.size):
        removed = ring.point[center, r] - out.filtered[row, r]
        ring.removed[r] += removed * removed
    if point < taps:
        return
    _filter(ring, high_pass, (point - high_pass.size // 2) % taps, high)
    for r in range(high.size):
        ring.folded[r] += high[r] * high[r]


@inner
def _filter(ring: SampleRing, taps: FloatArray, center: int, out: FloatArray) -> None:
    """Write the first channels, weighted by the symmetric `taps` about the point `center`, into `out`.

    Two pairs of points at a time: `out` is read and written half as often as once a pair.
    """
    half, size, point = taps.size // 2, ring.point.shape[0], ring.point
    middle = point[center]
    for c in range(out.size):
        out[c] = taps[half] * middle[c]
    for t in range(1, half + 1, 2):
        far = min(t + 1, half)
        weight, far_weight = taps[half - t], taps[half - far] if far > t else 0.0
        before, after = point[_wrapped(center - t, size)], point[_wrapped(center + t, size)]
        first, last = point[_wrapped(center - far, size)], point[_wrapped(center + far, size)]
        for c in range(out.size):
            out[c] += weight * (before[c] + after[c]) + far_weight * (first[c] + last[c])


@inner
def _wrapped(index: int, size: int) -> int:
    """Return the row of a point at most one turn of the ring outside it."""
    if index < 0:
        return index + size
    return index - size if index >= size else index
