"""Alignment of a mesh: its misalignment by cause, its center distance, the twist of its gears."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.bearings import PlanetBearing
from dynamics.deflection.bearing_strain import BearingStrain
from dynamics.deflection.rest_positions import Rest
from dynamics.mechanism.bearing_elements import supports_by_name
from dynamics.mechanism.columns import elastic_columns, section_rows
from dynamics.mechanism.flank_gradients import (
    common_face_width,
    distance_gradient,
    misalignment_gradient,
    misalignment_per_tilt,
    table_sense,
)
from dynamics.types import FloatArray
from model_studies import in_unit

CAUSES = ("shaft", "bearing", "clearance", "housing", "coupling", "set")
"""Causes of misalignment: elastic shafts, elastic bearings, clearance of bearings, motion of their seats,
shafts that couplings alone hold, and the misalignment that the scene sets.
"""
SHAFT, BEARING, CLEARANCE, HOUSING, COUPLING, SET = range(len(CAUSES))
TILT = slice(3, 5)


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
    bearings = {name: bearing for name, (_, bearing) in supports_by_name(system.rotors).items()}
    z = np.array([bearings[name].position for name in names])
    rows = [system.supports.name.index(name) for name in names]
    for cause, displacement in (
        (BEARING, strain.elastic),
        (CLEARANCE, strain.clearance),
        (HOUSING, strain.seat),
    ):
        tilts[cause] += _line_tilt(z, displacement[rows])
    return tilts


def _line_tilt(z: FloatArray, displacement: FloatArray) -> FloatArray:
    """Return tilt_x and tilt_y (rad) of the line through points at z (S,), m, moved by `displacement` (S, 5).

    u_x = tilt_y z and u_y = -tilt_x z.
    """
    distance = z - z.mean()
    if float(np.max(np.abs(distance))) == 0.0:
        return np.asarray(displacement[:, TILT].mean(axis=0))
    slope = distance @ displacement[:, :2] / (distance @ distance)  # of u_x and u_y over z
    return np.array([-slope[1], slope[0]])


def _radial(system: System, index: int) -> list[str]:
    """Return the bearings of a rotor that hold it across its axis, by a force law or by their stiffness."""
    with_law = {
        system.supports.name[bearing.support]
        for bearing in system.bearings
        if bearing.directions[:, :2].any()
    }
    return [
        part.name
        for part in system.rotors[index].supports
        if part.name in with_law or part.seat_stiffness[0, 0] + part.seat_stiffness[1, 1] > 0.0
    ]


def _lead_torsion(system: System, index: int, motion: FloatArray) -> float:
    """Return the growth of the gap of mesh `index` over its common face by the twist of both shafts, m.

    The gap grows towards positive z of the table's driving gear, as by a misalignment. The twist is that of
    the bare shaft under each gear. The mesh torque enters the shaft at mid-face: relative to each other, the
    ends of the face turn by the same angle if it enters evenly along the face.
    """
    scene, line, mesh = system.scene, system.lines[index], system.scene.meshes[index]
    z_sense = -table_sense(
        scene, index, system.kinematics.mesh_sense[index]
    )  # table's z in that of the scene
    half_width, growth = 0.5 * common_face_width(scene, index), 0.0
    for name, side in ((mesh.driver, 1.0), (mesh.driven, -1.0)):
        shaft = scene.shaft_index(scene.gear(name).shaft)
        rotor = system.rotors[shaft]
        middle = float(line.point[2]) - rotor.shaft.origin[2]
        twist = 0.0  # angle by which the end of the face at higher z turns against the other end, rad
        if rotor.elastic is not None:  # linear between nodes: exact where torques act at nodes alone
            amplitudes = motion[elastic_columns(system.rotors, shaft)][rotor.elastic.twists]
            angles = rotor.elastic.torsion.shape @ amplitudes
            ends = [middle - half_width, middle + half_width]
            low, high = np.interp(ends, rotor.elastic.position, angles)
            twist = float(high - low)
        lever = side * float(line.gradient(rotor.center)[5])  # approach along the line per angle about z
        growth -= z_sense * lever * twist
    return growth


@dataclass(frozen=True)
class MeshAlignment:
    """The alignment of a mesh under a load case, mean over the mesh cycle.

    Misalignment is the tilt of the axes in the plane of action as growth of the gap over the common face
    width, towards positive z of the table's driving gear: F_beta before running-in.
    """

    name: str
    force: float = field(metadata=in_unit("n"))
    """Transverse mesh force, N."""
    misalignment: float = field(metadata=in_unit("m"))
    """Misalignment, mean over the cycle, m."""
    least: float = field(metadata=in_unit("m"))
    largest: float = field(metadata=in_unit("m"))
    """`least`, `largest`: Misalignment over the cycle, m."""
    causes: FloatArray = field(metadata=in_unit("m", "cause"))
    """Parts of the misalignment by `CAUSES`, m. Shape (6,)."""
    center_distance_change: float = field(metadata=in_unit("m"))
    """Change of the center distance, with the change that the scene sets, m."""
    lead_torsion: float = field(metadata=in_unit("m"))
    """Growth of the gap over the common face width by the twist of both shafts along it, m; not part of the
    misalignment.
    """
    load_arm: float = field(metadata=in_unit("m"))
    """Axial distance of the mesh force from mid-face of the table's driving gear, m; NaN: the force acts at
    mid-face.
    """
    in_table: bool = True
    """Whether the misalignments of the whole cycle lie within those of the table; true for a table of a
    single misalignment.
    """


def mesh_alignment(system: System, index: int, rest: Rest, strain: BearingStrain) -> MeshAlignment:
    """Return the alignment of mesh `index` in the rest positions; `strain` belongs to their mean."""
    scene, mesh, rotors = system.scene, system.scene.meshes[index], system.rotors
    line, sense = system.lines[index], system.kinematics.mesh_sense[index]
    motion = rest.motion.mean(axis=0)
    row = misalignment_gradient(scene, rotors, index, line, sense)
    misalignment = mesh.misalignment + rest.motion @ row  # over the positions of the cycle
    distance_change = float(distance_gradient(scene, rotors, index, line) @ motion)
    per_tilt = misalignment_per_tilt(scene, index, line, sense)[:2]
    driver, driven = (_gear_tilt(system, gear, motion, strain) for gear in (mesh.driver, mesh.driven))
    causes = (driver - driven) @ per_tilt
    causes[SET] += mesh.misalignment
    axis = np.asarray(mesh.table.misalignment)
    in_table = axis.size == 1 or bool(np.all((misalignment >= axis[0]) & (misalignment <= axis[-1])))
    return MeshAlignment(
        name=mesh.name,
        force=float(rest.mesh_force[:, index].mean()),
        misalignment=float(misalignment.mean()),
        least=float(misalignment.min()),
        largest=float(misalignment.max()),
        causes=causes,
        center_distance_change=mesh.center_distance_change + distance_change,
        lead_torsion=_lead_torsion(system, index, motion),
        load_arm=float(rest.load_arm[:, index].mean()),
        in_table=in_table,
    )
