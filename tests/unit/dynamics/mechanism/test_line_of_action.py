"""Where the mesh force acts: action = reaction, torques, axial thrust, driving side."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, with_gear

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.loads import TimeLaw
from dynamics.mechanism.line_of_action import common_face_width, line_of_action, misalignment_gradient


def helical(scene, angle):
    return with_gear(with_gear(scene, 0, base_helix_angle=angle), 1, base_helix_angle=-angle)


def moved(scene, x, y):
    """The driven shaft at another angle around the driver."""
    shafts = (scene.shafts[0], replace(scene.shafts[1], origin=(x, y, 0.0)))
    return replace(scene, shafts=shafts)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("helix", [0.0, 0.3, -0.2])
@pytest.mark.parametrize("turn", [0.0, 1.0, 2.5, -1.2])
def test_action_is_reaction_in_force_and_moment(sense, helix, turn):
    scene = moved(helical(gear_pair_scene(), helix), 0.08 * math.cos(turn), 0.08 * math.sin(turn))
    scene = replace(scene, effects={"lateral": "on", "axial": "on", "tilt": "on"})
    system = assemble(
        replace(scene, drives=(replace(scene.drives[0], speed=TimeLaw.constant(sense * 90.0)),))
    )
    gradient = np.zeros((2, 6))
    locations = [int(location) for location in system.freedoms.column]
    for column, location in enumerate(locations):
        gradient[location // 6, location % 6] = -system.arrays.direction[0, column]
    gradient[0, 5] = -system.arrays.drive.direction[0, 0]
    centers = [np.add(shaft.origin, (0.0, 0.0, 0.1)) for shaft in system.scene.shafts]
    np.testing.assert_allclose(gradient[0, :3] + gradient[1, :3], 0.0, atol=1e-15)
    moment = sum(gradient[k, 3:] + np.cross(centers[k], gradient[k, :3]) for k in range(2))
    np.testing.assert_allclose(moment, 0.0, atol=1e-15)


@pytest.mark.parametrize("sense", [1, -1])
def test_torques_are_force_times_base_radius_and_oppose_the_driver(sense):
    scene = gear_pair_scene(speed=TimeLaw.constant(sense * 90.0))
    system = assemble(scene)
    rotation = system.freedoms.name.index("output.rotation")
    # generalized force = -gradient: on the driver against its motion, on the driven gear with its own
    assert -system.arrays.drive.direction[0, 0] == pytest.approx(-sense * BASE_RADIUS, rel=1e-12)
    assert -system.arrays.direction[0, rotation] == pytest.approx(-sense * BASE_RADIUS, rel=1e-12)
    assert system.kinematics.sense == (sense, -sense)


def test_the_force_drives_and_separates():
    """Driver at the origin rotating in +z, driven gear on +x: pushed along +y, and away along +x."""
    line = line_of_action(gear_pair_scene(), 0, 1)
    alpha = math.radians(20.0)
    np.testing.assert_allclose(line.force, [math.sin(alpha), math.cos(alpha), 0.0], atol=1e-12)
    np.testing.assert_allclose(line.point, [0.04, 0.0, 0.1], atol=1e-15)
    assert line.working_pressure_angle == pytest.approx(alpha, rel=1e-12)


@pytest.mark.parametrize(("helix", "sense"), [(0.3, 1), (-0.3, 1), (0.3, -1)])
def test_axial_thrust_follows_the_screw(helix, sense):
    """A right-hand driver rotating in +z is a screw in the other's nut: pushed along +z (right-hand rule)."""
    line = line_of_action(helical(gear_pair_scene(), helix), 0, sense)
    on_driver = -line.force[2]
    assert on_driver == pytest.approx(sense * math.tan(helix))


def test_transmission_error_does_not_change_when_the_gears_roll():
    """Moving a right-hand gear along +z by p is turning it back by p tan(beta_b) / r_b."""
    scene = helical(gear_pair_scene(effects={"axial": "on"}), 0.3)
    system = assemble(scene)
    names = system.freedoms.name
    along = system.arrays.direction[0, names.index("input.z")]
    assert along == pytest.approx(-system.arrays.drive.direction[0, 0] * math.tan(0.3) / BASE_RADIUS)


def test_gears_that_cannot_mesh_are_refused():
    scene = gear_pair_scene()
    cases = [
        with_gear(scene, 1, teeth=21),
        with_gear(scene, 0, base_helix_angle=0.1),
        with_gear(scene, 1, position=0.13),
        moved(scene, 0.075, 0.0),
    ]
    for case in cases:
        with pytest.raises(InputError, match=r"meshes\[0\]\.driven"):
            assemble(case)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("helix", [0.3, -0.2])
def test_a_tilt_closes_the_gap_by_height_and_by_position_along_the_line_of_action(sense, helix):
    """r (z + xi' xi): what tables know of it, r z, is the misalignment; along a contact line r z/cos^2."""
    scene = moved(helical(gear_pair_scene(), helix), 0.08 * math.cos(0.7), 0.08 * math.sin(0.7))
    drive = replace(scene.drives[0], speed=TimeLaw.constant(sense * 90.0))
    system = assemble(replace(scene, drives=(drive,)))
    line, width = system.lines[0], common_face_width(scene, 0)
    row = misalignment_gradient(scene, system.rotors, 0, line, sense)[:6]
    tilt = row[3:] / np.linalg.norm(row[3:])  # of the driver, towards a larger gap at larger face positions
    transverse = line.force * np.array([1.0, 1.0, 0.0])
    slope = -line.force[2]  # d xi / d z along a line of contact, which is at right angles to the force
    assert abs(slope) == pytest.approx(math.tan(abs(helix)))

    def approach(xi, z):
        return float(np.cross(tilt, xi * transverse + z * np.array([0.0, 0.0, 1.0])) @ line.force)

    face = -sense  # of the table's face position along z
    for xi, z in ((0.0, 2e-3), (3e-3, 0.0), (-4e-3, 1e-3)):
        gap = np.linalg.norm(row[3:]) * face * (z + slope * xi) / width
        assert -approach(xi, z) == pytest.approx(gap, rel=1e-12)
    along = approach(2e-3 * slope, 2e-3)
    assert along == pytest.approx(approach(0.0, 2e-3) / math.cos(helix) ** 2, rel=1e-12)
