"""Whole runs of trains with idlers, several stages, loops and planets: speeds, torques, energy."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import square_wave_table
from planetary_scenes import driven_scene, planetary_scene, published_set

from dynamics.bearings import Bushing
from dynamics.errors import InputError
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.mechanism.kinematics import solve_kinematics
from dynamics.meshes import GearMesh
from dynamics.scene import Integration, Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.simulation import simulate

RADIUS = 0.002  # base radius per tooth, m
CLOSENESS = 1.1  # center distance over the sum of base radii
TABLE = square_wave_table()
SPEED = TimeLaw.ramp(40.0, 80.0, 0.1)


def gear(name, shaft, teeth, position=0.05):
    inertia = Inertia(1.0, 0.4 * (RADIUS * teeth) ** 2, 1e-3)
    return GearBody(name, shaft, position, teeth, RADIUS * teeth, 0.02, 0.0, inertia)


def distance(a, b):
    return CLOSENESS * RADIUS * (a + b)


def scene_of(shafts, gears, links, loads, **changes):
    """Shafts {name: (x, y)} on two bushings each; links are pairs of gears."""
    return Scene(
        tuple(
            Shaft(name, 0.1, (*location, 0.0), Inertia(0.5, 1e-4, 1e-3)) for name, location in shafts.items()
        ),
        tuple(gears),
        tuple(GearMesh(f"{a}-{b}", a, b, TABLE) for a, b in links),
        (ImposedRotation("motor", next(iter(shafts)), SPEED),),
        0.05,
        bushings=tuple(Bushing(f"{name}.{end}", name, end, 1e8) for name in shafts for end in (0.0, 0.1)),
        loads=tuple(LoadTorque(f"on {name}", name, TimeLaw.constant(value)) for name, value in loads.items()),
        **changes,
    )


def idler_train():
    x = distance(21, 30)
    shafts = {"a": (0.0, 0.0), "b": (x, 0.0), "c": (x + distance(30, 45), 0.0)}
    gears = [gear("A", "a", 21), gear("B", "b", 30), gear("C", "c", 45)]
    return scene_of(shafts, gears, [("A", "B"), ("B", "C")], {"c": 150.0})


def two_stages():
    x = distance(21, 42)
    shafts = {"a": (0.0, 0.0), "b": (x, 0.0), "c": (x, distance(19, 57))}
    gears = [gear("A", "a", 21), gear("B", "b", 42, 0.03), gear("b", "b", 19, 0.07), gear("C", "c", 57, 0.07)]
    gears[0] = replace(gears[0], position=0.03)
    return scene_of(shafts, gears, [("A", "B"), ("b", "C")], {"c": 400.0})


def power_split(last=45):
    """Two idlers of equal size side by side between the same two gears."""
    half, up = distance(21, 30), 0.06
    across = np.sqrt(half**2 - up**2)
    out = across + np.sqrt(distance(30, last) ** 2 - up**2)
    shafts = {"a": (0.0, 0.0), "b": (across, up), "c": (across, -up), "d": (out, 0.0)}
    gears = [gear("A", "a", 21), gear("B", "b", 30), gear("C", "c", 30), gear("D", "d", last)]
    return scene_of(
        shafts,
        gears,
        [("A", "B"), ("A", "C"), ("B", "D"), ("C", "D")],
        {"d": 300.0},
    )


def with_forces(scene, force):
    return replace(scene, meshes=tuple(replace(mesh, nominal_force=force) for mesh in scene.meshes))


PLANETS = published_set(
    3, ring_phase=0.5, sun_table=TABLE, ring_table=TABLE, pin_errors=((0, 5e-6), (0, 0), (3e-6, 0))
)


def carrier_drives(gears):
    """The carrier driven, the ring held, the sun loaded: a step-up gear."""
    scene = driven_scene(gears, duration=0.05)
    carrier = ImposedRotation("input", "carrier", TimeLaw.ramp(10.0, 20.0, 0.1))
    load = LoadTorque("brake", "sun", TimeLaw.constant(300.0))
    return replace(scene, drives=(carrier, scene.drives[1]), loads=(load,))


SCENES = {
    "idler": idler_train(),
    "two stages": two_stages(),
    "power split": with_forces(power_split(), 1500.0),
    "planets, ring held": driven_scene(PLANETS, speed=SPEED, duration=0.05),
    "planets, ring held elastically": planetary_scene(PLANETS, ring_support=1e7, duration=0.05),
    "planets, rigid pins, no drive": planetary_scene(replace(PLANETS, planet_stiffness=None), duration=0.05),
    "planets, carrier drives": carrier_drives(replace(PLANETS, driver="ring", carrier_stiffness=5e6)),
    "planets, rigid pins": driven_scene(replace(PLANETS, planet_stiffness=None), speed=SPEED, duration=0.05),
}


@pytest.mark.parametrize("name", SCENES)
def test_energy_closes_and_torques_balance(name, record_figure):
    scene = replace(SCENES[name], integration=Integration(tolerance=1e-10))
    result = simulate(scene)
    record_figure(f"energy balance, {name}", 100 * result.energy.relative, "below 0.1 %", "%", "own target")
    assert result.energy.relative < 1e-3
    assert np.mean(result.mesh_force > 0.0) > 0.99


@pytest.mark.parametrize(("name", "ratio"), [("idler", 21 / 45), ("two stages", 21 / 42 * 19 / 57)])
def test_the_drive_carries_the_load_through_the_ratio(name, ratio):
    scene = SCENES[name]
    steady = replace(scene, drives=(replace(scene.drives[0], speed=TimeLaw.constant(60.0)),))
    result = simulate(steady)
    assert abs(result.speed[-1].mean()) == pytest.approx(60.0 * ratio, rel=1e-4)
    assert result.drive_torque[0].mean() == pytest.approx(scene.loads[0].torque.value[0] * ratio, rel=5e-3)


def test_both_paths_of_a_power_split_carry_the_load_and_between_rigid_bearings_the_same():
    """The bearings of the idlers give way differently on both sides of the line of centers."""
    scene = replace(SCENES["power split"], drives=(ImposedRotation("motor", "a", TimeLaw.constant(60.0)),))
    forces = simulate(scene).mesh_force.mean(axis=1)
    load = 300.0 / (RADIUS * 45)
    assert forces[2] + forces[3] == pytest.approx(load, rel=2e-3)
    assert abs(forces[2] / forces[3] - 1.0) > 0.1
    rigid = simulate(replace(scene, bushings=())).mesh_force.mean(axis=1)
    np.testing.assert_allclose(rigid, 0.5 * load, rtol=0.01)


def test_paths_of_different_ratio_are_refused_by_name():
    scene = power_split()
    other = replace(scene.gears[2], teeth=31, base_radius=RADIUS * 31)
    wrong = replace(scene, gears=(*scene.gears[:2], other, scene.gears[3], gear("D2", "d", 47, 0.02)))
    meshes = (*scene.meshes[:3], replace(scene.meshes[3], name="odd path", driven="D2"))
    with pytest.raises(InputError, match=r"meshes\[3\] = '-31/47'.*ratio -31/45"):
        solve_kinematics(replace(wrong, meshes=meshes))


def test_torques_of_a_planetary_set_are_those_of_its_ratios():
    """Sun 100 rad/s, ring held: T_sun = T_carrier z_s/(z_s + z_r), and the ring takes the rest."""
    scene = driven_scene(
        published_set(3, ring_phase=0.5, sun_table=TABLE, ring_table=TABLE), torque=2000.0, duration=0.05
    )
    result = simulate(scene)
    sun, ring = result.drive_torque.mean(axis=1)
    assert sun == pytest.approx(2000.0 * 27 / 126, rel=2e-3)
    assert ring == pytest.approx(2000.0 * 99 / 126, rel=2e-3)
    np.testing.assert_allclose(result.mesh_force.mean(axis=1), sun / (3 * 27 * 1.4e-3), rtol=2e-3)


def test_bearing_forces_of_a_central_member_turn_with_the_carrier():
    """One planet: the sun's bearing force has constant size in the fixed frame and turns with the carrier."""
    scene = driven_scene(published_set(1, teeth=(27, 36, 99)), torque=500.0, duration=0.2)
    result = simulate(scene)
    x, y = result.bearing_force[result.bearing.index("sun bearing"), :2]
    np.testing.assert_allclose(np.hypot(x, y), np.hypot(x, y).mean(), rtol=1e-3)
    turned = np.unwrap(np.arctan2(y, x))
    assert turned[-1] - turned[0] == pytest.approx(100.0 * 27 / 126 * 0.2, rel=1e-3)
