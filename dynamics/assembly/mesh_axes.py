"""How misalignment and center distance of a mesh follow from its bodies, and how far the load moves them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.assembly.connections import elastic_matrices
from dynamics.assembly.flank_elements import approach
from dynamics.assembly.flanks import Flanks
from dynamics.effects import MeshAxes
from dynamics.forces.gear_mesh import GearMesh
from dynamics.mechanism.columns import gear_row
from dynamics.mechanism.freedoms import ROTATION, Freedoms
from dynamics.mechanism.line_of_action import LineOfAction
from dynamics.mechanism.rotor import Rotor
from dynamics.mechanism.supports import Supports
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

UNIT_Z = np.array([0.0, 0.0, 1.0])


def table_sense(scene: Scene, index: int, sense: int) -> int:
    """Return the sense about +z in which the table's driving gear pushes, +1 or -1.

    A ring gear that drives is pushed back by the table's driving gear, the pinion.
    """
    return -sense if scene.gear(scene.meshes[index].driver).internal else sense


def common_face_width(scene: Scene, index: int) -> float:
    """Axial length over which both gears' faces overlap, m."""
    ends = []
    for name in (scene.meshes[index].driver, scene.meshes[index].driven):
        gear = scene.gear(name)
        middle = scene.shafts[scene.shaft_index(gear.shaft)].origin[2] + gear.position
        ends.append((middle - gear.face_width / 2.0, middle + gear.face_width / 2.0))
    return min(end[1] for end in ends) - max(end[0] for end in ends)


def middle_from_driver(scene: Scene, index: int, line: LineOfAction, sense: int) -> float:
    """Face position of the middle of the common face from that of the table's driving gear, m."""
    mesh = scene.meshes[index]
    gear = scene.gear(mesh.driver)
    if gear.internal:
        gear = scene.gear(mesh.driven)
    middle = scene.shafts[scene.shaft_index(gear.shaft)].origin[2] + gear.position
    return -table_sense(scene, index, sense) * float(line.point[2] - middle)


def misalignment_gradient(
    scene: Scene, rotors: Sequence[Rotor], index: int, line: LineOfAction, sense: int
) -> FloatArray:
    """Return the derivative of the misalignment in all rotors' freedoms, (N,).

    The table's face position runs against the scene's z for a driving gear that turns in +z, so the gap grows
    with it by m = s b (tilt_1 - tilt_2) (z x n) over the face width b, n the transverse line of action.
    """
    mesh, transverse = scene.meshes[index], line.force * np.array([1.0, 1.0, 0.0])
    turn = np.cross(UNIT_Z, transverse) * table_sense(scene, index, sense) * common_face_width(scene, index)
    moment = np.concatenate([np.zeros(3), turn])
    return gear_row(scene, rotors, [(mesh.driver, lambda _: moment), (mesh.driven, lambda _: -moment)])


def distance_gradient(scene: Scene, rotors: Sequence[Rotor], index: int, line: LineOfAction) -> FloatArray:
    """Return the derivative of the center distance at mid-face in all rotors' freedoms, (N,)."""
    mesh = scene.meshes[index]
    shafts = [scene.shaft_index(scene.gear(name).shaft) for name in (mesh.driver, mesh.driven)]
    apart = np.subtract(scene.shafts[shafts[1]].origin, scene.shafts[shafts[0]].origin)
    apart = apart * np.array([1.0, 1.0, 0.0]) / np.hypot(apart[0], apart[1])

    def pulled(center: FloatArray) -> FloatArray:
        return np.concatenate([apart, np.cross((line.point[2] - center[2]) * UNIT_Z, apart)])

    return gear_row(scene, rotors, [(mesh.driver, lambda c: -pulled(c)), (mesh.driven, pulled)])


