"""Alignment of a mesh: its misalignment by cause, its center distance, the twist of its gears."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.assembly.assemble import System
from dynamics.bearings import PlanetBearing
from dynamics.bearings.seat import SEAT
from dynamics.forces.elements import evaluate, make_local
from dynamics.forces.laws import Law
from dynamics.integrators import static_equilibrium
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.kernels.local_state import LocalState
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.mechanism.columns import elastic_columns, section_rows
from dynamics.mechanism.connections import condensed_housings, seat_compliance
from dynamics.mechanism.flank_gradients import (
    common_face_width,
    distance_gradient,
    middle_from_driver,
    misalignment_gradient,
    misalignment_per_tilt,
    table_sense,
)
from dynamics.mechanism.supports import carried_seat, seat_motion
from dynamics.motion.observation import observe
from dynamics.types import FloatArray, StaticStatus
from model_studies import in_unit

# The part of a bearing's displacement that is clearance: what it moves before anything presses back.


HALVINGS = 50
FREE = 1e-12
"""Part of the force up to which an element does not press."""

CAUSES = ("shaft", "bearing", "clearance", "housing", "coupling", "set")
"""Elastic shafts, elastic bearings, their clearance, the motion of their seats, shafts that couplings alone
hold, and what the scene itself sets."""
SHAFT, BEARING, CLEARANCE, HOUSING, COUPLING, SET = range(len(CAUSES))
TILT = slice(3, 5)


def _free_fraction(arrays: SystemArrays, element: int, coordinate: FloatArray) -> float:
    """Return the largest fraction of `coordinate` (p,) at which an element exerts no force; bisection."""
    local = make_local(arrays.elements, arrays.turn.shape[0])
    rows = slice(arrays.elements.first[element], arrays.elements.first[element + 1])
    system, at = by_address(arrays), by_address(local)

    def pressed(fraction: float) -> float:
        local.coordinate[rows] = fraction * coordinate
        _evaluate(system, at, element)
        return float(np.linalg.norm(local.force[rows]))

    limit = FREE * pressed(1.0)
    if pressed(0.0) > limit:
        return 0.0
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pressed(middle) <= limit else (low, middle)
    return low


@compiled
def _evaluate(system: SystemArrays, local: LocalState, element: int) -> None:
    evaluate(system.elements, local, element)


@dataclass(frozen=True)
class BearingStrain:
    """Displacements x, y, z (m), tilt_x, tilt_y (rad) at b bearings, each (b, 5); their sum is the shaft's.

    Of a planet bearing: of the planet against its pin.
    """

    elastic: FloatArray
    """What the bearing yields under its load. Shape (b, 5)."""
    clearance: FloatArray
    """What it moves before anything presses back. Shape (b, 5)."""
    seat: FloatArray
    """Of its seat in an elastic housing. Shape (b, 5)."""

    @property
    def shaft(self) -> FloatArray:
        """Of the shaft's section in the bearing, (b, 5)."""
        return self.elastic + self.clearance + self.seat


def bearing_strain(system: System, motion: FloatArray, coordinate: FloatArray) -> BearingStrain:
    """Split the displacements at the bearings.

    Clearance is the largest fraction of an element's displacement, in its own directions and in the sense in
    which it is displaced, at which it does not press yet. Where springs hold the bearing in these directions
    as well, there is none.

    Parameters
    ----------
    motion : (N,) array
        All freedoms of all rotors.
    coordinate : (R,) array
        Local coordinates of the force elements there.
    """
    places = supports_by_name(system.rotors)
    names, rotors = system.supports.name, system.rotors
    strain = np.array([seat_motion(rotors, *places[name]) @ motion for name in names]).reshape(-1, SEAT)
    carried = np.array([carried_seat(rotors, name) @ motion for name in names]).reshape(-1, SEAT)
    total = strain + carried
    seat = carried + _condensed_seats(system, total)
    yielded, clearance, elements = total - seat, np.zeros_like(total), system.arrays.elements
    for e, at in enumerate(system.bearings, start=len(system.elements) - len(system.bearings)):
        along = np.linalg.pinv(at.way) @ at.way
        if np.any(np.abs(places[names[at.support]][1].seat_stiffness @ along) > 0.0):
            continue
        rows = slice(elements.first[e], elements.first[e + 1])
        free = _free_fraction(system.arrays, e, coordinate[rows])
        clearance[at.support] += free * along @ yielded[at.support]
    return BearingStrain(yielded - clearance, clearance, seat)


