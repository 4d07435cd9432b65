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
from dynamics.meshes.grid_energy import grid_energy
from dynamics.meshes.grid_lookup import Cell, GridForce, find_cell, grid_force, hermite, hermite_slope, sample
from dynamics.meshes.grid_tables import GridTables
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.sliding_friction import Lever, Sliding, scaled, sliding_force
from dynamics.types import BoolArray, FloatArray, IntArray

LOAD_ARM, SLIDING_SHARE, SLIDING_LEVER = 2, 4, 6  # channels


class SpatialFlankLaws(NamedTuple):
    """Force laws of k flanks in space."""

    grid: GridTables
    """Tables of the elastic forces and load arms."""
    damping: FloatArray
    """Damping in full contact, N s/m. Shape (k,)."""
    reach: FloatArray
    """Elastic force in N from which the damping acts in full. Shape (k,)."""
    row: IntArray
    """Row of misalignment, center-distance change and sliding after that of the deflection; -1: none. The row
    of rolling follows that of sliding. Shape (k, 3).
    """
    fixed: FloatArray
    """Fixed misalignment and center-distance change, m, where the table is used at one operating point. Shape
    (k, 2).
    """
    follows: IntArray
    """Whether the force follows the row (1), or stays at the fixed value (0). Shape (k, 2)."""
    per_face: FloatArray
    """1/(face width), 1/m; 0: the force acts at mid-face. Shape (k,)."""
    mid_face: FloatArray
    """Face position of the middle of the common face from that of the driving gear, m. Shape (k,)."""
    friction: FloatArray
    """Friction force over the transverse force of a pair. Shape (k,)."""
    radius: FloatArray
    """Coordinate of the row of rolling over the rotation, m. Shape (k,)."""
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
            grid=GridTables.packed(tables),
            damping=column("damping"),
            reach=column("reach"),
            row=column("row", 3, dtype=np.int64),
            fixed=column("fixed", 2),
            follows=column("follows", 2, dtype=np.int64),
            per_face=column("per_face"),
            mid_face=column("mid_face"),
            friction=column("friction"),
            radius=column("radius"),
            running=column("running", dtype=np.bool_),
        )

    def as_running(self) -> SpatialFlankLaws:
        """Return the laws with friction as of gears that run in the sense of the scene."""
        return self._replace(running=np.ones_like(self.running))


@inner
def _lever(laws: SpatialFlankLaws, entry: int, cell: Cell, force: GridForce, channel: int) -> Lever:
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
    return Lever(value, slope * force.d, in_m + slope * force.m, in_a + slope * force.a)


@inner
def _load_arm(laws: SpatialFlankLaws, entry: int, cell: Cell, force: GridForce) -> Lever:
    """Return lambda, the load arm over the face width from the middle of the common face."""
    if laws.per_face[entry] == 0.0:
        return Lever(0.0, 0.0, 0.0, 0.0)
    lever, per_face = _lever(laws, entry, cell, force, LOAD_ARM), laws.per_face[entry]
    offset = lever.value - laws.mid_face[entry]
    return Lever(offset * per_face, lever.d * per_face, lever.m * per_face, lever.a * per_face)


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
        back = Lever(-arm.value, -arm.d, -arm.m, -arm.a)
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
) -> Sliding:
    """Return the forces along the rows of sliding and rolling, whose rates are `slip` and `roll`, m/s."""
    share = _lever(laws, entry, cell, force, SLIDING_SHARE)
    lever = _lever(laws, entry, cell, force, SLIDING_LEVER)
    mu, per_radius = laws.friction[entry], 1.0 / laws.radius[entry]
    slid = sliding_force(share, lever, slip, roll * per_radius, laws.running[entry])
    return Sliding(
        scaled(slid.along, mu),
        scaled(slid.about, mu * per_radius),
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
    target: int,
    rows: int,
    factor: Lever,
    to_m: int,
    to_a: int,
) -> None:
    force[target] = factor.value * force[row]
    for k in range(rows):
        tangent[target, k] = factor.value * tangent[row, k]
        viscous[target, k] = factor.value * viscous[row, k]
    tangent[target, 0] += factor.d * force[row]
    if to_m > 0:
        tangent[target, to_m] += factor.m * force[row]
    if to_a > 0:
        tangent[target, to_a] += factor.a * force[row]


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
