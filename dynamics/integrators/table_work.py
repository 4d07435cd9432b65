"""Compiled work that mesh tables supply as they move on, integrated along the path of one step."""

from __future__ import annotations

import math

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.compiled import inner
from dynamics.forces.element_laws import FLANK, SPATIAL_FLANK, Elements
from dynamics.forces.local_state import LocalState
from dynamics.forces.packed_tables import BUCKETS_PER_KNOT, PackedTables
from dynamics.forces.routine import routine
from dynamics.forces.spatial_flank import spatial_energy
from dynamics.forces.table_energy import table_energy
from dynamics.forces.table_lookup import position_interval
from dynamics.integrators.workspace import Power, StepEnd, Workspace
from dynamics.motion.motion import SPEED

GAUSS = (0.5 - 0.5 / math.sqrt(3.0), 0.5 + 0.5 / math.sqrt(3.0))  # points of order 4, equal weights
Path = tuple[float, float, float, float]  # value and rate times the step at both ends


@inner
def keep_motion(system: SystemArrays, work: Workspace, end: StepEnd) -> None:
    """Write the motion in ``work.local``, whose rates are ``work.v_new``, into one end of a step."""
    for m in range(work.local.position.size):
        end.position[m], end.pace[m] = work.local.position[m], work.local.pace[m]
        for i in range(system.sparse.modal.first):
            end.pace[m] += system.turn[m, i] * work.v_new[i]
    for r in range(work.local.coordinate.size):
        end.coordinate[r], end.rate[r] = work.local.coordinate[r], work.local.rate[r]
    for k in range(work.motion.shape[0]):
        end.speed[k] = work.motion[k, SPEED]


@inner
def _start_at_the_end(work: Workspace) -> None:
    """Make the end of a step the start of the next one, and put ``work.local`` back there."""
    for m in range(work.local.position.size):
        work.before.position[m], work.before.pace[m] = work.after.position[m], work.after.pace[m]
        work.local.position[m] = work.after.position[m]
    for r in range(work.local.coordinate.size):
        work.before.coordinate[r], work.before.rate[r] = work.after.coordinate[r], work.after.rate[r]
        work.local.coordinate[r], work.local.rate[r] = work.after.coordinate[r], work.after.rate[r]
    for k in range(work.motion.shape[0]):
        work.before.speed[k] = work.after.speed[k]


@routine
def add_table_work(system: SystemArrays, work: Workspace, step: float) -> None:
    """Add what the tables V(x, d; m, a) supply over the step that ends in ``work.local``.

    That is the integral of V_x x' + V_m m' + V_a a'. V_x follows the slope of the transmission error, which
    bends or jumps at handovers within a part of a step, and no mass smooths it: stages chosen for the motion
    miss it. So it is integrated from knot to knot, on the cubic through both ends of the step. The end
    becomes the start of the next step.
    """
    elements, before, after = system.elements, work.before, work.after
    keep_motion(system, work, after)
    for e in range(elements.law.size):
        if elements.law[e] == FLANK:
            table = elements.laws.flank.table
        elif elements.law[e] == SPATIAL_FLANK:
            table = elements.laws.spatial_flank.grid.base
        else:
            continue
        m, period = elements.mesh[e], table.period[elements.entry[e]]
        ahead = 0.5 * step * (before.pace[m] + after.pace[m])
        first, last = before.position[m], after.position[m]
        last += period * math.floor((first + ahead - last) / period + 0.5)
        _along(elements, work, table, e, (first, step * before.pace[m], last, step * after.pace[m]), step)
    _start_at_the_end(work)


@inner
def _along(elements: Elements, work: Workspace, table: PackedTables, e: int, path: Path, step: float) -> None:
    """Integrate one element from knot to knot."""
    entry = elements.entry[e]
    row, u, per_width = position_interval(table, entry, path[0])
    interval = (row - table.offset[entry, 3]) // table.offset[entry, 5]
    knot = table.offset[entry, 0]
    forward = path[2] >= path[0]
    start = 0.0
    base = path[0] - u / per_width - table.knot[knot + interval]  # where knot 0 of this period lies
    intervals = _intervals(table, entry)
    while start < 1.0:
        at = base + table.knot[knot + interval + (1 if forward else 0)]
        end = _fraction(path, at, start)
        _piece(elements, work, e, path, step, start, end)
        start = end
        interval += 1 if forward else -1
        if interval == intervals:
            interval, base = 0, base + table.period[entry]
        elif interval < 0:
            interval, base = intervals - 1, base - table.period[entry]


@inner
def _intervals(table: PackedTables, entry: int) -> int:
    """Return the number of position intervals."""
    return int(table.offset[entry, 2] // BUCKETS_PER_KNOT)


@inner
def _fraction(path: Path, at: float, start: float) -> float:
    """Return the fraction of the step, after `start`, at which the position reaches `at`; at most 1."""
    way = path[2] - path[0]
    if abs(at - path[0]) >= abs(way):
        return 1.0
    w = (at - path[0]) / way
    for _ in range(2):
        slope = cubic_slope(path, w)
        if slope * way > 0.0:
            w -= (cubic(path, w) - at) / slope
            w = min(max(w, 0.0), 1.0)
    return max(w, start)


@inner
def _piece(
    elements: Elements, work: Workspace, e: int, path: Path, step: float, start: float, end: float
) -> None:
    """Add the work between two fractions of the step."""
    if end <= start:
        return
    row, rows = elements.first[e], elements.first[e + 1] - elements.first[e]
    local = work.local
    for point in GAUSS:
        w = start + point * (end - start)
        for r in range(row, row + rows):
            along = (
                work.before.coordinate[r],
                step * work.before.rate[r],
                work.after.coordinate[r],
                step * work.after.rate[r],
            )
            local.coordinate[r], local.rate[r] = cubic(along, w), cubic_slope(along, w)
        local.position[elements.mesh[e]] = cubic(path, w)
        position, axes = _rates(elements, local, e)
        work.work[Power.POSITION] += 0.5 * (end - start) * position * cubic_slope(path, w)
        work.work[Power.AXES] += 0.5 * (end - start) * axes


@inner
def _rates(elements: Elements, local: LocalState, e: int) -> tuple[float, float]:
    """Return V_x, J per base pitch, and V_m m' + V_a a' in the local state; rates per step."""
    row, entry, m = elements.first[e], elements.entry[e], elements.mesh[e]
    if elements.law[e] == FLANK:
        x, d = local.position[m], local.coordinate[row]
        return table_energy(elements.laws.flank.table, entry, x, d, local.hint[e])[1], 0.0
    laws = elements.laws.spatial_flank
    _, in_x, in_m, in_a = spatial_energy(laws, entry, local, row, m)
    to_m, to_a, axes = laws.row[entry, 0], laws.row[entry, 1], 0.0
    if to_m > 0:
        axes += in_m * local.rate[row + to_m]
    if to_a > 0:
        axes += in_a * local.rate[row + to_a]
    return in_x, axes


@inner
def cubic(path: Path, w: float) -> float:
    """Return the cubic through values and rates at both ends at the fraction `w`."""
    end = w * w * (3.0 - 2.0 * w)
    return float(path[0] + end * (path[2] - path[0]) + w * (1.0 - w) * ((1.0 - w) * path[1] - w * path[3]))


@inner
def cubic_slope(path: Path, w: float) -> float:
    """Differentiate `cubic` in the fraction."""
    rise = 6.0 * w * (1.0 - w) * (path[2] - path[0])
    return float(rise + (1.0 - w) * (1.0 - 3.0 * w) * path[1] + w * (3.0 * w - 2.0) * path[3])
