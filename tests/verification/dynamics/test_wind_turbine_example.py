"""The two-stage wind-turbine gearbox of the examples: ratios, torques, forces and moments by hand, energy.

On substitute tables: forces at rest follow from the balance of torques, whatever the tables.
"""

import math
import tomllib
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from repository import EXAMPLES
from small_table import small_table

from dynamics import Scene, simulate
from dynamics.assembly.assemble import assemble
from dynamics.integrators import static_equilibrium
from dynamics.mechanism.phases import frame_turns
from dynamics.motion.observation import local_state
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.checked_case import check_case
from lineofaction.gearbox.convert.scene import dynamic_scene
from lineofaction.gearbox.schemas import Case, read_model, validated
from lineofaction.gearbox.schemas.scene import SceneInput

Change = Callable[[dict[str, Any]], object]


def wind_turbine(change: Change = lambda _table: None) -> Scene:
    """Return the scene, its deflections those of spur gears 20/20 at the normal force of each mesh.

    Loads are beyond the small table, so that runs only report it: torques hold whatever the tables.
    """
    table = tomllib.loads((EXAMPLES / "wind_turbine_scene.toml").read_text(encoding="utf-8"))
    table["run"]["on_violation"] = "report"
    change(table)
    small = small_table()
    databases = {}
    for mesh in table["meshes"]:
        geometry = PairGeometry.of(check_case(read_model(Case, EXAMPLES / mesh["case_file"])))
        torque = small.force * math.cos(geometry.base_helix_angle) * geometry.base_radius[0]
        databases[mesh["name"]] = replace(small, geometry=geometry, torque=torque)
    return dynamic_scene(validated(SceneInput, table), databases)


TORQUE = 700.0  # N m on the generator
SUN, PLANET, RING, LARGE, PINION = 21, 39, 99, 97, 23
NORMAL = math.radians(20.0)
LOW, HIGH = math.radians(8.0), math.radians(14.0)


def steady(table):
    table["drives"][0].update(time_s=[0.0], speed_rpm=[55.0])


@pytest.fixture(scope="module")
def rest():
    """The system, its mesh forces and its bearings' forces at rest, by name."""
    system = assemble(wind_turbine(steady))
    found = static_equilibrium(system)
    assert found.status.usable
    q = found.displacement
    local = local_state(system.arrays, 0.0, q, 0.0 * q)
    force = system.bearing_force(local.force[:, None], q[None], 0.0 * q[None])[:, :3, 0]
    meshes = dict(zip((mesh.name for mesh in system.scene.meshes), found.mesh_force, strict=True))
    return system, meshes, dict(zip(system.supports.name, force, strict=True)), q


def transverse(helix):
    """Pressure angle in the transverse plane, base helix angle."""
    alpha = math.atan(math.tan(NORMAL) / math.cos(helix))
    return alpha, math.atan(math.tan(helix) * math.cos(alpha))


def pitch_radius(teeth, module, helix):
    return 0.5 * teeth * module / math.cos(helix)


def test_ratios_and_phases_are_exact():
    system = assemble(wind_turbine(steady))
    at = system.scene.shaft_index
    ratio, rates = system.kinematics.ratio, system.kinematics.mesh_rate
    set_ratio = 1 + Fraction(RING, SUN)
    assert ratio[at("sun")][0] == ratio[at("intermediate")][0] == set_ratio
    assert ratio[at("generator")][0] == -set_ratio * Fraction(LARGE, PINION)
    names = [mesh.name for mesh in system.scene.meshes]
    assert rates[names.index("sun mesh")][0] == rates[names.index("ring mesh 2")][0] == RING
    assert rates[names.index("high-speed mesh")][0] == LARGE * set_ratio
    (turn,) = frame_turns(system.scene, system.kinematics)
    assert turn[0] == 1  # the carrier's frame against the fixed one, per turn of the rotor
    reference = system.arrays.reference
    location = len(names)
    assert (reference.numerator[location, 0], reference.denominator[location, 0]) == (1, 1)
    for index, name in enumerate(("sun mesh", "sun mesh 2", "sun mesh 3")):
        expected = (SUN * index / 3.0) % 1.0  # 21 teeth over three planets: all in phase
        off = system.phases.position[names.index(name)] - expected
        assert off - round(off) == pytest.approx(0.0, abs=1e-9)


