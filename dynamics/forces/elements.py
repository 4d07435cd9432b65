"""Compiled force elements: one evaluation for all, which hands each to its law by kind.

An element has p local coordinates y = G q + y0 in meters and gives p local forces f(y, y', x) in newtons,
which act on the freedoms as -G^T f. To add a law: its file (what a scene holds, packed arrays, compiled
function), a member of `Law`, a field of `ElementLaws`, a branch in `evaluate` and in `potential`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dynamics.bearings.axial_seat import axial_seat
from dynamics.bearings.ball_elements import balls, balls_energy
from dynamics.bearings.ball_grooves import BallElements
from dynamics.bearings.linear_bearing import LinearBearingLaws, linear_bearing, linear_bearing_energy
from dynamics.bearings.roller_elements import RollerElements, rollers, rollers_energy
from dynamics.bearings.rolling_contact import RollingContactLaws, rolling_contact, rolling_contact_energy
from dynamics.bearings.spring_curve import SpringCurveLaws, spring_curve, spring_curve_energy
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import inner
from dynamics.kernels.law import Law
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.loads.force_course import ForceCourseLaws, applied_force
from dynamics.loads.speed_torque import SpeedTorqueLaws, speed_torque
from dynamics.loads.unbalance_force import UnbalanceLaws, unbalance, unbalance_energy
from dynamics.meshes.flank_force import FlankLaws, flank_force
from dynamics.meshes.spatial_flank import SpatialFlankLaws, spatial_energy, spatial_flank
from dynamics.meshes.technique import table_energy
from dynamics.types import BoolArray, FloatArray, IntArray

# Rotating-frame forces: gyroscopic moments, Coriolis and centripetal terms, loads; their compiled law.


class RotatingFrameLaws(NamedTuple):
    """l elements in y = (a, b) across the axis of a shaft of spin w in a frame of speed W.

    With J = z x the inertia resists by (c_1 w + c_2 W) J y' + (c_3 w W + c_4 W^2) y, a ground damper seen
    from the frame by c_5 W J y, and a body off the frame's axis is pulled outwards by l W^2.

    Attributes
    ----------
    factor : (l, 5) array
        c_1 to c_5: kg, kg/rad ..., N s/m.
    load : (l, 2) array
        l: mass times arm from the frame's axis, kg m.
    lever : (l,) array
        Of the row of the spin, m: row over angle.
    spinning : (l,) bool array
        Whether a third row adds the shaft's own rotation to the spin of the kinematic motion.
    """

    factor: FloatArray
    load: FloatArray
    lever: FloatArray
    spinning: BoolArray


@routine
def rotating_frame(laws: RotatingFrameLaws, entry: int, local: LocalState, row: int, e: int) -> None:
    """Write forces and derivatives into the rows of element `e`, the first of which is `row`.

    The row of the spin carries no force: what stays 0 is 0 from the start.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    spin, frame = local.speed[e, 0], local.speed[e, 1]
    rows = 2
    if laws.spinning[entry]:
        rows = 3
        spin += rate[row + 2] / laws.lever[entry]
    c = laws.factor
    swirl = c[entry, 0] * spin + c[entry, 1] * frame
    hold = c[entry, 2] * spin * frame + c[entry, 3] * frame * frame
    drag = c[entry, 4] * frame
    for k in range(2):
        other, sign = 1 - k, 2.0 * k - 1.0  # J y = (-y_2, y_1)
        here, there = coordinate[row + k], coordinate[row + other]
        elastic[row + k] = hold * here - laws.load[entry, k] * frame * frame
        force[row + k] = sign * (swirl * rate[row + other] + drag * there) + elastic[row + k]
        tangent[row + k, k], tangent[row + k, other] = hold, sign * drag
        viscous[row + k, other] = sign * swirl
        if rows == 2:
            continue
        by_spin = sign * c[entry, 0] * rate[row + other] + c[entry, 2] * frame * here
        viscous[row + k, 2] = by_spin / laws.lever[entry]


