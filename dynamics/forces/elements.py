"""Compiled force elements: one evaluation for all, which hands each to its law by kind.

An element has p local coordinates y = G q + y0 in meters and gives p local forces f(y, y', x) in newtons,
which act on the freedoms as -G^T f. To add a law: its file (what a scene holds, packed arrays, compiled
function), a member of `Law`, a field of `ElementLaws`, a branch in `evaluate` and in `potential`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dynamics.bearings.axial_seat import axial_seat
from dynamics.bearings.ball_elements import balls, balls_energy
from dynamics.bearings.ball_grooves import BallElements
from dynamics.bearings.linear_bearing import LinearBearingLaws, linear_bearing, linear_bearing_energy
from dynamics.bearings.roller_elements import RollerElements, rollers, rollers_energy
from dynamics.bearings.rolling_contact import RollingContactLaws, rolling_contact, rolling_contact_energy
from dynamics.bearings.spring_curve import SpringCurveLaws, spring_curve, spring_curve_energy
from dynamics.forces.frame_coupling import (
    FrameCouplingLaws,
    frame_coupling,
    frame_coupling_energy,
)
from dynamics.forces.rotating_frame import RotatingFrameLaws, rotating_frame, rotating_frame_energy
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import inner
from dynamics.kernels.law import Law
from dynamics.kernels.local_state import LocalState
from dynamics.loads.force_course import ForceCourseLaws, applied_force
from dynamics.loads.speed_torque import SpeedTorqueLaws, speed_torque
from dynamics.loads.unbalance_force import UnbalanceLaws, unbalance, unbalance_energy
from dynamics.meshes.flank_force import FlankLaws, flank_force
from dynamics.meshes.spatial_flank import SpatialFlankLaws, spatial_energy, spatial_flank
from dynamics.meshes.table_energy import table_energy
from dynamics.types import FloatArray, IntArray

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
        for routine in ROUTINES.get(law, ()):
            routine.prepare(by_address(getattr(elements.laws, law.name.lower())), local)


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
