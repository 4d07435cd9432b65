"""Kinematics of mechanisms: speeds of trees and planetary sets, lines of action, base pitches."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, repeated, spring_table, with_gear
from mesh_phases import flank_phase
from planetary_scenes import driven_scene, planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.joints import FreeRotation, ImposedRotation
from dynamics.linearize import modal_analysis
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.mechanism.flank_gradients import common_face_width, misalignment_gradient
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.mechanism.line_of_action import line_of_action
from dynamics.meshes import GearMesh
from dynamics.motion.motion import write_motion
from dynamics.scene import Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.simulation import simulate

# Speed ratios through trains of gears, exact; positions that lose nothing over 1e7 steps.


INERTIA = Inertia(1.0, 1e-3, 1e-3)
RB = 0.002  # base radius per tooth


def train(teeth, links, speed=100.0, **changes):
    """Gears of the given teeth on shafts of their own along x; links are (driver, driven) indices."""
    x = np.concatenate([[0.0], np.cumsum([1.1 * RB * (a + b) for a, b in pairwise(teeth)])])
    shafts = tuple(Shaft(f"s{k}", 0.1, (float(x[k]), 0.0, 0.0)) for k in range(len(teeth)))
    gears = tuple(
        GearBody(f"g{k}", f"s{k}", 0.05, z, RB * z, 0.02, 0.0, INERTIA) for k, z in enumerate(teeth)
    )
    meshes = tuple(
        GearMesh(f"m{a}{b}", f"g{a}", f"g{b}", spring_table(1e8), nominal_force=1.0) for a, b in links
    )
    return Scene(
        shafts, gears, meshes, (ImposedRotation("d", "s0", TimeLaw.constant(speed)),), 0.1, **changes
    )


def test_an_idler_turns_back_and_keeps_the_ratio_of_its_neighbors():
    kinematics = solve_kinematics(train([17, 23, 41], [(0, 1), (1, 2)]))
    assert kinematics.ratio == ((1,), (Fraction(-17, 23),), (Fraction(17, 41),))
    assert kinematics.sense == (1, -1, 1)


def test_meshes_may_be_listed_in_any_order_and_drive_backwards():
    kinematics = solve_kinematics(train([17, 23, 41], [(1, 2), (0, 1)], speed=-5.0))
    assert kinematics.ratio[2] == (Fraction(17, 41),)
    assert kinematics.sense == (-1, 1, -1)


def test_a_shaft_off_the_drive_is_refused():
    with pytest.raises(InputError, match=r"shafts\[2\]"):
        solve_kinematics(train([17, 23, 41], [(0, 1)]))


def test_a_loop_that_asks_for_two_speeds_is_refused():
    with pytest.raises(InputError, match="as other meshes require"):
        solve_kinematics(train([17, 23, 41], [(0, 1), (1, 2), (0, 2)]))


def test_a_gear_cannot_mesh_with_its_own_shaft():
    scene = train([17, 23], [(0, 1)])
    gears = (scene.gears[0], replace(scene.gears[1], shaft="s0"))
    with pytest.raises(InputError, match=r"meshes\[0\]\.driven"):
        solve_kinematics(replace(scene, gears=gears))


def test_load_flows_through_a_train():
    scene = train([17, 23, 41], [(0, 1), (1, 2)])
    meshes = tuple(replace(mesh, nominal_force=None) for mesh in scene.meshes)
    loads = (LoadTorque("l", "s2", TimeLaw.constant(50.0)),)
    forces = assemble(replace(scene, meshes=meshes, loads=loads)).flanks.nominal_force
    np.testing.assert_allclose(forces, 50.0 / (RB * 41), rtol=1e-12)  # the idler passes its force on


def test_a_load_that_drives_is_refused():
    with pytest.raises(InputError, match="driving flank"):
        assemble(gear_pair_scene(torque=-5.0))


def two_stages(speed):
    """17 on 23; on the same shaft 13 drives 41: 17 and 17 * 13 / 23 base pitches per turn of the drive."""
    scene = train([17, 23, 41], [(0, 1)], speed)
    second = GearBody("h1", "s1", 0.09, 13, RB * 13, 0.02, 0.0, INERTIA)
    last = replace(scene.gears[2], position=0.09)
    mesh = GearMesh("m12", "h1", "g2", spring_table(1e8), nominal_force=1.0, position_offset=0.0)
    return replace(scene, gears=(*scene.gears[:2], last, second), meshes=(*scene.meshes, mesh))


def phase_of(reference, flank, whole, fraction):
    return flank_phase(reference, flank, np.array([[whole, fraction, 0.0, 0.0]]))


def test_position_keeps_nine_digits_of_a_base_pitch_after_ten_million_steps():
    """Step 1e-5 s at 955 rpm through two stages: compared with exact rational arithmetic."""
    speed = 955.0 * RPM
    reference = assemble(two_stages(speed)).arrays.reference
    for steps in (10_000_000, 9_999_999, 12_345_678):
        time = steps * 1e-5
        motion = np.empty((1, 4))
        write_motion(reference, time, np.zeros(1, dtype=np.int64), motion)
        turns = Fraction(speed) * Fraction(time) / Fraction(2 * math.pi)
        for flank, per_turn in enumerate((Fraction(17), Fraction(17 * 13, 23))):
            exact = float(per_turn * turns % 1)
            error = flank_phase(reference, flank, motion) - exact
            assert abs(error - round(error)) < 1e-9


def test_phase_of_a_hunting_cycle_is_exact_after_ten_million_pitches():
    """17 pitches a revolution, period 23: after whole revolutions the pitch is an integer without error."""
    scene = two_stages(10.0)
    meshes = tuple(replace(mesh, table=repeated(spring_table(1e8), 23)) for mesh in scene.meshes)
    reference = assemble(replace(scene, meshes=meshes)).arrays.reference
    for turns in (1, 588_236, 10**7, 10**12 + 7):
        assert phase_of(reference, 0, float(turns), 0.0) == 17 * turns % 23
        exact = Fraction(17 * 13 * turns, 23) % 23
        assert phase_of(reference, 1, float(turns), 0.0) == pytest.approx(float(exact), abs=1e-14)
    assert phase_of(reference, 0, -1.0, 0.5) == (-8.5) % 23


def test_whole_turns_drop_exactly():
    reference = assemble(two_stages(10.0)).arrays.reference
    for flank, repeats in ((0, 1), (1, 23)):
        assert phase_of(reference, flank, repeats * 1e12, 0.25) == phase_of(reference, flank, 0.0, 0.25)
    behind = phase_of(reference, 1, 1.0, 0.0) - phase_of(reference, 1, 0.0, 0.0)
    assert behind % 1.0 == pytest.approx(17 * 13 % 23 / 23, abs=1e-12)


# Speeds of planetary sets and coupled trains (Willis), several drives, what is refused.


GEARS = published_set(3)
SUN, PLANET, RING = GEARS.teeth


def drive(shaft, speed=100.0):
    return ImposedRotation(f"{shaft} drive", shaft, TimeLaw.constant(speed))


def ratios(*shafts):
    """Ratios of sun, ring, carrier, planet 1 to the speeds imposed on `shafts`."""
    scene = replace(driven_scene(GEARS), drives=tuple(drive(s, 60.0 + 10 * i) for i, s in enumerate(shafts)))
    return solve_kinematics(scene).ratio


@pytest.mark.parametrize(
    "pair", [("sun", "ring"), ("sun", "carrier"), ("carrier", "ring"), ("planet 1", "ring")]
)
def test_two_speeds_set_all_others_by_willis(pair):
    """z_s (w_s - w_c) + z_r (w_r - w_c) = 0 and z_s (w_s - w_c) + z_p (w_p - w_c) = 0 for each law."""
    rows = ratios(*pair)
    for law in range(2):
        sun, ring, carrier, *planets = (row[law] for row in rows)
        assert SUN * (sun - carrier) == -RING * (ring - carrier)
        assert all(SUN * (sun - carrier) == -PLANET * (planet - carrier) for planet in planets)


def test_mesh_rate_is_that_of_the_sun_against_its_carrier():
    rate = solve_kinematics(driven_scene(GEARS)).mesh_rate
    assert {row[0] for row in rate} == {SUN * (1 - Fraction(SUN, SUN + RING))}


def test_a_third_drive_is_refused():
    scene = driven_scene(GEARS)
    with pytest.raises(InputError, match=r"drives\[2\]\.shaft.*no other drive sets"):
        solve_kinematics(replace(scene, drives=(*scene.drives, drive("carrier", 3.0))))


def test_too_few_drives_are_refused_and_a_free_rotation_helps():
    scene = replace(driven_scene(GEARS), drives=(drive("sun"),))
    with pytest.raises(InputError, match=r"shafts\[1\].*ring.*free rotation"):
        solve_kinematics(scene)
    free = solve_kinematics(replace(scene, free_rotations=(FreeRotation("f", "carrier", 20.0),)))
    assert free.imposed == {0}
    assert free.ratio[2] == (0, 1)


def test_a_mesh_that_turns_with_its_carrier_is_refused():
    speeds = (drive("sun", 50.0), drive("carrier", 50.0))
    with pytest.raises(InputError, match="turns against its carrier"):
        solve_kinematics(replace(driven_scene(GEARS), drives=speeds))


def test_gears_in_different_frames_do_not_mesh():
    scene = planetary_scene(GEARS)
    fixed = (replace(scene.shafts[0], frame=None), *scene.shafts[1:])
    with pytest.raises(InputError, match=r"meshes\[0\]\.driven.*same frame"):
        solve_kinematics(replace(scene, shafts=fixed))


def test_planets_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match=r"planets = 4.*divisor of z_sun \+ z_ring = 126"):
        published_set(4, teeth=TEETH_OF_THREE)
    with pytest.raises(InputError, match=r"angles\[1\].*2\.0943951"):
        published_set(3, angles=(0.0, 2.1, 4.2))


TEETH_OF_THREE = published_set(3).teeth


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"frame": "nobody"}, r"shafts\[0\]\.frame"),
        ({"frame": "planet 1"}, r"shafts\[0\]\.frame"),
        ({"origin": (0.01, 0.0, 0.0)}, r"bushings\[0\]\.shaft"),
    ],
)
def test_frames_are_those_of_carriers(change, field):
    scene = planetary_scene(GEARS)
    with pytest.raises(InputError, match=field):
        replace(scene, shafts=(replace(scene.shafts[0], **change), *scene.shafts[1:]))


# Where the mesh force acts: action = reaction, torques, axial thrust, driving side.


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


# Base pitches that the printing of radii sets apart are made one, and said; wider ones are refused.


def printed(ratio: float) -> Scene:
    """A wheel of 40 teeth whose base radius is off by `ratio`."""
    scene = with_gear(
        gear_pair_scene(duration=0.005), 1, teeth=40, base_radius=2.0 * BASE_RADIUS * (1.0 + ratio)
    )
    shafts = (scene.shafts[0], replace(scene.shafts[1], origin=(0.12, 0.0, 0.0)))
    return replace(scene, shafts=shafts)


@pytest.mark.parametrize("ratio", [5e-4, -8e-4, 1e-7])
def test_radii_as_printed_run_and_the_correction_is_stated(ratio):
    scene = printed(ratio)
    system = assemble(scene)
    pinion, wheel = system.scene.gears
    assert wheel.base_pitch == pytest.approx(pinion.base_pitch, rel=1e-14)
    # least squares of 20 and 40 teeth: a fifth of the difference stays with the wheel, four with the pinion
    assert wheel.base_radius / scene.gears[1].base_radius - 1.0 == pytest.approx(-0.2 * ratio, rel=2e-3)
    assert pinion.base_radius / BASE_RADIUS - 1.0 == pytest.approx(0.8 * ratio, rel=2e-3)
    run = simulate(scene)
    for said in (run.receipt, modal_analysis(system).metadata):
        stated = said["base_radius_corrected"]
        assert stated[wheel.name] == {"given": scene.gears[1].base_radius, "used": wheel.base_radius}
        assert set(stated) == {pinion.name, wheel.name}


def test_pitches_that_agree_stay_as_they_are_bit_by_bit():
    for ratio in (0.0, 1e-15):
        scene = printed(ratio)
        system = assemble(scene)
        assert system.scene is scene
        assert system.corrections == {}
    assert "base_radius_corrected" not in simulate(printed(0.0)).receipt


def test_wider_differences_are_refused():
    for ratio in (1.1e-3, -2e-3):
        with pytest.raises(
            InputError, match=r"must agree to 0\.001; smaller differences are corrected"
        ) as caught:
            assemble(printed(ratio))
        assert caught.value.field == "meshes[0].driven"


def test_a_train_gets_one_pitch():
    """Two meshes in a row: a gear between two others is corrected once, by all three."""
    scene = printed(6e-4)
    third = replace(scene.gears[0], name="third", base_radius=BASE_RADIUS * (1.0 - 3e-4))
    shaft = replace(scene.shafts[0], name="third", origin=(0.24, 0.0, 0.0))
    gears = (*scene.gears, replace(third, shaft="third"))
    mesh = replace(
        scene.meshes[0], name="second", driver=scene.gears[1].name, driven="third", nominal_force=1.0
    )
    moved = tuple(replace(b, name=f"{b.name} 3", shaft="third") for b in scene.bushings if b.shaft == "input")
    whole = replace(
        scene,
        shafts=(*scene.shafts, shaft),
        gears=gears,
        meshes=(replace(scene.meshes[0], nominal_force=1.0), mesh),
        bushings=(*scene.bushings, *moved),
    )
    pitches = [gear.base_pitch for gear in assemble(whole).scene.gears]
    np.testing.assert_allclose(pitches, pitches[0], rtol=1e-14)
