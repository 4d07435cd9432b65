"""One mesh: linear, with backlash, rattling, and with kinks in its table."""

from dataclasses import replace

import numpy as np
import pytest
from backlash_oscillator import CONVERGED, SAMPLES, excitation, oscillator
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, spring_table, square_wave_table, with_mesh
from scipy.integrate import solve_ivp

from dynamics.integrators import integrate, static_equilibrium
from dynamics.joints import ImposedRotation
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import CoastFlank, GearMesh
from dynamics.scene import Integration, Outputs, Scene
from dynamics.shafts import GearBody, Inertia, Shaft
from dynamics.simulation import simulate

# One linear freedom against its closed form, and the measured order of both integrators.


STIFFNESS = 4e8
INERTIA = 1.1344291072112745e-3
MASS = INERTIA / BASE_RADIUS**2
NATURAL = np.sqrt(STIFFNESS / MASS)
STEP = 20.0


def torsional(torque, **changes):
    """Rotation of the driven shaft alone on a linear mesh that never lifts off, undamped."""
    points = Outputs(20e3, anti_alias=False)
    scene = gear_pair_scene(spring_table(STIFFNESS), duration=0.004, outputs=points)
    scene = replace(scene, bushings=(), effects={})
    scene = with_mesh(scene, damping=0.0, nominal_force=torque(0.0) / BASE_RADIUS)
    return replace(scene, loads=(replace(scene.loads[0], torque=torque),), **changes)


def ramped(time, begin, duration):
    """Closed form of x'' + w^2 x = F(t)/m for a load that rises by STEP N m over `duration` from `begin`."""

    def rise(t):
        t = np.maximum(t, 0.0)
        return t - np.sin(NATURAL * t) / NATURAL

    force = STEP / BASE_RADIUS / STIFFNESS / duration
    return 100.0 / BASE_RADIUS / STIFFNESS + force * (rise(time - begin) - rise(time - begin - duration))


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_ramped_load_rings_as_the_closed_form(method):
    torque = TimeLaw.ramp(100.0, 100.0 + STEP, 2e-4, begin=1e-3)
    scene = torsional(torque, integration=Integration(method, tolerance=1e-12))  # undamped: errors add up
    result = simulate(scene)
    exact = ramped(result.time, 1e-3, 2e-4)
    assert np.ptp(exact[result.time > 0.0013]) > 5e-8  # it rings
    rms = np.sqrt(np.mean((result.dynamic_transmission_error[0] - exact) ** 2))
    assert rms < 1e-11


def test_damping_makes_the_decay_of_its_ratio():
    torque = TimeLaw.ramp(100.0, 120.0, 1e-9, begin=1e-4)
    ratio = 0.03
    scene = with_mesh(
        torsional(torque, integration=Integration(tolerance=1e-11)), damping=2 * ratio * MASS * NATURAL
    )
    result = simulate(replace(scene, outputs=replace(scene.outputs, sample_rate=1e6)))
    t = np.maximum(result.time - 1e-4, 0.0)
    damped = NATURAL * np.sqrt(1 - ratio**2)
    ring = np.exp(-ratio * NATURAL * t) * (np.cos(damped * t) + ratio * NATURAL / damped * np.sin(damped * t))
    exact = (100.0 + 20.0 * (1.0 - ring)) / BASE_RADIUS / STIFFNESS
    np.testing.assert_allclose(result.dynamic_transmission_error[0], exact, atol=2e-10)


@pytest.mark.parametrize(("method", "order"), [("implicit", 4.0), ("explicit", 5.0)])
def test_the_order_is_the_theory_s_on_a_smooth_problem(method, order, record_figure):
    """Error at fixed steps h, h/2, h/4 against a run at h/16, on a mesh whose position dependence is one
    cubic.

    A table with one knot is constant in position and linear in deflection: no kinks, so theory applies.
    """
    scene = torsional(TimeLaw((0.0, 0.004), (100.0, 300.0), "smooth"))
    steps = 2e-5 / 2.0 ** np.arange(3)

    def run(step):
        integration = Integration(method, tolerance=1e-14, fixed_step=float(step))
        return simulate(replace(scene, integration=integration)).dynamic_transmission_error[0]

    sample = slice(0, None, 4)  # every 2e-4 s: a step's end for all steps
    fine = run(steps[0] / 32)
    errors = [np.sqrt(np.mean((run(step) - fine)[sample] ** 2)) for step in steps]
    rates = np.log2(errors[:-1] / np.array(errors[1:]))
    record_figure(f"order of the {method} method, smooth", rates[-1], f"{order:g} within 0.15", "1", "theory")
    assert abs(rates[-1] - order) < 0.15