def _condensed_seats(system: System, total: FloatArray) -> FloatArray:
    """Return the motions (b, 5) of the seats in housings that are no freedoms by the shafts' there (b, 5)."""
    places, names = supports_by_name(system.rotors), list(system.supports.name)
    moved = np.zeros_like(total)
    for housing in condensed_housings(system.scene, system.rotors):
        parts = [places[name][1] for name in housing.bushings]
        at = [names.index(name) for name in housing.bushings]
        stiffness = np.zeros((SEAT * len(at), SEAT * len(at)))
        for k, part in enumerate(parts):
            own = slice(SEAT * k, SEAT * k + SEAT)
            stiffness[own, own] = part.seat_stiffness
        preload = np.concatenate([part.preload or np.zeros(SEAT) for part in parts])
        pushed = stiffness @ total[at].ravel() - preload
        moved[at] = (seat_compliance(housing, stiffness) @ pushed).reshape(-1, SEAT)
    return moved


# The rest positions of a system over the mesh cycle, and their mean.


@dataclass(frozen=True)
class Rest:
    """K rest positions of a system of N freedoms of all rotors, m meshes and b bearings."""

    status: StaticStatus
    """The worst of all positions."""
    residual: float
    """Largest unbalanced force of all positions over the largest mesh force."""
    motion: FloatArray
    """Six freedoms of every rotor, then elastic coordinates, m and rad. Shape (K, N)."""
    element: FloatArray
    """Local coordinates of all force elements, m. Shape (K, R)."""
    mesh_force: FloatArray
    """Transverse, N. Shape (K, m)."""
    load_arm: FloatArray
    """Of the mesh force from mid-face of the driving gear, m, as in a table; NaN where it acts at mid-face.
    Shape (K, m).
    """
    bearing_force: FloatArray
    """Force and moment on what holds each bearing, N and N m. Shape (K, b, 5)."""


def rest_over(system: System, times: FloatArray) -> Rest:
    """Return where the bodies of `system` rest at `times` (K,)."""
    solutions = [static_equilibrium(system, float(time)) for time in times]
    q = np.array([solution.displacement for solution in solutions])
    v = np.zeros_like(q)
    seen = observe(system.arrays, times, q, v)
    on_bearings = system.bearing_force(seen.force, q, v)
    force = np.zeros((times.size, len(system.supports.name), 5))
    rows = min(on_bearings.shape[1], 5)
    force[:, :, :rows] = np.moveaxis(on_bearings, 2, 0)[:, :, :rows]
    mesh_force = seen.force[system.driving_rows].T
    largest = float(np.max(np.abs(mesh_force), initial=0.0))
    residual = float(np.max([solution.residual for solution in solutions]))
    return Rest(
        status=max(solution.status for solution in solutions),
        residual=residual / largest if largest > 0.0 else float("inf"),
        motion=q @ system.freedoms.motion.T,
        element=seen.coordinate.T,
        mesh_force=mesh_force,
        load_arm=_load_arms(system, seen.force).T,
        bearing_force=force,
    )