def sliding_gradients(
    scene: Scene, rotors: Sequence[Rotor], index: int, line: LineOfAction, driving: int
) -> FloatArray:
    """Return the derivatives of sliding at the pitch point and of rolling on it, (2, N).

    A contact at y n from the pitch point slides at (w_1 - w_2) y along z x n, whichever flank it is on: the
    first row is the relative displacement along that direction, the second the relative rotation times the
    driver's base radius, each in the sense in which the load slides at the y > 0 of the table. Where a ring
    gear drives, that y runs against n and w_1 - w_2 against the sense `driving` of the driving flank.
    """
    mesh = scene.meshes[index]
    sign = table_sense(scene, index, driving)
    across = driving * np.cross(UNIT_Z, line.force * np.array([1.0, 1.0, 0.0]))
    radius = scene.gear(mesh.driver).base_radius
    rolled = np.zeros(6)
    rolled[ROTATION] = sign * radius

    def slid(center: FloatArray) -> FloatArray:
        return np.concatenate([across, np.cross(line.point - center, across)])

    sliding = gear_row(scene, rotors, [(mesh.driver, slid), (mesh.driven, lambda c: -slid(c))])
    rolling = gear_row(scene, rotors, [(mesh.driver, lambda _: rolled), (mesh.driven, lambda _: -rolled)])
    return np.stack([sliding, rolling])


def mesh_axes(
    scene: Scene,
    rotors: Sequence[Rotor],
    senses: Sequence[int],
    lines: Sequence[LineOfAction],
    freedoms: Freedoms,
    supports: Supports,
    flanks: Flanks,
) -> list[MeshAxes]:
    """Return each mesh's table axes and how far the nominal force moves along them on the supports."""
    bends = ~freedoms.turns
    moves = freedoms.keep(supports.motion)
    held = supports.matrix(supports.stiffness, moves, moves) + elastic_matrices(rotors, freedoms)[0]
    compliance = np.linalg.pinv(held[np.ix_(bends, bends)])
    found = []
    for index, mesh in enumerate(scene.meshes):
        line, sense, force = lines[index], senses[index], float(flanks.nominal_force[index])
        pushed, m, a = (
            freedoms.keep(row)[bends]
            for row in (
                approach(scene, rotors, index, line),
                misalignment_gradient(scene, rotors, index, line, sense),
                distance_gradient(scene, rotors, index, line),
            )
        )
        lever = _largest_lever(mesh, force, common_face_width(scene, index))
        found.append(
            MeshAxes(
                variable=mesh.technique == "variable_torque",
                derivatives=getattr(mesh.table, "deflection_derivative", None) is not None,
                misalignments=np.size(mesh.table.misalignment),
                center_distances=np.size(mesh.table.center_distance_change),
                tilts=bool(np.any(m != 0.0)),
                moves_apart=bool(np.any(a != 0.0)),
                misaligned=_change(mesh, force, 0, -force * float(m @ compliance @ pushed)),
                apart=_change(mesh, force, 1, -force * float(a @ compliance @ pushed)),
                lever=lever,
                moment=None if lever is None else force * lever**2 * float(m @ compliance @ m),
                friction=mesh.friction,
                slides=getattr(mesh.table, "sliding_lever", None) is not None,
                slowed=_slowed(scene, index, force, float(flanks.mean_stiffness[index])),
            )
        )
    return found


def _largest_lever(mesh: GearMesh, force: float, face_width: float) -> float | None:
    """Largest offset of the load's centroid over the face width near the nominal force; None: not known."""
    centroid = getattr(mesh.table, "face_centroid", None)
    if centroid is None:
        return None
    level = int(np.argmin(np.abs(np.asarray(mesh.table.level) - force)))
    return float(np.max(np.abs(np.asarray(centroid)[..., level]))) / face_width


def _slowed(scene: Scene, index: int, force: float, stiffness: float) -> float:
    """Return the deflection of the force that the largest friction torque adds or takes, m."""
    mesh = scene.meshes[index]
    arm = getattr(mesh.table, "sliding_lever", None)
    if arm is None or mesh.friction is None:
        return 0.0
    share = mesh.friction * float(np.max(np.asarray(arm))) / scene.gear(mesh.driven).base_radius
    return share * force / stiffness


def _change(mesh: GearMesh, force: float, axis: int, moved: float) -> float:
    """Return how the mean transmission error changes as `axis` of the table moves by `moved`, m."""
    knots = np.asarray((mesh.table.misalignment, mesh.table.center_distance_change)[axis], dtype=float)
    at = (mesh.misalignment, mesh.center_distance_change)[axis]
    level = int(np.argmin(np.abs(np.asarray(mesh.table.level) - force)))
    mean = np.mean(np.asarray(mesh.table.deflection)[..., level], axis=-1)
    along = mean.mean(axis=1 - axis)
    return float(abs(np.interp(at + moved, knots, along) - np.interp(at, knots, along)))