@routine
def rotating_frame_energy(laws: RotatingFrameLaws, entry: int, local: LocalState, row: int, e: int) -> float:
    """Return the energy of the terms in y and of the load, J; negative where they push outwards."""
    spin, frame, y = local.speed[e, 0], local.speed[e, 1], local.coordinate
    hold = laws.factor[entry, 2] * spin * frame + laws.factor[entry, 3] * frame**2
    pulled = frame**2 * (laws.load[entry, 0] * y[row] + laws.load[entry, 1] * y[row + 1])
    return float(0.5 * hold * (y[row] ** 2 + y[row + 1] ** 2) - pulled)


# A coupling between shafts described in frames that turn against each other; its compiled law.


class FrameCouplingLaws(NamedTuple):
    """l couplings in y = (a, b): n lengths of one shaft, then n of the other, each in its own frame.

    n is 2 (across the axis) or 4 (tilts about x and y times a lever too). The second frame has turned by psi
    against the first. With R = R(psi) for each pair of directions,

        d = a - R b,    F = K d + C d',    d' = a' - R b' - psi' J R b,    J = z x,

    and F pushes the first shaft back and, turned by R^T, the second along. K and C are the same in all
    directions across the axis: they commute with R.

    Attributes
    ----------
    size : (l,) int array
        n.
    stiffness, damping : (l, 4, 4) arrays
        N/m, N s/m.
    """

    size: IntArray
    stiffness: FloatArray
    damping: FloatArray


@inner
def _turned(row: int, i: int, c: float, s: float, values: FloatArray) -> float:
    if i % 2 == 0:
        return float(c * values[row + i] - s * values[row + i + 1])
    return float(s * values[row + i - 1] + c * values[row + i])


@inner
def _strain(row: int, n: int, i: int, c: float, s: float, coordinate: FloatArray) -> float:
    return float(coordinate[row + i]) - _turned(row + n, i, c, s, coordinate)


@inner
def _strain_rate(
    row: int, n: int, i: int, c: float, s: float, turn: float, coordinate: FloatArray, rate: FloatArray
) -> float:
    """Return component `i` of d'."""
    other = i + 1 if i % 2 == 0 else i - 1
    sign = -1.0 if i % 2 == 0 else 1.0
    swept = turn * sign * _turned(row + n, other, c, s, coordinate)
    return float(rate[row + i]) - _turned(row + n, i, c, s, rate) - swept


