"""Gradients of deflection, misalignment and center distance of a flank in the freedoms of its bodies.

A gradient is the derivative of a coordinate of the flank in the freedoms of all rotors.
"""

from __future__ import annotations

import numpy as np

from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import Wrench, gear_row
from dynamics.mechanism.line_of_action import UNIT_Z, LineOfAction, common_face, cross
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def approach(scene: Scene, rotors: Bodies, index: int, line: LineOfAction) -> FloatArray:
    """Return the derivative of the approach along `line` of mesh `index` in all rotors' freedoms, (N,)."""
    mesh = scene.meshes[index]
    sides: list[tuple[str, Wrench]] = [
        (mesh.driver, line.gradient),
        (mesh.driven, lambda center: -line.gradient(center)),
    ]
    return gear_row(scene, rotors, sides)


def table_sense(scene: Scene, index: int, sense: int) -> int:
    """Return the sense about +z in which the table's driving gear pushes, +1 or -1.

    A ring gear that drives is pushed back by the table's driving gear, the pinion.
    """
    return -sense if scene.gear(scene.meshes[index].driver).internal else sense


def common_face_width(scene: Scene, index: int) -> float:
    """Return the axial length over which the faces of both gears overlap, m."""
    low, high = common_face(scene, index)
    return high - low


def middle_from_driver(scene: Scene, index: int, line: LineOfAction, sense: int) -> float:
    """Return the face position of the middle of the common face from that of the table's driving gear, m."""
    mesh = scene.meshes[index]
    gear = scene.gear(mesh.driver)
    if gear.internal:
        gear = scene.gear(mesh.driven)
    middle = scene.shaft(gear.shaft).origin[2] + gear.position
    return -table_sense(scene, index, sense) * float(line.point[2] - middle)


def misalignment_per_tilt(scene: Scene, index: int, line: LineOfAction, sense: int) -> FloatArray:
    """Return the derivative of the misalignment in the small rotation of the driver's section, (3,), m/rad.

    The table's face position runs against the scene's z for a driving gear that turns in +z, so the gap grows
    with it by s b (z x n) per rotation over the face width b, n the transverse line of action.
    """
    transverse = line.force * np.array([1.0, 1.0, 0.0])
    turn = cross(UNIT_Z, transverse) * table_sense(scene, index, sense)
    return np.asarray(turn * common_face_width(scene, index))


def misalignment_gradient(
    scene: Scene, rotors: Bodies, index: int, line: LineOfAction, sense: int
) -> FloatArray:
    """Return the derivative of the misalignment in all rotors' freedoms, (N,).

    m = (tilt_1 - tilt_2) @ `misalignment_per_tilt`.
    """
    mesh = scene.meshes[index]
    moment = np.concatenate([np.zeros(3), misalignment_per_tilt(scene, index, line, sense)])
    return gear_row(scene, rotors, [(mesh.driver, lambda _: moment), (mesh.driven, lambda _: -moment)])


def distance_gradient(scene: Scene, rotors: Bodies, index: int, line: LineOfAction) -> FloatArray:
    """Return the derivative of the center distance at mid-face in all rotors' freedoms, (N,)."""
    mesh = scene.meshes[index]
    first, second = (scene.shaft(scene.gear(name).shaft) for name in (mesh.driver, mesh.driven))
    offset = np.subtract(second.origin, first.origin)
    offset = offset * np.array([1.0, 1.0, 0.0]) / np.hypot(offset[0], offset[1])

    def motion(center: FloatArray) -> FloatArray:
        """Return the displacement away from the driver per displacement and rotation of a gear."""
        return np.concatenate([offset, cross((line.point[2] - center[2]) * UNIT_Z, offset)])

    return gear_row(scene, rotors, [(mesh.driver, lambda c: -motion(c)), (mesh.driven, motion)])
