"""Flexible shafts of a scene: statics, modes, and whole runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import (
    STEEL,
    bending_stiffness,
    flexible_pair,
    section_motion,
    shear_stiffness,
    torsional_stiffness,
)
from geared_scenes import RPM, spring_table, with_bushings, with_gear, with_mesh
from sliced_face import sliced_database

from dynamics import Bushing, CoastFlank, Coupling, Inertia, Integration, Outputs, Shaft, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.mechanism.flank_gradients import common_face_width, misalignment_gradient
from dynamics.motion.force_balance import force_balance
from dynamics.results import EnergyAudit
from dynamics.shafts import BeamSection

# Flexible shafts at rest: closed forms of bending, twist and bearing forces.


STIFF = 1e8
HOLLOW = BeamSection(0.2, 0.05, 0.02)


def rested(system):
    """Static displacements, and the force of the shafts on the ground at every bearing."""
    start = static_equilibrium(system)
    assert start.status.usable
    still = np.zeros((1, start.displacement.size))
    local = force_balance(system.arrays, 0.0, start.displacement, still[0], still[0]).local
    return start, system.bearing_force(local.force[:, None], start.displacement[None], still)[:, :, 0]


@pytest.mark.parametrize("section", [STEEL, HOLLOW])
def test_a_gear_between_bearings_sinks_as_the_closed_form_says(section):
    """P a^2 b^2/(3 E I L) + P a b/(kappa A G L) after Timoshenko, and the bearings' own displacement."""
    system = assemble(flexible_pair(section, gear=0.06))
    start, _ = rested(system)
    a, b, length = 0.06, 0.14, 0.2
    per_force = a**2 * b**2 / (3.0 * bending_stiffness(section) * length)
    per_force += a * b / (shear_stiffness(section) * length) + (a**2 + b**2) / length**2 / STIFF
    moved = section_motion(system, "output", 0.06, start.displacement)
    assert np.hypot(*moved[:2]) == pytest.approx(start.mesh_force[0] * per_force, rel=1e-9, abs=0.0)


def test_an_overhung_gear_sinks_and_tilts_as_the_closed_form_says():
    """P c^2 (l + c)/(3 E I) + P c (1 + c/l)/k A G, and P c l/(3 E I) + P c^2/(2 E I) + P c/(k A G l)."""
    span, c = 0.13, 0.05
    system = assemble(flexible_pair(gear=span + c, bearings=(0.0, span)))
    start, _ = rested(system)
    bent, shear = bending_stiffness(STEEL), shear_stiffness(STEEL)
    sunk = c**2 * (span + c) / (3.0 * bent) + c * (1.0 + c / span) / shear
    sunk += ((1.0 + c / span) ** 2 + (c / span) ** 2) / STIFF
    tilted = c * span / (3.0 * bent) + c**2 / (2.0 * bent) + c / (shear * span)
    tilted += (1.0 + 2.0 * c / span) / (span * STIFF)
    moved = section_motion(system, "output", span + c, start.displacement)
    force = float(start.mesh_force[0])
    assert np.hypot(*moved[:2]) == pytest.approx(force * sunk, rel=1e-9, abs=0.0)
    assert np.hypot(*moved[3:5]) == pytest.approx(force * tilted, rel=1e-9, abs=0.0)
    # across the line of action: what the mesh reads as misalignment, not the tilt of the whole shaft
    mean = np.hypot(*start.displacement[[system.freedoms.name.index(f"output.tilt_{k}") for k in "xy"]])
    assert np.hypot(*moved[3:5]) > 1.2 * mean


def test_shafts_wind_up_between_where_torque_enters_and_leaves():
    """T l/(G J), from the drive to the pinion and from the wheel to the load."""
    scene = flexible_pair(gear=0.06)
    drive = replace(scene.drives[0], position=0.2)
    load = replace(scene.loads[0], position=0.15)
    system = assemble(replace(scene, drives=(drive,), loads=(load,)))
    start, _ = rested(system)

    def turned(shaft, location):
        return section_motion(system, shaft, location, start.displacement)[5]

    twisted = 100.0 * 0.14 / torsional_stiffness(STEEL)
    assert turned("input", 0.2) == pytest.approx(0.0, abs=1e-12 * twisted)
    assert turned("input", 0.06) == pytest.approx(-twisted, rel=1e-9, abs=0.0)
    behind = float(
        system.arrays.position_gradient[0] @ start.displacement
    )  # base pitches: as far as the pinion has turned
    assert behind == pytest.approx(-twisted * 20 / (2.0 * math.pi), rel=1e-9, abs=0.0)
    back = turned("output", 0.15) - turned("output", 0.06)
    assert back == pytest.approx(100.0 * 0.09 / torsional_stiffness(STEEL), rel=1e-9, abs=0.0)