def _load_arms(system: System, force: FloatArray) -> FloatArray:
    """Return the arms of the forces (R, K) of the driving flanks, (m, K), m; NaN of none."""
    elements, scene = system.arrays.elements, system.scene
    arm = np.full((len(scene.meshes), force.shape[1]), np.nan)
    for mesh in range(len(scene.meshes)):
        row, laws = elements.first[mesh], elements.laws.spatial_flank
        if elements.law[mesh] != Law.SPATIAL_FLANK or laws.per_face[elements.entry[mesh]] == 0.0:
            continue
        tilting = force[row + laws.row[elements.entry[mesh], 0]]
        line, sense = system.lines[mesh], system.kinematics.mesh_sense[mesh]
        middle = middle_from_driver(scene, mesh, line, sense)
        loaded = np.where(force[row] != 0.0, force[row], np.nan)
        arm[mesh] = middle - common_face_width(scene, mesh) * tilting / loaded
    return arm


# Tilts of shafts split by their causes: a linear functional of the displacements for each cause.


def _gear_tilt(system: System, gear: str, motion: FloatArray, strain: BearingStrain) -> FloatArray:
    """Return tilt_x and tilt_y (rad) of a gear's section by cause, (causes, 2); their sum is the whole.

    The shaft's part is the tilt against the straight line through its bearing seats.
    """
    part = system.scene.gear(gear)
    index = system.scene.shaft_index(part.shaft)
    z = system.scene.shafts[index].origin[2] + part.position
    tilts = _axis_tilt(system, index, motion, strain)
    tilts[SHAFT] += section_rows(system.rotors, index, z)[TILT] @ motion - tilts.sum(axis=0)
    return tilts


def _axis_tilt(system: System, index: int, motion: FloatArray, strain: BearingStrain) -> FloatArray:
    """Return the tilt of the line through the bearing seats of the rotor `index` by cause, (causes, 2).

    The displaced centers of two bearings make the line, of more of them the line of least squares, of a
    single one the tilt of the shaft in it. A rotor without bearings has the tilt of its rigid motion. A
    planet's line goes with its carrier's.
    """
    rotor, tilts = system.rotors[index], np.zeros((len(CAUSES), 2))
    carried = [part for part in rotor.supports if isinstance(part, PlanetBearing)]
    if carried and rotor.carrier is not None:
        tilts += _axis_tilt(system, rotor.carrier, motion, strain)
    names = _radial(system, index)
    if not names:
        tilts[COUPLING] += motion[6 * index + 3 : 6 * index + 5]
        return tilts
    places = supports_by_name(system.rotors)
    z = np.array([places[name][1].position for name in names])
    at = [system.supports.name.index(name) for name in names]
    for cause, moved in ((BEARING, strain.elastic), (CLEARANCE, strain.clearance), (HOUSING, strain.seat)):
        tilts[cause] += _line_tilt(z, moved[at])
    return tilts


def _line_tilt(z: FloatArray, moved: FloatArray) -> FloatArray:
    """Return tilt_x and tilt_y (rad) of the line through points at z (S,), m, moved by `moved` (S, 5).

    u_x = tilt_y z and u_y = -tilt_x z.
    """
    away = z - z.mean()
    if float(np.max(np.abs(away))) == 0.0:
        return np.asarray(moved[:, TILT].mean(axis=0))
    slope = away @ moved[:, :2] / (away @ away)
    return np.array([-slope[1], slope[0]])


def _radial(system: System, index: int) -> list[str]:
    """Return the bearings of a rotor that hold it across its axis."""
    lawful = {system.supports.name[at.support] for at in system.bearings if at.way[:, :2].any()}
    return [
        part.name
        for part in system.rotors[index].supports
        if part.name in lawful or part.seat_stiffness[0, 0] + part.seat_stiffness[1, 1] > 0.0
    ]


# The twist of gears along their faces, as a deviation of the lead.


