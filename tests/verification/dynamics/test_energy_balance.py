"""Energy of runs, and which source an error has."""

from dataclasses import replace
from fractions import Fraction

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
from housed_pair import housed_pair
from planetary_scenes import planetary_scene, published_set

from dynamics import Integration, Outputs, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium, tableaus
from dynamics.integrators.workspace import Count, Power
from dynamics.results.order_fit import order_amplitudes, unwrapped
from dynamics.simulation.error_by_source import _windows, window_starts

# Energy: conserved without damping and drive, and the audit closes with everything on.


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
    for tolerance in (1e-8, 1e-10):
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
    drift = abs(energy_gained(run)) / vibration
    record_figure(f"energy drift over 1e6 steps, {method}", drift, "below 1e-6", "1", "own target")
    assert drift < 1e-6


def energy_gained(run):
    """Energy that no work explains, J, where no tooth passes: the position supplies nothing then."""
    return float(np.diff(run.stored.sum(axis=1))[0] - np.delete(run.work, Power.POSITION).sum())


TABLEAUS = {
    "implicit": (tableaus.IMPLICIT_STAGES, tableaus.IMPLICIT_WEIGHTS),
    "explicit": (tableaus.EXPLICIT_STAGES, tableaus.EXPLICIT_WEIGHTS),
}


def energy_kept(stages, weights, angle):
    """What a step of `angle` radians keeps of an undamped oscillation's energy, |R(i angle)|^2, exactly."""
    z, rates, end = Fraction(angle), [], (Fraction(1), Fraction(0))
    for i in range(len(weights)):
        real, imaginary = Fraction(1), Fraction(0)
        for weight, (re, im) in zip(map(Fraction, stages[i]), rates, strict=False):
            real, imaginary = real + weight * re, imaginary + weight * im
        turn = z * Fraction(stages[i][i])  # (1 - i turn) y = what the stages before make of y
        norm = 1 + turn**2
        real, imaginary = (real - turn * imaginary) / norm, (imaginary + turn * real) / norm
        rates.append((-z * imaginary, z * real))
        end = end[0] + Fraction(weights[i]) * rates[i][0], end[1] + Fraction(weights[i]) * rates[i][1]
    return end[0] ** 2 + end[1] ** 2


@pytest.mark.law
@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_steps_lose_the_energy_that_their_method_loses(method):
    """Undamped, 44 steps per radian: neither Newton's method nor rounding adds to the method's own loss."""
    still = gear_pair_scene(spring_table(4e8), speed=TimeLaw.ramp(0.0, 1e-12, 1.0), duration=1.0)
    still = with_mesh(replace(still, bushings=()), damping=0.0)
    mass, steps = float(assemble(still).arrays.mass[0, 0]) / BASE_RADIUS**2, 60_000
    natural = np.sqrt(4e8 / mass)
    fixed = Integration(method, fixed_step=1.0 / (44.0 * natural))
    still = replace(still, duration=steps * fixed.fixed_step, integration=fixed, outputs=Outputs(1000.0))
    system, speed = assemble(still), 0.5 * natural * 100.0 / BASE_RADIUS / 4e8  # half the load's deflection
    run = integrate(system, static_equilibrium(system), fixed, velocity=np.array([speed / BASE_RADIUS]))
    loss = -energy_gained(run) / (0.5 * mass * speed**2)
    expected = 1 - energy_kept(*TABLEAUS[method], 1.0 / 44.0)
    assert loss == pytest.approx(run.count[Count.ACCEPTED] * float(expected), rel=0.03)


# What the receipt of a run says of its errors, against runs that are right.


def run_up(positions, **changes):
    speed = TimeLaw.ramp(0.0, 955.0 * RPM, 1.0)
    return gear_pair_scene(square_wave_table(positions), speed=speed, duration=1.0, **changes)


def free_planets():
    tables = {"sun_table": square_wave_table(), "ring_table": square_wave_table()}
    return planetary_scene(published_set(3, **tables), duration=0.1)


def in_housing():
    return replace(housed_pair(), meshes=gear_pair_scene(square_wave_table()).meshes, duration=0.05)


