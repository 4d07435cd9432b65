"""Compiled force of a flank in space: misalignment, center distance, point of application, friction.

Local coordinates, in meters: the deflection d; the misalignment m (growth of the gap over the common face,
towards positive z of the table's driving gear) if the element has a row for it; the center-distance change a
likewise; sliding at the pitch point and rolling on it, if there is friction. With lambda = (load arm)/(face
width), the force f along the line of action has the moment -lambda f on m, and the flanks approach each other
at the load by d - lambda m.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from dynamics.kernels.compiled import inner
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.meshes.grid_lookup import (
    DEFLECTION,
    STIFFNESS,
    Cell,
    GridForce,
    Sample,
    Weights,
    find_cell,
    grid_force,
    hermite,
    hermite_slope,
    sample,
)
from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.mesh_table import MeshTable
from dynamics.types import BoolArray, FloatArray, IntArray

# Compiled Coulomb friction of sliding flanks: against the sliding velocity, never driving.


CREEP_SPEED = 1e-3
"""m/s: friction has its full size from this sliding speed on, and a smooth one through zero below it. Flanks
that stick in truth creep at up to it; a pair of 4 mm module at 10 rpm slides ten times as fast at the
ends of contact."""

LOAD_ARM, SLIDING_SHARE, SLIDING_LEVER = 2, 4, 6  # channels


class _Lever(NamedTuple):
    """A quantity of the table with its derivatives in d, m and a."""

    value: float
    d: float
    m: float
    a: float


class _Sliding(NamedTuple):
    """Friction over the normal force along sliding at the pitch point and about the axis, mu = 1."""

    along: _Lever
    """1; its derivatives 1/m."""
    about: _Lever
    """m; its derivatives 1."""
    along_rate: float
    mixed_rate: float
    about_rate: float
    """`along_rate`, `mixed_rate`, `about_rate`: Derivatives of `along` in v, s/m; of `along` in w and of
    `about` in v, s; of `about` in w, m s.
    """


@inner
def _direction(speed: float) -> tuple[float, float]:
    """Return the direction of sliding at `speed` (m/s), from -1 to 1, and its derivative."""
    s = speed / CREEP_SPEED
    if s >= 1.0:
        return 1.0, 0.0
    if s <= -1.0:
        return -1.0, 0.0
    return 0.5 * s * (3.0 - s * s), 1.5 * (1.0 - s * s) / CREEP_SPEED


@inner
def _friction(share: _Lever, lever: _Lever, slip: float, spin: float, running: bool) -> _Sliding:
    """Return the friction at sigma = `share`, kappa = `lever`, v = `slip` and w = `spin`.

    `running`: with the directions of gears that run in the sense of the scene, whatever slip and spin are.
    """
    kappa, sigma = lever.value, min(max(share.value, -1.0), 1.0)
    ahead, behind = 0.5 * (1.0 + sigma), 0.5 * (1.0 - sigma)
    if running:
        up, up_rate, down, down_rate = 1.0, 0.0, -1.0, 0.0
    else:
        up, up_rate = _direction(slip + kappa * spin)
        down, down_rate = _direction(slip - kappa * spin)
    rate, turned = ahead * up_rate + behind * down_rate, ahead * up_rate - behind * down_rate
    along, about = ahead * up + behind * down, ahead * up - behind * down
    by_share, by_lever = 0.5 * (up - down), spin * turned
    about_share, about_lever = 0.5 * kappa * (up + down), about + kappa * spin * rate
    return _Sliding(
        _Lever(
            along,
            by_share * share.d + by_lever * lever.d,
            by_share * share.m + by_lever * lever.m,
            by_share * share.a + by_lever * lever.a,
        ),
        _Lever(
            kappa * about,
            about_share * share.d + about_lever * lever.d,
            about_share * share.m + about_lever * lever.m,
            about_share * share.a + about_lever * lever.a,
        ),
        rate,
        kappa * turned,
        kappa * kappa * rate,
    )


@inner
def _scaled(lever: _Lever, factor: float) -> _Lever:
    """Return `factor` times `lever`."""
    return _Lever(factor * lever.value, factor * lever.d, factor * lever.m, factor * lever.a)


# Compiled potential energy of a table over all axes, with its derivatives in position and along the axes.


@inner
def grid_energy(grid: GridTables, flank: int, cell: Cell, deflection: float) -> Sample:
    """Return V = integral of the force over the deflection from lift-off, J.

    Its derivatives are those at constant deflection. With levels F_k at deflections d_k and stiffness K_k, a
    whole interval of width h holds h (F_k + F_k+1)/2 + h^2 (K_k - K_k+1)/12.
    """
    level, last = grid.base.offset[flank, 4], grid.base.offset[flank, 5] - 2
    value, in_x, in_m, in_a = 0.0, 0.0, 0.0, 0.0
    low = sample(grid.number, cell, 0, DEFLECTION)
    stiff = sample(grid.number, cell, 0, STIFFNESS)
    k = 0
    while k <= last and deflection > low.value:
        high = sample(grid.number, cell, k + 1, DEFLECTION)
        end = sample(grid.number, cell, k + 1, STIFFNESS)
        start, top = grid.base.level[level + k], grid.base.level[level + k + 1]
        w = min((deflection - low.value) / (high.value - low.value), 1.0)
        ends = (low.value, high.value, stiff.value, end.value)
        value += _area(w, start, top, ends)
        in_x += _area_slope(w, start, top, ends, (low.x, high.x, stiff.x, end.x))
        in_m += _area_slope(w, start, top, ends, (low.m, high.m, stiff.m, end.m))
        in_a += _area_slope(w, start, top, ends, (low.a, high.a, stiff.a, end.a))
        low, stiff = high, end
        k += 1
    beyond = deflection - low.value
    if k == last + 1 and beyond > 0.0:
        force, half = grid.base.level[level + k] + stiff.value * beyond, 0.5 * beyond * beyond
        value += beyond * (grid.base.level[level + k] + 0.5 * stiff.value * beyond)
        in_x += half * stiff.x - force * low.x
        in_m += half * stiff.m - force * low.m
        in_a += half * stiff.a - force * low.a
    return Sample(value, in_x, in_m, in_a)


@inner
def _area(w: float, start: float, top: float, ends: Weights) -> float:
    """Energy of a level interval up to the fraction `w`; `ends`: deflections, then stiffnesses."""
    span = ends[1] - ends[0]
    rise, fall, step = span * ends[2], span * ends[3], top - start
    c2, c3 = 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step
    return float(span * w * (start + w * (rise / 2.0 + w * (c2 / 3.0 + w * c3 / 4.0))))


@inner
def _area_slope(w: float, start: float, top: float, ends: Weights, slopes: Weights) -> float:
    """Differentiate `_area` as the ends move by `slopes`: at constant deflection, or with w = 1 kept."""
    span, span_slope = ends[1] - ends[0], slopes[1] - slopes[0]
    rise, fall, step = span * ends[2], span * ends[3], top - start
    c2, c3 = 3.0 * step - 2.0 * rise - fall, rise + fall - 2.0 * step
    rise_slope = span_slope * ends[2] + span * slopes[2]
    fall_slope = span_slope * ends[3] + span * slopes[3]
    area = w * (start + w * (rise / 2.0 + w * (c2 / 3.0 + w * c3 / 4.0)))
    change = rise_slope / 2.0 + w * (
        -(2.0 * rise_slope + fall_slope) / 3.0 + w * (rise_slope + fall_slope) / 4.0
    )
    w_slope = 0.0 if w == 1.0 else -(slopes[0] + w * span_slope) / span
    force = start + w * (rise + w * (c2 + w * c3))
    return float(span_slope * area + span * (force * w_slope + w * w * change))


class SpatialFlankLaws(NamedTuple):
    """Force laws of k flanks in space."""

    grid: GridTables
    """Their elastic forces and load arms."""
    damping: FloatArray
    """N s/m in full contact. Shape (k,)."""
    reach: FloatArray
    """Elastic force in N from which the damping acts in full. Shape (k,)."""
    row: IntArray
    """Row of misalignment, center-distance change and sliding after that of the deflection; -1: none. The row
    of rolling follows that of sliding. Shape (k, 3).
    """
    fixed: FloatArray
    """Their values in m where the table is used at one operating point. Shape (k, 2)."""
    follows: IntArray
    """1 where the force follows the row, 0 where it stays at the fixed value. Shape (k, 2)."""
    per_face: FloatArray
    """1/(face width), 1/m; 0: the force acts at mid-face. Shape (k,)."""
    mid_face: FloatArray
    """Face position of the middle of the common face from that of the driving gear, m. Shape (k,)."""
    friction: FloatArray
    """Friction force over the transverse force of a pair. Shape (k,)."""
    radius: FloatArray
    """Of the row of rolling, m. Shape (k,)."""
    running: BoolArray
    """Whether friction has the directions of running gears, at rest as well, instead of those of the sliding
    velocity: for studies of small motions about gears that run. Shape (k,).
    """

    @classmethod
    def packed(cls, tables: Sequence[MeshTable], figures: Mapping[str, Sequence[Any]]) -> SpatialFlankLaws:
        """Lay out the laws that read `tables`, their other fields by name."""

        def column(name: str, *width: int, dtype: Any = float) -> Any:
            return np.array(figures[name], dtype=dtype).reshape(len(tables), *width)

        return cls(
            GridTables.packed(tables),
            column("damping"),
            column("reach"),
            column("row", 3, dtype=np.int64),
            column("fixed", 2),
            column("follows", 2, dtype=np.int64),
            column("per_face"),
            column("mid_face"),
            column("friction"),
            column("radius"),
            column("running", dtype=np.bool_),
        )

    def as_running(self) -> SpatialFlankLaws:
        """Return the laws with friction as of gears that run in the sense of the scene."""
        return self._replace(running=np.ones_like(self.running))


@inner
def _lever(laws: SpatialFlankLaws, entry: int, cell: Cell, force: GridForce, channel: int) -> _Lever:
    """Return a per-level quantity at the force found: cubic in the force between two levels."""
    level = laws.grid.base.offset[entry, 4] + force.interval
    start = laws.grid.base.level[level]
    width = laws.grid.base.level[level + 1] - start
    u = min((force.value - start) / width, 1.0)
    at, by = hermite(u, width), hermite_slope(u, width)
    low = sample(laws.grid.number, cell, force.interval, channel)
    low_slope = sample(laws.grid.number, cell, force.interval, channel + 1)
    high = sample(laws.grid.number, cell, force.interval + 1, channel)
    high_slope = sample(laws.grid.number, cell, force.interval + 1, channel + 1)
    value = at[0] * low.value + at[1] * low_slope.value + at[2] * high.value + at[3] * high_slope.value
    slope = by[0] * low.value + by[1] * low_slope.value + by[2] * high.value + by[3] * high_slope.value
    in_m = at[0] * low.m + at[1] * low_slope.m + at[2] * high.m + at[3] * high_slope.m
    in_a = at[0] * low.a + at[1] * low_slope.a + at[2] * high.a + at[3] * high_slope.a
    return _Lever(value, slope * force.d, in_m + slope * force.m, in_a + slope * force.a)


@inner
def _load_arm(laws: SpatialFlankLaws, entry: int, cell: Cell, force: GridForce) -> _Lever:
    """Return lambda, the load arm over the face width from the middle of the common face."""
    if laws.per_face[entry] == 0.0:
        return _Lever(0.0, 0.0, 0.0, 0.0)
    lever, per_face = _lever(laws, entry, cell, force, LOAD_ARM), laws.per_face[entry]
    moved = lever.value - laws.mid_face[entry]
    return _Lever(moved * per_face, lever.d * per_face, lever.m * per_face, lever.a * per_face)


@inner
def _along_axis(laws: SpatialFlankLaws, entry: int, axis: int, coordinate: FloatArray, row: int) -> float:
    """Return the misalignment (axis 0) or center-distance change (1) at which the table is read."""
    if laws.follows[entry, axis] == 0:
        return float(laws.fixed[entry, axis])
    return float(coordinate[row + laws.row[entry, axis]])


@routine
def spatial_flank(laws: SpatialFlankLaws, entry: int, local: LocalState, row: int, e: int, mesh: int) -> None:
    """Write forces and derivatives of element `e` from `row` on, and its next hint.

    f = max(0, F + c s(F/reach) (d' - lambda m')): the damping takes the approach at the load, so it only
    dissipates, and the sum never pulls.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    m = _along_axis(laws, entry, 0, coordinate, row)
    a = _along_axis(laws, entry, 1, coordinate, row)
    cell = find_cell(laws.grid, entry, local.position[mesh], m, a)
    contact = grid_force(laws.grid, entry, cell, coordinate[row], local.hint[e])
    local.hint[e] = contact.interval
    arm = _load_arm(laws, entry, cell, contact)
    to_m, to_a, to_s = laws.row[entry, 0], laws.row[entry, 1], laws.row[entry, 2]
    rows = 1 + (to_m > 0) + (to_a > 0) + 2 * (to_s > 0)
    for r in range(row, row + rows):
        force[r], elastic[r] = 0.0, 0.0
        for k in range(rows):
            tangent[r, k], viscous[r, k] = 0.0, 0.0
    m_rate = rate[row + to_m] if to_m > 0 else 0.0
    approach = rate[row] - arm.value * m_rate
    ratio = min(contact.value / laws.reach[entry], 1.0)
    damping = laws.damping[entry] * ratio * ratio * (3.0 - 2.0 * ratio)
    damping_slope = laws.damping[entry] * 6.0 * ratio * (1.0 - ratio) / laws.reach[entry]
    elastic[row] = contact.value
    if to_m > 0:
        elastic[row + to_m] = -arm.value * contact.value
    total = contact.value + damping * approach
    if total < 0.0:
        return
    gain, tilting = 1.0 + damping_slope * approach, damping * m_rate
    read_m = to_m if laws.follows[entry, 0] == 1 else -1
    force[row], tangent[row, 0], viscous[row, 0] = total, contact.d * gain - tilting * arm.d, damping
    if to_m > 0:
        viscous[row, to_m] = -damping * arm.value
    if read_m > 0:
        tangent[row, read_m] = contact.m * gain - tilting * arm.m
    if to_a > 0:
        tangent[row, to_a] = contact.a * gain - tilting * arm.a
    if to_m > 0:
        back = _Lever(-arm.value, -arm.d, -arm.m, -arm.a)
        _in_proportion(force, tangent, viscous, row, row + to_m, rows, back, read_m, to_a)
    if to_s > 0:
        slip, spin = (
            rate[row + to_s] + local.drift[row + to_s],
            rate[row + to_s + 1] + local.drift[row + to_s + 1],
        )
        slid = _sliding(laws, entry, cell, contact, slip, spin)
        _in_proportion(force, tangent, viscous, row, row + to_s, rows, slid.along, read_m, to_a)
        _in_proportion(force, tangent, viscous, row, row + to_s + 1, rows, slid.about, read_m, to_a)
        viscous[row + to_s, to_s] += force[row] * slid.along_rate
        viscous[row + to_s, to_s + 1] += force[row] * slid.mixed_rate
        viscous[row + to_s + 1, to_s] += force[row] * slid.mixed_rate
        viscous[row + to_s + 1, to_s + 1] += force[row] * slid.about_rate