def test_control_keeps_the_error_below_the_tolerance(record_figure):
    """Run-up on a table with kinks: rms error against a run at a ten-thousandth of the tolerance."""
    scene = gear_pair_scene(speed=TimeLaw.ramp(0.0, 100.0, 0.5), duration=0.5)

    def run(tolerance, method="implicit"):
        return simulate(replace(scene, integration=Integration(method, tolerance))).dynamic_transmission_error

    fine = run(1e-13)
    for tolerance in (1e-8, 1e-9, 1e-10):
        rms = np.sqrt(np.mean((run(tolerance) - fine) ** 2))
        assert 0.01 * tolerance < rms < tolerance
        if tolerance == 1e-9:
            record_figure("DTE step error at tolerance 1 nm", 1e9 * rms, "below 1 nm", "nm", "own target")
    assert np.sqrt(np.mean((run(1e-10, "explicit") - fine) ** 2)) < 1e-10  # the two methods agree


# One freedom with backlash by time integration: rms of both branches, and the jumps between them.


def settled_rms(frequency, state):
    """rms of d - e over the last periods, and the state (q, v) to go on with at the same phase."""
    system = oscillator(frequency)
    start = static_equilibrium(system)
    if state is not None:
        start = replace(start, displacement=state[0])
    run = integrate(system, start, system.scene.integration, velocity=None if state is None else state[1])
    phase = 2.0 * np.pi * np.arange(run.time.size) / SAMPLES
    deflection = run.q @ system.arrays.direction[0] - excitation(frequency) * np.cos(phase)
    last = deflection[-20 * SAMPLES :]
    whole = (run.time.size - 1) // SAMPLES * SAMPLES
    return float(np.std(last)), (run.q[whole].copy(), run.v[whole].copy())


def sweep(frequencies):
    """Response at each frequency, started from the state left by the one before."""
    found, state = {}, None
    for frequency in frequencies:
        found[frequency], state = settled_rms(frequency, state)
    return found


@pytest.mark.parametrize("branch", [0, 1], ids=["up", "down"])
def test_both_branches_of_the_response(branch, record_figure):
    order = sorted(CONVERGED) if branch == 0 else sorted(CONVERGED, reverse=True)
    found = sweep(order)
    errors = {w: found[w] / CONVERGED[w][branch] - 1.0 for w in order}
    worst = max(map(abs, errors.values()))
    name = f"oscillator with backlash, rms, {'up' if branch == 0 else 'down'}-sweep, worst"
    record_figure(name, 100.0 * worst, "at most 0.5 %", "%", "converged numbers")
    assert worst < 0.005, errors


@pytest.mark.parametrize(
    ("path", "jump", "falls"),
    [((0.75, 0.8), 0.8285, False), ((0.85, 0.75), 0.7080, True)],
    ids=["up", "down"],
)
def test_the_response_jumps_where_its_branch_ends(path, jump, falls):
    """Just before the converged frequency it stays on its branch, 0.003 behind it is on the other."""
    state = None
    for frequency in path:
        _, state = settled_rms(frequency, state)
    step = -0.003 if falls else 0.003
    before, state = settled_rms(jump - step, state)
    behind, _ = settled_rms(jump + step, state)
    assert (before > 0.15) is falls
    assert (behind > 0.15) is not falls


# A gear thrown between its driving and coast flanks: against a second integrator, and its energy.


TEETH, MEAN, RIPPLE, GAP, RATE = 20, 0.1, 0.6, 2.0, 0.9
DURATION = 20.0


def scene(method):
    """Unit mass and stiffness; e = RIPPLE cos(RATE t) moves both flanks."""
    gears = tuple(
        GearBody(f"g{k}", f"s{k}", 0.5, TEETH, 1.0, 0.1, 0.0, Inertia(1.0, 1.0, 1.0)) for k in range(2)
    )
    back = CoastFlank(GAP, 0.0, spring_table(1.0, -RIPPLE, positions=512))
    mesh = GearMesh("m", "g0", "g1", spring_table(1.0, RIPPLE, positions=512), damping=0.0, coast=back)
    return Scene(
        (Shaft("s0", 1.0), Shaft("s1", 1.0, (2.2, 0.0, 0.0))),
        gears,
        (mesh,),
        (ImposedRotation("d", "s0", TimeLaw.constant(RATE / TEETH)),),
        duration=DURATION,
        loads=(LoadTorque("l", "s1", TimeLaw.constant(MEAN)),),
        outputs=Outputs(sample_rate=10.0, energy_audit=False, anti_alias=False),
        integration=Integration(method, tolerance=1e-9, largest_step=1.0),
        on_violation="report",  # numbers without units: errors of some m on teeth of 0.3 m
    )


