"""Energy: conserved without damping and drive, and the audit closes with everything on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import (
    BASE_RADIUS,
    RPM,
    gear_pair_scene,
    spring_table,
    square_wave_table,
    with_bushings,
    with_gear,
    with_mesh,
)

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate


@pytest.mark.parametrize("method", ["implicit", "explicit"])
@pytest.mark.parametrize("technique", ["variable_torque", "constant_torque"])
def test_the_audit_of_a_run_up_closes(method, technique, record_figure):
    scene = gear_pair_scene(speed=TimeLaw.ramp(0.0, 955.0 * RPM, 1.0), duration=1.0, technique=technique)
    energy = simulate(replace(scene, integration=Integration(method))).energy
    assert energy.drive > 4000.0  # 100 N m times 50 rad and the kinetic energy
    assert energy.bushings > 0.0
    assert energy.meshes > 0.0
    assert energy.relative < 1e-3
    assert energy.relative_to_throughput < 1e-7
    record_figure(
        f"energy balance, {method}, {technique}", 100 * energy.relative, "below 0.1 %", "%", "own target"
    )


def handover_table(width=0.01):
    """Two deflections with handovers of `width` base pitches, as between two and one pair of stiff teeth."""
    table = square_wave_table(64)
    edges = np.array([0.22, 0.22 + width, 0.78 - width, 0.78])
    position = np.sort(np.concatenate([table.position, edges]))
    shape = np.interp(position, [0.0, *edges, 1.0], [1.5, 1.5, 1.0, 1.0, 1.5, 1.5])
    fields = {
        name: getattr(table, name)[:, :, :1] / (shape[:, None] if name == "stiffness" else 1.0)
        for name in ("deflection", "stiffness")
    }
    fields["deflection"] = fields["deflection"] * shape[:, None]
    flat = np.zeros_like(fields["deflection"])
    return replace(table, position=position, **fields, deflection_slope=flat, stiffness_slope=flat)


@pytest.mark.parametrize("method", ["implicit", "explicit"])
@pytest.mark.parametrize("technique", ["variable_torque", "constant_torque"])
def test_steep_handovers_cost_no_energy(method, technique, record_figure):
    """What tables supply changes within a part of a step there; the balance gets better with the steps."""
    scene = gear_pair_scene(handover_table(), speed=TimeLaw.constant(60.0), duration=0.2, technique=technique)
    missing = []
    for tolerance in (1e-9, 1e-11):
        result = simulate(replace(scene, integration=Integration(method, tolerance)))
        missing.append(result.energy.relative)
    name = f"energy balance over steep handovers, {method}, {technique}"
    record_figure(name, 100 * missing[0], "below 0.1 %", "%", "own target")
    assert missing[0] < 1e-3
    assert missing[1] < 0.1 * missing[0]


def test_the_audit_closes_through_loss_of_contact_and_a_helical_mesh():
    scene = gear_pair_scene(
        spring_table(4e8, 20e-6), speed=TimeLaw.constant(6000.0 * RPM), duration=0.05, torque=5.0
    )
    scene = with_gear(with_gear(scene, 0, base_helix_angle=0.2), 1, base_helix_angle=-0.2)
    result = simulate(scene)
    assert np.mean(result.mesh_force == 0.0) > 0.05  # it lifts off
    assert result.energy.relative < 1e-3


def test_without_damping_nothing_is_lost():
    """A jolt of the load rings on for ever: drive + load = what is stored, to the integrator's error."""
    scene = gear_pair_scene(square_wave_table(), speed=TimeLaw.ramp(0.0, 1e-9, 1.0), duration=0.05)
    scene = with_mesh(with_bushings(scene, damping_ratio=0.0), damping=0.0)
    jolt = replace(scene.loads[0], torque=TimeLaw.ramp(100.0, 140.0, 1e-4, begin=1e-3))
    result = simulate(replace(scene, loads=(jolt,), integration=Integration(tolerance=1e-12)))
    energy = result.energy
    assert abs(energy.bushings) + abs(energy.meshes) < 1e-20
    assert abs(energy.residual) < 1e-6 * abs(energy.stored_meshes + energy.stored_bushings + energy.kinetic)
    swing = [np.ptp(result.dynamic_transmission_error[0][result.time > t][:200]) for t in (0.002, 0.035)]
    assert swing[1] > 0.8 * swing[0] > 1e-6


def test_a_still_mesh_keeps_its_energy_over_a_long_run():
    """Undamped ringing at a fixed position, 25000 steps of 2 us: the stored energy does not drift."""
    scene = gear_pair_scene(spring_table(4e8), speed=TimeLaw.ramp(0.0, 1e-9, 1.0), duration=0.05)
    scene = with_mesh(replace(scene, bushings=()), damping=0.0)
    jolt = replace(scene.loads[0], torque=TimeLaw.ramp(100.0, 140.0, 1e-4, begin=1e-3))
    fixed = Integration(fixed_step=2e-6)
    result = simulate(
        replace(scene, loads=(jolt,), integration=fixed, outputs=Outputs(100e3, anti_alias=False))
    )
    mass = 1.1344291072112745e-3 / BASE_RADIUS**2
    x = result.dynamic_transmission_error[0] - 140.0 / BASE_RADIUS / 4e8
    speed = -(result.speed.sum(axis=0)) * -BASE_RADIUS
    ringing = 0.5 * mass * speed**2 + 0.5 * 4e8 * x**2
    settled = ringing[result.time > 0.0012]
    np.testing.assert_allclose(settled, settled[0], rtol=1e-4)


@pytest.mark.law
@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_million_steps_keep_the_energy(method, record_figure):
    """Undamped ringing at a fixed position, 45 steps per radian of phase, in contact throughout."""
    still = gear_pair_scene(spring_table(4e8), speed=TimeLaw.ramp(0.0, 1e-12, 1.0), duration=1.0)
    fixed = Integration(method, fixed_step=1e-6)
    still = replace(
        with_mesh(replace(still, bushings=()), damping=0.0), integration=fixed, outputs=Outputs(1000.0)
    )
    system = assemble(still)
    start = static_equilibrium(system)
    velocity = np.array([0.02 / BASE_RADIUS])
    run = integrate(system, start, fixed, velocity=velocity)
    assert run.count[2] >= 999_999
    vibration = 0.5 * system.arrays.mass[0, 0] * velocity[0] ** 2
    drift = abs(np.diff(run.stored.sum(axis=1))[0] - run.work.sum()) / vibration
    record_figure(f"energy drift over 1e6 steps, {method}", drift, "below 1e-6", "1", "own target")
    assert drift < 1e-6