def _lead_torsion(system: System, index: int, motion: FloatArray) -> float:
    """Return how the gap of mesh `index` grows over its common face by the twist of both shafts, m.

    Towards positive z of the table's driving gear, as misalignment. The shafts as they are under the gears;
    a torque that enters evenly along the face twists its ends as one that enters in its middle.
    """
    scene, line, mesh = system.scene, system.lines[index], system.scene.meshes[index]
    towards = -table_sense(scene, index, system.kinematics.mesh_sense[index])
    half, grown = 0.5 * common_face_width(scene, index), 0.0
    for name, side in ((mesh.driver, 1.0), (mesh.driven, -1.0)):
        shaft = scene.shaft_index(scene.gear(name).shaft)
        rotor = system.rotors[shaft]
        middle, ends = float(line.point[2]) - rotor.shaft.origin[2], np.zeros(2)
        if rotor.elastic is not None:  # linear between nodes: exact where torques act at nodes alone
            own = motion[elastic_columns(system.rotors, shaft)][rotor.elastic.twists]
            turned, at = rotor.elastic.torsion.shape @ own, np.array([middle - half, middle + half])
            ends = np.interp(at, rotor.elastic.position, turned)
        lever = side * float(line.gradient(rotor.center)[5])
        grown -= towards * lever * float(ends[1] - ends[0])
    return grown


@dataclass(frozen=True)
class MeshAlignment:
    """The alignment of a mesh under a load case, mean over the mesh cycle.

    Misalignment is the tilt of the axes in the plane of action as growth of the gap over the common face
    width, towards positive z of the table's driving gear: F_beta before running-in.
    """

    name: str
    force: float = field(metadata=in_unit("n"))
    """Transverse, N."""
    misalignment: float = field(metadata=in_unit("m"))
    """m."""
    least: float = field(metadata=in_unit("m"))
    largest: float = field(metadata=in_unit("m"))
    """`least`, `largest`: Misalignment over the cycle, m."""
    causes: FloatArray = field(metadata=in_unit("m", "cause"))
    """Parts of the misalignment by `CAUSES`, m. Shape (6,)."""
    center_distance_change: float = field(metadata=in_unit("m"))
    """m, with what the scene sets."""
    lead_torsion: float = field(metadata=in_unit("m"))
    """Growth of the gap over the common face width by the twist of both shafts along it, m; not part of the
    misalignment.
    """
    load_arm: float = field(metadata=in_unit("m"))
    """Of the mesh force from mid-face of the table's driving gear, m; NaN: it acts at mid-face."""
    in_table: bool = True
    """Whether the table has the misalignments of the whole cycle, or no such axis."""


def mesh_alignment(system: System, index: int, rest: Rest, strain: BearingStrain) -> MeshAlignment:
    """Return the alignment of mesh `index` in the rest positions, `strain` that of their mean."""
    scene, mesh, rotors = system.scene, system.scene.meshes[index], system.rotors
    line, sense = system.lines[index], system.kinematics.mesh_sense[index]
    motion = rest.motion.mean(axis=0)
    row = misalignment_gradient(scene, rotors, index, line, sense)
    course = mesh.misalignment + rest.motion @ row
    apart = float(distance_gradient(scene, rotors, index, line) @ motion)
    per_tilt = misalignment_per_tilt(scene, index, line, sense)[:2]
    driver, driven = (_gear_tilt(system, gear, motion, strain) for gear in (mesh.driver, mesh.driven))
    causes = (driver - driven) @ per_tilt
    causes[SET] += mesh.misalignment
    axis = np.asarray(mesh.table.misalignment)
    inside = axis.size == 1 or bool(np.all((course >= axis[0]) & (course <= axis[-1])))
    return MeshAlignment(
        name=mesh.name,
        force=float(rest.mesh_force[:, index].mean()),
        misalignment=float(course.mean()),
        least=float(course.min()),
        largest=float(course.max()),
        causes=causes,
        center_distance_change=mesh.center_distance_change + apart,
        lead_torsion=_lead_torsion(system, index, motion),
        load_arm=float(rest.load_arm[:, index].mean()),
        in_table=inside,
    )