def test_bearings_carry_the_mesh_force_and_its_moment():
    """Action = reaction on each shaft: forces, and moments about the left bearing."""
    scene = flexible_pair(gear=0.06)
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.2), 1, base_helix_angle=-0.2)
    system = assemble(scene)
    assert "output.stretch_1" in system.freedoms.name
    start, force = rested(system)
    for shaft, sign in (("input", -1.0), ("output", 1.0)):
        rows = [system.supports.name.index(f"{shaft}.{end}") for end in ("left", "right")]
        pushed = sign * start.mesh_force[0] * system.lines[0].force
        np.testing.assert_allclose(force[rows].sum(axis=0), pushed, rtol=1e-9)
        axis = system.rotors[scene.shaft_index(shaft)].shaft.origin
        moment = np.cross(system.lines[0].point - np.array(axis), pushed)
        held = np.cross([0.0, 0.0, 0.2], force[rows[1]])
        np.testing.assert_allclose(held[:2], moment[:2], rtol=1e-9)


def test_torque_winds_a_shaft_up_between_its_two_gears_and_passes_its_coupling():
    """Pinion, shaft with two gears, third gear; a machine behind a coupling takes the load."""
    scene = flexible_pair(gear=0.06)
    behind = replace(scene.gears[1], name="second", position=0.14)
    third = replace(scene.gears[0], name="third", shaft="third", position=0.14)
    shaft = replace(scene.shafts[0], name="third", origin=(0.16, 0.0, 0.0))
    machine = Shaft("machine", 0.1, (0.16, 0.0, 0.2), Inertia(5.0, 0.02, 0.02))
    ends = tuple(Bushing(f"third.{k}", "third", z, STIFF) for k, z in enumerate((0.0, 0.2)))
    scene = replace(
        scene,
        shafts=(*scene.shafts, shaft, machine),
        gears=(*scene.gears, behind, third),
        bushings=(*scene.bushings, *ends),
        meshes=(scene.meshes[0], replace(scene.meshes[0], name="next", driver="second", driven="third")),
        couplings=(Coupling("joint", "third", "machine", 1e4, position=0.2),),
        loads=(replace(scene.loads[0], shaft="machine"),),
    )
    system = assemble(scene)
    q = static_equilibrium(system).displacement
    assert [rotor.elastic is not None for rotor in system.rotors] == [True, True, True, False]
    per_meter = 100.0 / torsional_stiffness(STEEL)

    def turned(name, location):
        return section_motion(system, name, location, q)[5]

    before = turned("output", 0.06) - turned("output", 0.14)
    assert before == pytest.approx(system.kinematics.sense[1] * 0.08 * per_meter, rel=1e-8, abs=0.0)
    wound = turned("third", 0.14) - turned("third", 0.2)
    assert abs(wound) == pytest.approx(0.06 * per_meter, rel=1e-8, abs=0.0)
    joint = turned("third", 0.2) - turned("machine", 0.0)
    assert abs(joint) == pytest.approx(100.0 / 1e4, rel=1e-8, abs=0.0)
    assert wound * joint > 0.0
    assert turned("output", 0.14) == pytest.approx(turned("output", 0.2), rel=1e-9)  # nothing passes there


# Flexible shafts in time: energy, momentum, both integrators, the tilt that a mesh reads.


def run_up(duration=0.05, **changes):
    """Torque in at one end, out at the other, gears off the middle."""
    scene = flexible_pair(gear=0.07, speed=TimeLaw.ramp(0.0, 2000.0 * RPM, duration), duration=duration)
    load = replace(scene.loads[0], position=0.2)
    return replace(scene, loads=(load,), **changes)


@pytest.mark.law
def test_no_energy_comes_from_shafts_that_spin_and_bend():
    """Undamped and thrown: what does not balance is at most 2 % of the energy of the throw in a second."""
    duration = 2e-3
    scene = with_mesh(
        with_bushings(flexible_pair(gear=0.07, table=spring_table(4e8)), damping_ratio=0.0), damping=0.0
    )
    shafts = tuple(replace(shaft, damping_ratio=0.0) for shaft in scene.shafts)
    effects = {**scene.effects, "gyroscopic": "on"}
    drive = replace(scene.drives[0], speed=TimeLaw.constant(2000.0))
    system = assemble(replace(scene, shafts=shafts, effects=effects, drives=(drive,), duration=duration))
    start, rng = static_equilibrium(system), np.random.default_rng(7)
    velocity = 1e-3 * rng.normal(size=start.displacement.size) / system.arrays.scale
    run = integrate(system, start, Integration(tolerance=1e-12), velocity=velocity)
    assert run.status.usable
    audit = EnergyAudit.from_arrays(run.work, run.stored)
    thrown = 0.5 * velocity @ system.arrays.mass @ velocity
    assert abs(audit.residual) < 0.02 * duration * thrown
    assert abs(audit.stored_bushings) > 1e-2 * thrown