def difference(one, other, error):
    """rms of the transmission errors' difference, and its worst order amplitudes in the windows."""
    apart = one.dynamic_transmission_error - other.dynamic_transmission_error
    pushed = one.bearing_force - other.bearing_force
    parts = [slice(first, last + 1) for first, last in error["windows"]]
    position = [unwrapped(one.position[0, part]) for part in parts]
    by_error = [order_amplitudes(x, apart[0, part], 5) for x, part in zip(position, parts, strict=True)]
    by_force = [
        np.linalg.norm(order_amplitudes(x, pushed[..., part], 5), axis=1).max(axis=0)
        for x, part in zip(position, parts, strict=True)
    ]
    return np.sqrt(np.mean(apart**2)), np.max(by_error, axis=0), np.max(by_force, axis=0)


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9])
def test_the_error_of_the_steps_is_the_one_stated(tolerance, record_figure):
    scene = run_up(64, integration=Integration(tolerance=tolerance))
    run, right = simulate(scene), simulate(replace(scene, integration=Integration(tolerance=1e-12)))
    stated = run.receipt["error"]["time_step"]
    rms, by_error, by_force = difference(run, right, run.receipt["error"])
    record_figure(
        f"stated over true step error, {1e9 * tolerance:g} nm", stated["rms"] / rms, "0.5 to 2", "1", "own"
    )
    assert 0.5 < stated["rms"] / rms < 2.0
    assert 0.3 < max(stated["transmission_error_orders"]) / max(by_error) < 3.0
    assert 0.3 < max(stated["bearing_force_orders"]) / max(by_force) < 3.0


@pytest.mark.law
@pytest.mark.parametrize("positions", [24, 64])
def test_the_error_of_the_table_is_within_the_one_stated(positions, record_figure):
    fine = Integration(tolerance=1e-10)
    run, right = simulate(run_up(positions, integration=fine)), simulate(run_up(1024, integration=fine))
    stated = run.receipt["error"]["table_interpolation"]
    rms, by_error, _ = difference(run, right, run.receipt["error"])
    name = f"stated over true error of a table of {positions} positions"
    record_figure(name, stated["rms"] / rms, "0.5 to 10", "1", "own")
    assert 0.5 < stated["rms"] / rms < 10.0
    assert 0.3 * max(by_error) < max(stated["transmission_error_orders"]) < 30.0 * max(by_error)


@pytest.mark.parametrize(
    "make", [lambda: run_up(64), free_planets, in_housing], ids=["drive", "free train", "housing"]
)
def test_a_window_run_again_as_it_was_is_the_run(make):
    """Law, loads and counted quanta at its start are right: only the choice of steps is another."""
    system = assemble(make())
    starts = window_starts(system)
    found = integrate(system, static_equilibrium(system), system.scene.integration, modal_samples=starts)
    looked = _windows(system, found.states.rows, found.modal_states)
    assert [window.first for window in looked] == starts.tolist()
    for window in looked:
        again = window.repeated(window.system, system.scene.integration)
        assert again.rms < 1e-9 < 1e-3 * np.ptp(window.error)
    assert found.states.quanta[-1].any() == (system.scene.drives[0].name == "ring held")


def test_a_minimal_receipt_states_the_tolerance_and_changes_no_series():
    scene = run_up(64)
    full = simulate(scene)
    lean = simulate(replace(scene, outputs=Outputs(receipt="minimal")))
    np.testing.assert_array_equal(full.mesh_force, lean.mesh_force)
    assert lean.receipt["error"]["time_step"]["rms"] == 1e-9
    assert "table_interpolation" not in lean.receipt["error"]


def test_effects_that_are_off_are_named_with_what_they_change():
    off = simulate(run_up(64, effects={"tilt": "off"}))
    left_out, sizes = off.receipt["error"]["left_out_effects"], off.effect_ledger["influences"]
    assert left_out["unit"] == "dB"
    on = {entry["effect"] for entry in off.effect_ledger["entries"] if entry["on"]}
    assert "tilt" in left_out["effects"]
    assert set(left_out["effects"]) == set(sizes) - on
    for name, decibels in left_out["effects"].items():
        assert decibels == sizes[name]["level"]["decibels"]
    assert abs(left_out["decibels"]) == max(map(abs, left_out["effects"].values()))
