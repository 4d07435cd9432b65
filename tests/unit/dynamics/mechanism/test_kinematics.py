"""Speed ratios through trains of gears, exact; positions that lose nothing over 1e7 steps."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, repeated, spring_table
from mesh_phases import flank_phase

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.meshes import GearMesh
from dynamics.motion.motion import write_motion
from dynamics.scene import Scene
from dynamics.shafts import GearBody, Inertia, Shaft

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
    mesh = GearMesh("m12", "h1", "g2", spring_table(1e8), nominal_force=1.0)
    return replace(scene, gears=(*scene.gears[:2], last, second), meshes=(*scene.meshes, mesh))


def test_two_stages_multiply():
    kinematics = solve_kinematics(two_stages(10.0))
    assert kinematics.ratio == ((1,), (Fraction(-17, 23),), (Fraction(17 * 13, 23 * 41),))


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
