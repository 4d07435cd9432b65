"""Alignment of a mesh: its misalignment by cause, its center distance, the twist of its gears."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.deflection.bearing_strain import BearingStrain
from dynamics.deflection.causes import CAUSES, SET, gear_tilt
from dynamics.deflection.rest import Rest
from dynamics.deflection.twist import lead_torsion
from dynamics.mechanism.flank_gradients import (
    distance_gradient,
    misalignment_gradient,
    misalignment_per_tilt,
)
from dynamics.types import FloatArray
from model_studies import Record, in_unit


@dataclass(frozen=True)
class MeshAlignment(Record):
    """The alignment of a mesh under a load case, mean over the mesh cycle.

    Misalignment is the growth of the gap over the common face width in the plane of action, towards positive
    z of the table's driving gear: F_beta before running-in.

    Attributes
    ----------
    name : str
    force : float
        Transverse, N.
    misalignment : float
        m.
    least, largest : float
        Misalignment over the cycle, m.
    causes : (6,) array
        Parts of the misalignment by `CAUSES`, m.
    center_distance_change : float
        m, with what the scene sets.
    lead_torsion : float
        Growth of the gap over the common face width by the twist of both shafts along it, m; not part of the
        misalignment.
    face_centroid : float
        Of the load, from mid-face of the table's driving gear, m; NaN: the force acts at mid-face.
    in_table : bool
        Whether the table has the misalignments of the whole cycle, or no such axis.
    """

    name: str
    force: float = field(metadata=in_unit("n"))
    misalignment: float = field(metadata=in_unit("m"))
    least: float = field(metadata=in_unit("m"))
    largest: float = field(metadata=in_unit("m"))
    causes: FloatArray = field(metadata=in_unit("m", "cause"))
    center_distance_change: float = field(metadata=in_unit("m"))
    lead_torsion: float = field(metadata=in_unit("m"))
    face_centroid: float = field(metadata=in_unit("m"))
    in_table: bool = True


def mesh_alignment(system: System, index: int, rest: Rest, strain: BearingStrain) -> MeshAlignment:
    """Return the alignment of mesh `index` in the rest positions, `strain` that of their mean."""
    scene, mesh, rotors = system.scene, system.scene.meshes[index], system.rotors
    line, sense = system.lines[index], system.kinematics.mesh_sense[index]
    motion = rest.motion.mean(axis=0)
    row = misalignment_gradient(scene, rotors, index, line, sense)
    course = mesh.misalignment + rest.motion @ row
    apart = float(distance_gradient(scene, rotors, index, line) @ motion)
    axis = np.asarray(mesh.table.misalignment)
    inside = axis.size == 1 or bool(np.all((course >= axis[0]) & (course <= axis[-1])))
    return MeshAlignment(
        mesh.name,
        float(rest.mesh_force[:, index].mean()),
        float(course.mean()),
        float(course.min()),
        float(course.max()),
        _causes(system, index, motion, strain),
        mesh.center_distance_change + apart,
        lead_torsion(system, index, motion),
        float(rest.centroid[:, index].mean()),
        inside,
    )


def _causes(system: System, index: int, motion: FloatArray, strain: BearingStrain) -> FloatArray:
    """Return the parts of the misalignment by cause, (causes,), m."""
    scene, mesh = system.scene, system.scene.meshes[index]
    sense = system.kinematics.mesh_sense[index]
    per_tilt = misalignment_per_tilt(scene, index, system.lines[index], sense)[:2]
    driver, driven = (gear_tilt(system, gear, motion, strain) for gear in (mesh.driver, mesh.driven))
    parts = (driver - driven) @ per_tilt
    parts[SET] += mesh.misalignment
    assert parts.size == len(CAUSES)
    return np.asarray(parts)
