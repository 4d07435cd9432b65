"""The twist of gears along their faces, as a deviation of the lead."""

from __future__ import annotations

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import elastic_columns
from dynamics.mechanism.flank_gradients import common_face_width, table_sense
from dynamics.types import FloatArray


def twist(rotors: Bodies, index: int, position: FloatArray, motion: FloatArray) -> FloatArray:
    """Return the elastic rotation (P,) of sections at `position` (P,) along a shaft, rad.

    Linear between nodes: exact where torques act at nodes alone.
    """
    elastic = rotors[index].elastic
    if elastic is None:
        return np.zeros_like(position)
    turned = elastic.torsion.shape @ motion[elastic_columns(rotors, index)][elastic.twists]
    return np.asarray(np.interp(position, elastic.position, turned))


def lead_torsion(system: System, index: int, motion: FloatArray) -> float:
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
        middle = float(line.point[2]) - rotor.shaft.origin[2]
        ends = twist(system.rotors, shaft, np.array([middle - half, middle + half]), motion)
        lever = side * float(line.gradient(rotor.center)[5])
        grown -= towards * lever * float(ends[1] - ends[0])
    return grown