def reference(time):
    """d'' = MEAN - drive + coast with an integrator of order 8 that meets every kink in short steps."""

    def rates(t, state):
        d, e = state[0], RIPPLE * np.cos(RATE * t)
        return [state[1], MEAN - max(d - e, 0.0) + max(-d - GAP + e, 0.0)]

    start = [MEAN + RIPPLE, 0.0]
    return solve_ivp(rates, (0.0, DURATION), start, "DOP853", time, rtol=1e-10, atol=1e-12, max_step=0.02).y[
        0
    ]


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_both_flanks_against_a_second_integrator(method):
    result = simulate(scene(method))
    assert np.mean(result.coast_force > 0.0) > 0.03
    assert np.mean((result.coast_force == 0.0) & (result.mesh_force == 0.0)) > 0.1
    exact = reference(result.time)
    np.testing.assert_allclose(result.dynamic_transmission_error[0], exact, rtol=0.0, atol=2e-7)


def test_the_audit_closes_while_teeth_rattle():
    rattling = gear_pair_scene(
        spring_table(4e8, 20e-6), speed=TimeLaw.constant(6000.0 * RPM), duration=0.05, torque=5.0
    )
    rattling = with_mesh(rattling, coast=CoastFlank(30e-6))
    result = simulate(rattling)
    assert np.mean(result.contact == 2.0) > 0.02
    assert not np.any(result.contact == 3.0)
    assert result.energy.relative < 1e-3


def test_flanks_in_free_flight_keep_their_energy():
    """Undamped at a fixed position, thrown between both flanks, on a table that is C1 at lift-off."""
    still = gear_pair_scene(square_wave_table(), speed=TimeLaw.ramp(0.0, 1e-9, 1.0), duration=0.05)
    still = with_mesh(replace(still, bushings=()), damping=0.0, coast=CoastFlank(5e-6))
    jolt = TimeLaw((0.0, 0.001, 0.0011, 0.0014, 0.0015), (100.0, 100.0, -900.0, -900.0, 0.0))
    thrown = replace(
        still,
        loads=(replace(still.loads[0], torque=jolt),),
        integration=Integration(tolerance=1e-12),
        on_violation="report",  # thrown far beyond the table's loads
    )
    result = simulate(thrown)
    after = result.time > 0.0016
    assert np.any(result.coast_force[0, after] > 0.0)
    assert np.any(result.mesh_force[0, after] > 0.0)
    energy = result.energy
    gained = energy.kinetic + energy.stored_meshes
    assert abs(gained) > 0.5
    assert abs(energy.residual) < 1e-5 * abs(gained)


# What order both integrators keep at fixed steps across kinks: of tables at knots, of forces at lift-off.


STEPS = 2.0 ** -(np.arange(12) / 4)  # three octaves; where in a step a kink lies is chance, so many of them


def kinked(table, torque, rpm):
    """One rotation, damped."""
    outputs = Outputs(5e3, energy_audit=False, anti_alias=False)
    pair = gear_pair_scene(
        table, torque=torque, speed=TimeLaw.constant(rpm * RPM), duration=0.01, outputs=outputs
    )
    return replace(pair, bushings=(), effects={})


# name: scene, largest step in s, order that theory gives a kink of that kind
CASES = {
    "knots, a kink in the second derivative": (
        kinked(spring_table(4e8, 2e-6, positions=4), 100.0, 4000.0),
        8e-6,
        3.0,
    ),
    "lift-off, a kink in the force": (kinked(square_wave_table(256), 20.0, 12000.0), 4e-6, 2.0),
}


@pytest.mark.parametrize("method", ["implicit", "explicit"])
@pytest.mark.parametrize("name", CASES)
def test_kinks_cost_as_much_order_as_theory_says(name, method, record_figure):
    """Slope of log error over log step; a step in which a kink lies has an error of its own order."""
    scene, largest, theory = CASES[name]

    def run(step, method=method):
        integration = Integration(method, tolerance=1e-14, fixed_step=float(step))
        return simulate(replace(scene, integration=integration))

    fine = run(largest / 256, "explicit")
    assert bool(np.any(fine.mesh_force == 0.0)) is (theory == 2.0)
    exact = fine.dynamic_transmission_error
    errors = [
        np.sqrt(np.mean((run(step).dynamic_transmission_error - exact) ** 2)) for step in largest * STEPS
    ]
    order = np.polyfit(np.log(STEPS), np.log(errors), 1)[0]
    record_figure(f"order of the {method} method, {name}", order, f"about {theory:g}", "1", "theory")
    assert abs(order - theory) < 0.5