@inner
def _sliding(
    laws: SpatialFlankLaws, entry: int, cell: Cell, force: GridForce, slip: float, roll: float
) -> _Sliding:
    """Return the forces along the rows of sliding and rolling, whose rates are `slip` and `roll`, m/s."""
    share = _lever(laws, entry, cell, force, SLIDING_SHARE)
    lever = _lever(laws, entry, cell, force, SLIDING_LEVER)
    mu, per_radius = laws.friction[entry], 1.0 / laws.radius[entry]
    slid = _friction(share, lever, slip, roll * per_radius, laws.running[entry])
    return _Sliding(
        _scaled(slid.along, mu),
        _scaled(slid.about, mu * per_radius),
        mu * slid.along_rate,
        mu * per_radius * slid.mixed_rate,
        mu * per_radius * per_radius * slid.about_rate,
    )


@inner
def _in_proportion(
    force: FloatArray,
    tangent: FloatArray,
    viscous: FloatArray,
    row: int,
    here: int,
    rows: int,
    factor: _Lever,
    to_m: int,
    to_a: int,
) -> None:
    force[here] = factor.value * force[row]
    for k in range(rows):
        tangent[here, k] = factor.value * tangent[row, k]
        viscous[here, k] = factor.value * viscous[row, k]
    tangent[here, 0] += factor.d * force[row]
    if to_m > 0:
        tangent[here, to_m] += factor.m * force[row]
    if to_a > 0:
        tangent[here, to_a] += factor.a * force[row]


@routine
def spatial_energy(
    laws: SpatialFlankLaws, entry: int, local: LocalState, row: int, mesh: int
) -> tuple[float, float, float, float]:
    """Return the energy stored, J, and its derivatives in position, m and a; 0 along a fixed axis."""
    coordinate = local.coordinate
    m = _along_axis(laws, entry, 0, coordinate, row)
    a = _along_axis(laws, entry, 1, coordinate, row)
    cell = find_cell(laws.grid, entry, local.position[mesh], m, a)
    energy = grid_energy(laws.grid, entry, cell, coordinate[row])
    return (
        energy.value,
        energy.x,
        energy.m * laws.follows[entry, 0],
        energy.a * laws.follows[entry, 1],
    )