def test_torques_pass_through_both_stages(rest):
    system, meshes, _, _ = rest
    alpha, _ = transverse(HIGH)
    pinion = pitch_radius(PINION, 4e-3, HIGH) * math.cos(alpha)
    assert meshes["high-speed mesh"] == pytest.approx(TORQUE / pinion, rel=1e-6)
    alpha, _ = transverse(LOW)
    sun = pitch_radius(SUN, 5e-3, LOW) * math.cos(alpha)
    total = TORQUE * LARGE / PINION / sun
    for kind in ("sun", "ring"):
        forces = np.array([meshes[f"{kind} mesh{planet}"] for planet in ("", " 2", " 3")])
        assert np.sum(forces) == pytest.approx(total, rel=1e-6)
        assert 0.0 < np.ptp(forces) / np.mean(forces) < 0.01  # the large gear's tilt reaches the sun
    result = simulate(replace(system.scene, duration=1e-4))
    mesh_frequency = 55.0 / 60.0 * np.array([RING, RING, LARGE * (1.0 + RING / SUN), *[RING] * 4])
    np.testing.assert_allclose(result.mesh_frequency[:, 0], mesh_frequency, rtol=1e-12)
    assert result.position.shape[0] == 7
    ratio = (1.0 + RING / SUN) * LARGE / PINION
    joints = dict(zip(result.coupling, result.coupling_torque[:, 0], strict=True))
    assert abs(joints["main shaft"]) == pytest.approx(ratio * TORQUE, rel=1e-6)
    assert abs(joints["spline"]) == pytest.approx(TORQUE * LARGE / PINION, rel=1e-6)
    assert abs(joints["generator coupling"]) == pytest.approx(TORQUE, rel=1e-6)


def test_bearings_of_the_high_speed_shaft(rest):
    """F along the line of action shared by two bearings, and the couple of its thrust."""
    _, meshes, bearings, _ = rest
    force, (alpha, helix) = meshes["high-speed mesh"], transverse(HIGH)
    couple = force * math.tan(helix) * pitch_radius(PINION, 4e-3, HIGH) / 0.18
    x, y = force * math.sin(alpha) / 2.0, force * math.cos(alpha) / 2.0
    thrust = -force * math.tan(helix)
    np.testing.assert_allclose(bearings["high speed rotor side"], [x + couple, y, thrust], rtol=1e-6)
    np.testing.assert_allclose(bearings["high speed generator side"][:2], [x - couple, y], rtol=1e-6)


def test_thrusts_of_both_stages_meet_on_the_intermediate_shaft(rest):
    """The sun's thrust passes through the joint across frames; ring and high-speed shaft take the others."""
    _, meshes, bearings, _ = rest
    low = sum(meshes[name] for name in ("sun mesh", "sun mesh 2", "sun mesh 3")) * math.tan(
        transverse(LOW)[1]
    )
    high = meshes["high-speed mesh"] * math.tan(transverse(HIGH)[1])
    assert bearings["ring in its housing"][2] == pytest.approx(-low, rel=1e-6)
    assert bearings["intermediate rotor side"][2] == pytest.approx(low + high, rel=1e-6)
    assert abs(bearings["carrier rotor side"][2]) < 1e-6 * low


def test_forces_and_moments_on_the_ground_balance(rest):
    """In the fixed frame at t = 0, where both frames agree: no force is lost or made in the joint."""
    system, _, bearings, _ = rest
    total, moment, largest = np.zeros(3), np.zeros(3), 0.0
    for rotor in system.rotors:
        for part in rotor.bushings:
            location = np.add(rotor.shaft.origin, (0.0, 0.0, part.position))
            total += bearings[part.name]
            moment += np.cross(location, bearings[part.name])
            largest = max(largest, float(np.max(np.abs(bearings[part.name]))))
    seat = system.seats.name.index("ring in its housing")
    rows = slice(5 * seat, 5 * seat + 5)
    q = rest[3]
    moment[:2] += (system.seats.stiffness[rows, rows] @ system.freedoms.keep(system.seats.motion)[rows] @ q)[
        3:
    ]
    np.testing.assert_allclose(total, 0.0, atol=1e-6 * largest)
    np.testing.assert_allclose(moment[:2], 0.0, atol=1e-6 * largest)


def test_pins_carry_the_load_and_the_couple_of_a_planet(rest):
    _, meshes, bearings, _ = rest
    alpha, helix = transverse(LOW)
    radius = pitch_radius(PLANET, 5e-3, LOW)
    for planet, name in enumerate(("", " 2", " 3")):
        force = 0.5 * (meshes[f"sun mesh{name}"] + meshes[f"ring mesh{name}"])
        angle = 2.0 * math.pi * planet / 3.0
        away, across = (
            np.array([math.cos(angle), math.sin(angle)]),
            np.array([-math.sin(angle), math.cos(angle)]),
        )
        low, high = (bearings[f"pin {side} side{name}"][:2] for side in ("rotor", "generator"))
        load = 2.0 * force * math.cos(alpha)
        np.testing.assert_allclose(low + high, -load * across, atol=5e-3 * load)
        couple = 2.0 * force * math.tan(helix) * radius / 0.05
        np.testing.assert_allclose(0.5 * (low - high), couple * away, atol=5e-3 * couple)


def test_the_balance_of_energy_closes(record_figure):
    scene = wind_turbine(lambda table: table["drives"][0].update(time_s=[0.0, 0.1], speed_rpm=[50.0, 55.0]))
    result = simulate(replace(scene, duration=0.1))
    assert result.status.usable
    name = "energy balance, wind turbine on fake tables"
    record_figure(name, 100.0 * result.energy.relative, "below 0.1 %", "%", "energy audit")
    assert result.energy.relative < 1e-3
    assert result.energy.bushings > 0.0