@pytest.mark.parametrize("rigid", [True, False])
def test_the_drives_power_where_it_turns_the_shaft_closes_the_balance(rigid):
    """Imposed at the end of a shaft that winds up, rigidly or through a spring there."""
    scene = run_up()
    drive = scene.drives[0] if rigid else replace(scene.drives[0], stiffness=1e6, damping=10.0)
    run = simulate(replace(scene, drives=(drive,), integration=Integration(tolerance=1e-11)))
    assert run.energy.relative_to_throughput < 2e-7  # as with rigid shafts
    assert run.energy.bushings > 0.0
    given = np.trapezoid(
        run.drive_torque[0] * drive.speed(run.time), run.time
    )  # of the drive, not of the shaft
    assert given == pytest.approx(run.energy.drive, rel=1e-3)


def test_the_mass_of_each_shaft_moves_as_mesh_and_bearings_push():
    """Momentum: m x'' of the center of mass is the mesh force less what the bearings carry."""
    outputs = Outputs(sample_rate=5e3, displacements=True, accelerations=True)
    run = simulate(run_up(outputs=outputs))
    system = assemble(run_up(outputs=outputs))
    line = system.lines[0].force
    for shaft, sign in (("input", -1.0), ("output", 1.0)):
        mass = system.rotors[system.scene.shaft_index(shaft)].inertia.mass
        own = [row for row, name in enumerate(run.bearing) if name.startswith(shaft)]
        for axis, kind in enumerate("xy"):
            taken = mass * run.acceleration[run.freedom.index(f"{shaft}.{kind}")]
            pushed = sign * run.mesh_force[0] * line[axis] - run.bearing_force[own, axis].sum(axis=0)
            np.testing.assert_allclose(taken, pushed, atol=1e-7 * np.max(run.mesh_force))
            assert np.max(np.abs(taken)) > 1.0


@pytest.mark.parametrize("helix", [0.0, 0.15])
def test_a_mesh_reads_the_tilt_of_its_gears_and_not_that_of_their_shafts(helix):
    """m = s b (tilt_1 - tilt_2) . (z x n) with the tilts of the sections that carry the gears."""
    scene = flexible_pair(gear=0.17, bearings=(0.0, 0.12), section=replace(STEEL, outer_diameter=0.03))
    scene = with_gear(with_gear(scene, 0, base_helix_angle=helix), 1, base_helix_angle=-helix)
    system = assemble(scene)
    q = static_equilibrium(system).displacement
    sense, line = system.kinematics.mesh_sense[0], system.lines[0]
    row = misalignment_gradient(scene, system.rotors, 0, line, sense)
    across = np.cross([0.0, 0.0, 1.0], line.force * [1.0, 1.0, 0.0]) * sense * common_face_width(scene, 0)
    tilts = [section_motion(system, shaft, 0.17, q)[3:] for shaft in ("input", "output")]
    here = float(system.freedoms.keep(row) @ q)
    assert here == pytest.approx(float((tilts[0] - tilts[1]) @ across), rel=1e-12, abs=0.0)
    middle = [section_motion(system, shaft, 0.0, q)[3:] for shaft in ("input", "output")]
    assert abs(here) > 1.5 * abs(float((middle[0] - middle[1]) @ across))


@pytest.mark.law
def test_a_run_with_all_effects_of_the_mesh_closes_its_balance_and_reads_the_local_tilt():
    """Misalignment, center distance, moving application point, friction and backlash on flexible shafts."""
    table = sliced_database((-60e-6, 0.0, 60e-6), (-1e-4, 0.0, 1e-4), positions=12).force_table()
    names = (
        "dynamic_misalignment",
        "dynamic_center_distance",
        "moving_application_point",
        "backlash",
        "gyroscopic",
    )
    scene = flexible_pair(
        gear=0.06,
        table=table,
        speed=TimeLaw.constant(900.0 * RPM),
        duration=0.01,
        effects=dict.fromkeys(names, "on"),
    )
    back = CoastFlank(80e-6, 0.49)
    run = simulate(replace(with_mesh(scene, coast=back), outputs=Outputs(displacements=True)))
    assert run.energy.relative_to_throughput < 1e-6
    assert {e["effect"] for e in run.effect_ledger["entries"] if e["on"]} >= {*names, "flexible_shafts"}
    system = assemble(with_mesh(scene, coast=back))
    line, sense = system.lines[0], system.kinematics.mesh_sense[0]
    row = system.freedoms.keep(misalignment_gradient(scene, system.rotors, 0, line, sense))
    np.testing.assert_allclose(run.misalignment[0], row @ run.displacement, rtol=1e-9, atol=1e-15)
    assert np.max(np.abs(run.misalignment)) > 1e-7
