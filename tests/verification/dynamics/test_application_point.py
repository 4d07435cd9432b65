"""Where along the path of contact the teeth push: forces at the points of contact, by hand, on both gears.

The mesh force acts along the line on which its points of application move. Along the path of contact they
change the moments of its axial part and of friction alone; both are in the tables.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, with_gear, with_mesh
from sliced_face import rigid_share_database, sliced_database

from dynamics import Scene, TimeLaw
from dynamics.assembly.assemble import System, assemble
from dynamics.integrators import static_equilibrium
from dynamics.mechanism.rotor import build_rotor
from dynamics.motion.force_balance import force_balance
from fe_contact.ste.load_levels import SMOOTHING

PITCH = 2.0 * math.pi * BASE_RADIUS / 20
UP = np.array([0.0, 0.0, 1.0])
MU = 0.07
ON = {"tilt": "on", "axial": "on", "moving_application_point": "on"}
OFF = ON | {"moving_application_point": "off"}


def scene_of(helix: float = 0.0, sense: int = 1, arm: float = 0.0, effects=ON, **mesh) -> Scene:
    """Return a pair whose load has an arm of so many m at every position and load; gears off the middle."""
    table = sliced_database((-1e-6, 0.0, 1e-6)).force_table()
    table = replace(table, load_arm=np.full_like(table.load_arm, arm))
    scene = gear_pair_scene(table, speed=TimeLaw.constant(sense * 900.0 * RPM))
    for index, hand in enumerate((1, -1)):
        scene = with_gear(scene, index, position=0.06, base_helix_angle=hand * helix)
    return replace(with_mesh(scene, **mesh), effects=effects)


def wrenches(system: System) -> tuple[float, np.ndarray]:
    """Return the mesh force, N, and the wrenches on both rotors about their centers, (2, 6), at rest."""
    q = static_equilibrium(system).displacement
    found = force_balance(system.arrays, 0.0, q, 0.0 * q, 0.0 * q).local
    (element,) = system.elements
    rows = element.gradient.reshape(-1, 2, 6)
    force = found.force[: len(rows)]
    return float(force[0]), -np.einsum("r,rbk->bk", force, rows)


def at_points(system: System, scene: Scene, forces: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the wrenches (2, 6) of forces (n, 3) on the driven gear at points (n, 3), and of reactions."""
    centers = [build_rotor(scene, shaft).center for shaft in scene.shafts]
    found = []
    for sign, center in zip((-1.0, 1.0), centers, strict=True):
        moment = np.cross(points - center, sign * forces).sum(axis=0)
        found.append(np.concatenate([sign * forces.sum(axis=0), moment]))
    return np.array(found)


def along(system: System) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pitch point in mid-face, the transverse line of action and the force per mesh force."""
    line = system.lines[0]
    return line.point, line.force * [1.0, 1.0, 0.0], line.force


@pytest.mark.law
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("way", [-0.8, 0.0, 0.6])
def test_along_the_path_of_contact_a_spur_force_has_the_same_moments(way, sense):
    """Two pairs a base pitch apart share the load: force times lever on both gears, wherever they touch."""
    scene = scene_of(sense=sense)
    system = assemble(scene)
    force, found = wrenches(system)
    pitch_point, n, unit = along(system)
    share = np.array([0.3, 0.7])
    points = pitch_point + np.outer((way + np.array([0.0, 1.0])) * PITCH, n)
    by_hand = at_points(system, scene, force * np.outer(share, unit), points)
    np.testing.assert_allclose(found, by_hand, rtol=0.0, atol=1e-9 * force)
    # the lever of each gear: from its axis to the line through the points, a tangent to its base circle
    for body, radius in enumerate((BASE_RADIUS, BASE_RADIUS)):
        lever = np.linalg.norm(np.cross(points[1] - [*scene.shafts[body].origin[:2], points[1][2]], n))
        assert abs(found[body, 5]) == pytest.approx(force * lever, rel=1e-9)
        assert lever == pytest.approx(radius, rel=1e-9)


@pytest.mark.law
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("helix", [0.35, -0.35])
def test_a_helical_force_is_moved_along_face_and_path(helix, sense):
    """Its axial part has the lever xi: all six components on both gears, and what a fixed point lacks."""
    face, xi = 4e-3, 0.6 * PITCH  # along the face of the table, which runs against z for the sense +1
    scene = scene_of(helix, sense, face - xi * math.tan(helix))
    system = assemble(scene)
    force, found = wrenches(system)
    pitch_point, n, unit = along(system)
    point = pitch_point + xi * n - sense * face * UP
    np.testing.assert_allclose(
        found, at_points(system, scene, force * unit[None], point[None]), rtol=0.0, atol=1e-9 * force
    )
    fixed = replace(scene, effects=OFF)
    force, found = wrenches(assemble(fixed))
    lacking = at_points(system, scene, force * unit[None], point[None]) - found
    moment = np.linalg.norm(lacking[:, 3:], axis=1)
    np.testing.assert_allclose(moment, force * abs(face - xi * math.tan(helix)), rtol=1e-9)


@pytest.mark.law
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("position", [0.1, 0.5, 0.9])
def test_friction_acts_at_the_points_of_contact(position, sense):
    """mu F c_j across the line of action at each pair, in the sense of its side of the pitch point."""
    table = rigid_share_database().force_table()
    scene = gear_pair_scene(table, speed=TimeLaw.constant(sense * 900.0 * RPM))
    scene = replace(with_mesh(scene, friction=MU, position_offset=position), effects={"tilt": "on"})
    system = assemble(scene)
    q = static_equilibrium(system).displacement
    found = force_balance(system.arrays, 0.0, q, 0.0 * q, 0.0 * q).local
    rows = system.elements[0].gradient.reshape(-1, 2, 6)
    force = float(found.force[0])
    wrench = -np.einsum("r,rbk->bk", found.force[1 : len(rows)], rows[1:])
    pitch_point, n, _ = along(system)
    touching = [y for y in (position - 1.0, position, position + 1.0) if abs(y) <= 0.78]
    way = np.array(touching) * PITCH
    # the driver's flank slides against the driven one by (w_1 - w_2) y along z x n, and drags it along
    smoothed = way / np.hypot(way, SMOOTHING * PITCH)
    across = sense * smoothed[:, None] * np.cross(UP, n)
    dragged = MU * force / len(way) * across
    by_hand = at_points(system, scene, dragged, pitch_point + np.outer(way, n))
    np.testing.assert_allclose(wrench[:, :3], by_hand[:, :3], rtol=0.0, atol=1e-9 * MU * force)
    np.testing.assert_allclose(wrench[:, 5], by_hand[:, 5], rtol=0.0, atol=1e-9 * MU * force * PITCH)
    fixed = at_points(system, scene, dragged, np.tile(pitch_point, (len(way), 1)))
    assert np.abs(fixed[:, 5] - by_hand[:, 5]).min() > 0.09 * MU * force * PITCH