@routine
def frame_coupling(laws: FrameCouplingLaws, entry: int, local: LocalState, row: int, turned: int) -> None:
    """Write forces and derivatives into the 2 n rows of a coupling, the first of which is `row`.

    The position `turned` is psi, in revolutions.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    n, k, damping = laws.size[entry], laws.stiffness, laws.damping
    angle, turn = 2.0 * math.pi * local.position[turned], 2.0 * math.pi * local.pace[turned]
    c, s = math.cos(angle), math.sin(angle)
    for i in range(n):
        spring, total = 0.0, 0.0
        for j in range(n):
            pull = k[entry, i, j] * _strain(row, n, j, c, s, coordinate)
            spring += pull
            total += pull + damping[entry, i, j] * _strain_rate(row, n, j, c, s, turn, coordinate, rate)
        elastic[row + i], force[row + i] = spring, total
    for i in range(n):  # turned back into the second frame
        elastic[row + n + i] = -_turned(row, i, c, -s, elastic)
        force[row + n + i] = -_turned(row, i, c, -s, force)
    for i in range(n):
        for j in range(n):
            other = j + 1 if j % 2 == 0 else j - 1
            sign = 1.0 if j % 2 == 0 else -1.0
            # d d'/d b = -psi' J R adds C psi' J to the stiffness that b sees
            seen = k[entry, i, j] + turn * sign * damping[entry, i, other]
            beside = k[entry, i, other] - turn * sign * damping[entry, i, j]
            tangent[row + i, j] = k[entry, i, j]
            tangent[row + i, n + j] = -(c * seen + sign * s * beside)
            tangent[row + n + i, n + j] = seen
            # R^T K = K R^T
            tangent[row + n + i, j] = -(c * k[entry, i, j] - sign * s * k[entry, i, other])
            viscous[row + i, j] = damping[entry, i, j]
            viscous[row + i, n + j] = -(c * damping[entry, i, j] + sign * s * damping[entry, i, other])
            viscous[row + n + i, n + j] = damping[entry, i, j]
            viscous[row + n + i, j] = -(c * damping[entry, i, j] - sign * s * damping[entry, i, other])


@routine
def frame_coupling_energy(
    laws: FrameCouplingLaws, entry: int, local: LocalState, row: int, turned: int
) -> tuple[float, float]:
    """Return the energy stored, J, and its derivative in psi, J per revolution."""
    n, coordinate, angle = laws.size[entry], local.coordinate, 2.0 * math.pi * local.position[turned]
    c, s = math.cos(angle), math.sin(angle)
    energy, slope = 0.0, 0.0
    for i in range(n):
        spring = 0.0
        for j in range(n):
            spring += laws.stiffness[entry, i, j] * _strain(row, n, j, c, s, coordinate)
        other = i + 1 if i % 2 == 0 else i - 1
        sign = -1.0 if i % 2 == 0 else 1.0
        energy += 0.5 * spring * _strain(row, n, i, c, s, coordinate)
        slope -= 2.0 * math.pi * spring * sign * _turned(row + n, other, c, s, coordinate)
    return energy, slope


FLANK, SPEED_TORQUE = int(Law.FLANK), int(Law.SPEED_TORQUE)
ROLLING_CONTACT, SPRING_CURVE = int(Law.ROLLING_CONTACT), int(Law.SPRING_CURVE)
SPATIAL_FLANK = int(Law.SPATIAL_FLANK)
ROTATING_FRAME, FRAME_COUPLING = int(Law.ROTATING_FRAME), int(Law.FRAME_COUPLING)
BALLS, ROLLERS = int(Law.BALLS), int(Law.ROLLERS)
APPLIED_FORCE, UNBALANCE = int(Law.APPLIED_FORCE), int(Law.UNBALANCE)
LINEAR_BEARING = int(Law.LINEAR_BEARING)


class ElementLaws(NamedTuple):
    """The packed laws of all kinds, one field per kind."""

    flank: FlankLaws
    speed_torque: SpeedTorqueLaws
    rolling_contact: RollingContactLaws
    spring_curve: SpringCurveLaws
    spatial_flank: SpatialFlankLaws
    rotating_frame: RotatingFrameLaws
    frame_coupling: FrameCouplingLaws
    balls: BallElements
    rollers: RollerElements
    applied_force: ForceCourseLaws
    unbalance: UnbalanceLaws
    linear_bearing: LinearBearingLaws


class Elements(NamedTuple):
    """E elements with R local coordinates in all, of m meshes.

    Attributes
    ----------
    law : (E,) int array
        See `Law`.
    entry : (E,) int array
        Of each within the arrays of its law.
    first : (E + 1,) int array
        First row of each element, and R.
    mesh : (E,) int array
        The mesh whose position it reads, or from m on the turn of frames it reads; -1: none.
    offset : (R,) array
        y0: local coordinates at q = 0, m.
    drift : (k, R) array
        Rates of the local coordinates in the kinematic motion per unit speed of each law, m/rad; 0 for
        flanks, whose coordinates that motion does not change.
    stiffness : (R,) array
        Typical stiffness of bearings, N/m, for error norms and first guesses; 0 for all others.
    speed : (k, E, 2) array
        Spin of a shaft and speed of its frame per unit speed of each law; for rotating-frame terms.
    laws : ElementLaws
    """

    law: IntArray
    entry: IntArray
    first: IntArray
    mesh: IntArray
    offset: FloatArray
    drift: FloatArray
    stiffness: FloatArray
    speed: FloatArray
    laws: ElementLaws


def make_local(elements: Elements, meshes: int) -> LocalState:
    """Allocate for `elements` of that many meshes."""
    rows, count, laws = elements.offset.size, elements.law.size, elements.drift.shape[0]
    most = int(np.max(np.diff(elements.first), initial=1))
    return LocalState(
        np.zeros(meshes),
        np.zeros(meshes),
        np.full(laws, np.nan),
        np.zeros((meshes, laws)),
        np.zeros(rows),
        np.zeros(rows),
        np.zeros(rows),
        np.zeros(rows),
        np.zeros(1),
        np.zeros((count, 2)),
        np.zeros(rows),
        np.zeros(rows),
        np.zeros((rows, most)),
        np.zeros((rows, most)),
        np.zeros((rows, most)),
        np.zeros(count, dtype=np.int64),
    )


ROUTINES = {
    Law.SPEED_TORQUE: (speed_torque,),
    Law.ROLLING_CONTACT: (rolling_contact, rolling_contact_energy),
    Law.SPRING_CURVE: (spring_curve, spring_curve_energy),
    Law.SPATIAL_FLANK: (spatial_flank, spatial_energy),
    Law.ROTATING_FRAME: (rotating_frame, rotating_frame_energy),
    Law.FRAME_COUPLING: (frame_coupling, frame_coupling_energy),
    Law.BALLS: (axial_seat, balls, balls_energy),
    Law.ROLLERS: (rollers, rollers_energy),
    Law.APPLIED_FORCE: (applied_force,),
    Law.UNBALANCE: (unbalance, unbalance_energy),
    Law.LINEAR_BEARING: (linear_bearing, linear_bearing_energy),
}
"""What a kind of law is compiled from, when a scene first has it; flanks are compiled into every loop."""


def prepare_laws(elements: Elements) -> None:
    """Compile the routines of the laws that `elements` have."""
    local = by_address(make_local(elements, 0))
    for law in map(Law, np.unique(elements.law)):
        for each in ROUTINES.get(law, ()):
            each.prepare(by_address(getattr(elements.laws, law.name.lower())), local)


@inner
def is_linear(elements: Elements, e: int) -> bool:
    """Return whether forces are constant matrices times coordinates and rates: stages eliminate them."""
    return bool(elements.law[e] == LINEAR_BEARING)


@inner
def evaluate_linear(elements: Elements, local: LocalState, e: int) -> None:
    """Do what `evaluate` does for an element that `is_linear`."""
    linear_bearing(elements.laws.linear_bearing, elements.entry[e], local, elements.first[e])


@inner
def evaluate(elements: Elements, local: LocalState, e: int) -> None:
    """Write forces and derivatives of element `e` at the coordinates, rates and position in `local`."""
    row, entry, laws = elements.first[e], elements.entry[e], elements.laws
    kind = elements.law[e]
    if kind == FLANK:
        force, elastic, tangent, viscous, hint = flank_force(
            laws.flank,
            entry,
            local.position[elements.mesh[e]],
            local.coordinate[row],
            local.rate[row],
            local.hint[e],
        )
        local.force[row], local.elastic[row], local.hint[e] = force, elastic, hint
        local.tangent[row, 0], local.viscous[row, 0] = tangent, viscous
    elif kind == SPEED_TORQUE:
        speed_torque(laws.speed_torque, entry, local, row)
    elif kind == ROLLING_CONTACT:
        rolling_contact(laws.rolling_contact, entry, local, row)
    elif kind == SPRING_CURVE:
        spring_curve(laws.spring_curve, entry, local, row)
    elif kind == SPATIAL_FLANK:
        spatial_flank(laws.spatial_flank, entry, local, row, e, elements.mesh[e])
    elif kind == ROTATING_FRAME:
        rotating_frame(laws.rotating_frame, entry, local, row, e)
    elif kind == FRAME_COUPLING:
        frame_coupling(laws.frame_coupling, entry, local, row, elements.mesh[e])
    elif kind == BALLS:
        balls(laws.balls, entry, local, row, elements.mesh[e])
    elif kind == ROLLERS:
        rollers(laws.rollers, entry, local, row, elements.mesh[e])
    elif kind == APPLIED_FORCE:
        applied_force(laws.applied_force, entry, local, row)
    elif kind == UNBALANCE:
        unbalance(laws.unbalance, entry, local, row)
    elif kind == LINEAR_BEARING:
        evaluate_linear(elements, local, e)


@inner
def potential(elements: Elements, local: LocalState, e: int) -> tuple[float, float]:
    """Return the energy element `e` stores, J, and its derivative in the position, J per base pitch."""
    row, entry, laws = elements.first[e], elements.entry[e], elements.laws
    kind = elements.law[e]
    if kind == FLANK:
        x = local.position[elements.mesh[e]]
        return table_energy(laws.flank.table, entry, x, local.coordinate[row], local.hint[e])
    if kind == ROLLING_CONTACT:
        return rolling_contact_energy(laws.rolling_contact, entry, local, row), 0.0
    if kind == SPRING_CURVE:
        return spring_curve_energy(laws.spring_curve, entry, local, row), 0.0
    if kind == SPATIAL_FLANK:
        energy, slope, _, _ = spatial_energy(laws.spatial_flank, entry, local, row, elements.mesh[e])
        return energy, slope
    energy, slope = 0.0, 0.0
    if kind == ROTATING_FRAME:
        energy = rotating_frame_energy(laws.rotating_frame, entry, local, row, e)
    elif kind == FRAME_COUPLING:
        energy, slope = frame_coupling_energy(laws.frame_coupling, entry, local, row, elements.mesh[e])
    elif kind == BALLS:
        energy, slope = balls_energy(laws.balls, entry, local, row, elements.mesh[e])
    elif kind == ROLLERS:
        energy, slope = rollers_energy(laws.rollers, entry, local, row, elements.mesh[e])
    elif kind == UNBALANCE:
        energy = unbalance_energy(laws.unbalance, entry, local, row)
    elif kind == LINEAR_BEARING:
        energy = linear_bearing_energy(laws.linear_bearing, entry, local, row)
    return energy, slope


@inner
def power_along_axes(elements: Elements, local: LocalState, e: int) -> float:
    """Return the power that the elastic forces along a table's axes give to the bodies, W."""
    if elements.law[e] != SPATIAL_FLANK:
        return 0.0
    row, entry, laws = elements.first[e], elements.entry[e], elements.laws.spatial_flank
    power = 0.0
    for axis in range(2):
        to = laws.row[entry, axis]
        if to > 0:
            power += local.elastic[row + to] * local.rate[row + to]
    return power


@inner
def power_by_frames(elements: Elements, local: LocalState, e: int) -> float:
    """Return what the rotation of frames, and of cages, stores in what it turns, W."""
    kind = elements.law[e]
    if elements.mesh[e] < 0 or kind not in (FRAME_COUPLING, BALLS, ROLLERS):
        return 0.0
    return potential(elements, local, e)[1] * float(local.pace[elements.mesh[e]])


@inner
def slides(elements: Elements, e: int, row: int) -> bool:
    """Return whether `row` of element `e` carries sliding friction."""
    if elements.law[e] != SPATIAL_FLANK:
        return False
    first = elements.laws.spatial_flank.row[elements.entry[e], 2]
    return bool(first > 0 and row >= elements.first[e] + first)


@inner
def has_unbalance(elements: Elements) -> bool:
    """Return whether forces depend on accelerations."""
    laws = elements.laws.unbalance
    return bool(laws.amount.size > 0 and not laws.steady[0])
