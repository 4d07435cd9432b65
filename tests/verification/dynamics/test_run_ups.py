"""Runs at changing speed: up a ramp, through resonances, their phase and their samples."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import (
    BASE_RADIUS,
    RPM,
    gear_pair_scene,
    spring_table,
    square_wave_table,
    with_gear,
    with_mesh,
)

from dynamics import (
    CoastFlank,
    FreeRotation,
    Integration,
    LoadTorque,
    Outputs,
    Scene,
    TimeLaw,
    mesh_orders,
    simulate,
)
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.linearize import harmonic_response
from dynamics.orders import find_peaks, highest_valid_order, order_track, sidebands, window_spectrum
from dynamics.periodic import Instability, follow_branch, motion, periodic_problem, sweep

# The run-up of the 20/20 pair: both techniques overlap, mean force, spectrum of the bearing force.


@pytest.mark.parametrize("speed", [100.0, 400.0, 900.0])
def test_the_two_techniques_overlap(speed, record_figure):
    scene = gear_pair_scene(speed=TimeLaw.constant(speed * RPM), duration=0.5)
    runs = [
        simulate(replace(scene, meshes=(replace(scene.meshes[0], technique=technique),)))
        for technique in ("constant_torque", "variable_torque")
    ]
    for series in ("dynamic_transmission_error", "mesh_force"):
        constant, variable = (getattr(run, series)[0] for run in runs)
        difference = np.sqrt(np.mean((constant - variable) ** 2) / np.mean(variable**2))
        record_figure(
            f"{series}, constant against variable torque, {speed:g} rpm",
            100 * difference,
            "below 1 %",
            "%",
            "own target",
        )
        assert difference < 0.01
        assert np.mean(variable != constant) > 0.9  # they are not the same law
    for run in runs:
        assert run.mesh_force.mean() == pytest.approx(100.0 / BASE_RADIUS, rel=1e-3)  # 2660 N


def test_slowly_the_dynamic_error_is_the_static_one():
    run = simulate(gear_pair_scene(speed=TimeLaw.constant(2.0 * RPM), duration=1.6))
    difference = run.dynamic_transmission_error - run.static_transmission_error
    ripple = np.ptp(run.static_transmission_error)
    assert np.ptp(run.position) > 0.9
    assert np.sqrt(np.mean(difference**2)) < 0.002 * ripple


def test_the_bearing_spectrum_shows_the_mesh_frequency_and_its_multiples(record_figure):
    """4.5 to 4.75 s of the run-up to 955 rpm in 5 s: 860 to 907 rpm, 287 to 303 Hz."""
    law = TimeLaw((0.0, 0.25), (0.9 * 955.0 * RPM, 0.95 * 955.0 * RPM))
    run = simulate(gear_pair_scene(square_wave_table(), speed=law, duration=0.25))
    order, *_ = mesh_orders(run, 0.0, 0.25, 1)
    assert (order.low, order.high) == (pytest.approx(286.5, abs=0.1), pytest.approx(302.4, abs=0.1))
    found = window_spectrum(run, "bearing_force", 0.0, 0.25)
    one = replace(found, amplitude=found.amplitude[0, 1])
    fundamental = find_peaks(one, 1, high=450.0)[0]
    record_figure(
        "fundamental of the bearing force", fundamental.frequency, "287 to 303 Hz", "Hz", "ISMA 2010"
    )
    assert 287.0 < fundamental.frequency < 303.0
    background = np.median(one.amplitude[(one.frequency > 350.0) & (one.frequency < 500.0)])
    for multiple in (1, 2, 3):
        low, high = multiple * order.low, multiple * order.high
        inside = one.amplitude[(one.frequency >= low) & (one.frequency <= high)]
        assert inside.max() > 5.0 * background


# Slow run-up and run-down of a lightly loaded pair through resonance, against branches by shooting.


LOW, HIGH, DURATION, TORQUE = 11000.0, 13500.0, 1.0, 20.0
WINDOW = 400  # samples: 10 ms, 25 rpm


def scene(speed, torque=TORQUE):
    """The 20/20 pair at 20 N m: its flanks part in the resonance near 12000 rpm."""
    outputs = Outputs(40e3, energy_audit=False, bearing_forces=False)
    pair = gear_pair_scene(
        square_wave_table(), torque=torque, speed=speed, duration=DURATION, outputs=outputs
    )
    return with_mesh(pair, damping_ratio=0.07, damping=None)


def steady(first, last):
    """The same pair at constant speed, loaded as the run is: with the inertia of the driven shaft."""
    inertia = assemble(scene(TimeLaw.constant(LOW * RPM))).rotors[1].inertia.polar
    torque = TORQUE + inertia * (last - first) * RPM / DURATION
    return periodic_problem(assemble(scene(TimeLaw.constant(LOW * RPM), torque)), LOW * RPM)


@pytest.mark.law
@pytest.mark.parametrize(("first", "last"), [(LOW, HIGH), (HIGH, LOW)], ids=["up", "down"])
def test_a_slow_run_follows_the_stable_branch_and_jumps_at_the_fold(first, last, record_figure):
    run = simulate(scene(TimeLaw.ramp(first * RPM, last * RPM, DURATION)))
    count = run.time.size // WINDOW

    def windows(values):
        return values[: count * WINDOW].reshape(count, WINDOW)

    rms = windows(run.dynamic_transmission_error[0]).std(axis=1)
    rpm = windows(np.abs(run.speed[0])).mean(axis=1) / RPM
    problem = steady(first, last)
    orbits = sweep(problem, np.linspace(first, last, 9)[1:-1] * RPM)
    assert all(orbit.status.usable and orbit.stable for orbit in orbits)
    found = np.array([motion(problem, orbit).dynamic_transmission_error[0].std() for orbit in orbits])
    speeds = np.array([orbit.speed for orbit in orbits]) / RPM
    rises = slice(None) if first < last else slice(None, None, -1)
    error = np.max(np.abs(found / np.interp(speeds, rpm[rises], rms[rises]) - 1.0))
    name = "up" if first < last else "down"
    record_figure(
        f"slow run {name} against shooting, rms of the DTE", 100 * error, "below 1 %", "%", "own target"
    )
    assert error < 0.01
    branch = follow_branch(problem, first * RPM, last * RPM, 0.02)
    assert branch.bifurcations[0].kind is Instability.FOLD
    jump = int(np.argmax(np.abs(np.diff(rms))))
    late = (rpm[jump : jump + 2].mean() - branch.folds[0] / RPM) * np.sign(last - first)
    record_figure(f"jump of a slow run {name} behind the fold", late, "0 to 50 rpm", "rpm", "own target")
    assert -15.0 < late < 50.0  # within the window, and late by what the jump takes
    parted = windows(run.contact[0] == 0.0).mean(axis=1)
    assert max(parted[jump - 5], parted[jump + 5]) > 0.2


# Phase of integrated runs against exact arithmetic: no step adds a rounding to the position. The benchmark
# `long_phase` runs the same for 1e7 steps; what is done in a step knows nothing of how many there were, so
# that errors may grow with the angle turned only, and that is exact for huge counts by itself.


PI = Fraction(3141592653589793238462643383279502884197, 10**39)
STEP, TEETH, START = 1e-5, 20, 50.0


def imposed(steps: int, method: str = "implicit") -> Scene:
    """Torsion alone, the drive at 955 rpm, `steps` fixed steps."""
    duration = steps * STEP
    scene = gear_pair_scene(spring_table(4e8), duration=duration, speed=TimeLaw.constant(955.0 * RPM))
    kept = {"anti_alias": False, "bearing_forces": False, "energy_audit": False, "receipt": "minimal"}
    outputs = Outputs(10.0 / duration, **kept)
    scene = replace(scene, bushings=(), effects={}, outputs=outputs)
    return with_mesh(replace(scene, integration=Integration(method, fixed_step=STEP)), damping_ratio=0.1)


def accelerating(steps: int, method: str = "implicit") -> Scene:
    """A train without a drive: a motor of 1.25 and a brake of 0.25 of what makes 1 rad/s2."""
    scene = replace(
        imposed(steps, method), drives=(), free_rotations=(FreeRotation("train", "input", START),)
    )
    inertia = float(assemble(replace(scene, loads=_loads(1.0))).arrays.total_inertia[0, 0])
    return replace(scene, loads=_loads(inertia))


def _loads(inertia: float) -> tuple[LoadTorque, ...]:
    """Motor and brake."""
    return (
        LoadTorque("motor", "input", TimeLaw.constant(-1.25 * inertia)),
        LoadTorque("brake", "output", TimeLaw.constant(0.25 * inertia)),
    )


def phase_error(scene: Scene) -> float:
    """Position at the last output sample less the exact one, base pitches."""
    run = simulate(scene)
    time = Fraction(float(run.time[-1]))
    if scene.drives:
        angle = Fraction(955.0 * RPM) * time
    else:
        torque = sum(-Fraction(load.torque.value[0]) for load in scene.loads)
        inertia = Fraction(float(assemble(scene).arrays.total_inertia[0, 0]))
        angle = Fraction(START) * time + torque / inertia * time**2 / 2
    turned = Fraction(float(run.position[0, -1])) - Fraction(float(run.position[0, 0]))
    error = turned - angle * TEETH / (2 * PI)
    return float(error - round(error))


STEPS = 100_000


@pytest.mark.parametrize("method", ["implicit", "explicit"])
@pytest.mark.parametrize("make", [imposed, accelerating], ids=["imposed", "accelerating"])
def test_the_phase_is_exact_after_many_steps(make, method, record_figure):
    error = abs(phase_error(make(STEPS, method)))
    name = f"phase after {STEPS:g} steps, {make.__name__}, {method}"
    record_figure(name, error, "below 1e-9", "base pitches", "own target")
    assert error < 2e-13 * (STEPS / 1e5) ** 2  # 5e-12 after 1e7 steps, with the angle


# What is stored of a run holds the motion up to its highest valid order, and nothing that folded.


FINER = 20
DENSE = 1e6  # Hz, of points that miss no peak
PITCHES = 40
BESIDE_THE_MEAN = 3  # lines that hold the difference of two estimates of the mean
HANN_BANDWIDTH = 1.5  # lines


def spur(speed):
    """The 20/20 pair with handovers of a twentieth of a base pitch."""
    return gear_pair_scene(square_wave_table(), speed=speed)


def helical(speed):
    """A helical pair that may move along its axes."""
    scene = with_gear(with_gear(spur(speed), 0, base_helix_angle=0.2), 1, base_helix_angle=-0.2)
    return replace(scene, bushings=tuple(replace(part, axial_stiffness=1e8) for part in scene.bushings))


def rattling(speed):
    """A lightly loaded pair whose teeth part and strike both flanks."""
    scene = gear_pair_scene(spring_table(4e8, 3e-6), speed=speed, torque=10.0, effects={"backlash": "on"})
    return with_mesh(scene, coast=CoastFlank(backlash=4e-6, thickness=0.48))


SCENES = (spur, helical, rattling)


WIDE = 1e6
"""Hz; a band that cuts no order."""


def of_length(scene, rpm):
    frequency = 20.0 * rpm / 60.0
    outputs = Outputs(energy_audit=False, receipt="minimal", band=WIDE)
    return replace(scene(TimeLaw.constant(rpm * RPM)), duration=PITCHES / frequency, outputs=outputs)


def force_points(scene, rate):
    """The mesh force at points of the same motion, step by step."""
    system = assemble(replace(scene, outputs=replace(scene.outputs, sample_rate=rate, anti_alias=False)))
    run = integrate(system, static_equilibrium(system), scene.integration)
    return run.states.filtered[:, 0]


def lines(values, count):
    """Complex amplitudes of the first lines under a Hann window."""
    window = np.hanning(values.size + 1)[:-1]
    return 2.0 * np.fft.rfft((values - values.mean()) * window)[:count] / window.sum()


def false_lines(stored, points, pass_share):
    """Amplitudes of what one of two spectra alone has in the pass band, and the largest line."""
    count = int(pass_share * stored.size)
    here, there = lines(stored, count), lines(points, count)
    return np.abs(here - there)[BESIDE_THE_MEAN:], np.max(np.abs(there[1:]))


@pytest.mark.parametrize("rpm", [500.0, 6000.0, 30000.0])
@pytest.mark.parametrize("scene", SCENES)
def test_nothing_folds_and_no_peak_is_missed(scene, rpm, record_figure):
    made = of_length(scene, rpm)
    run = simulate(made)
    sampling, error = run.receipt["sampling"], run.receipt["error"]["sampling"]["mesh_force"]["mesh"]
    points = force_points(made, FINER * run.sample_rate)
    edge = int(np.ceil(sampling["edge"] * run.sample_rate))
    stop = run.time.size - edge
    fine = points[FINER * edge : FINER * stop]
    passed = sampling["pass_frequency"] / run.sample_rate
    false, largest = false_lines(run.mesh_force[0, edge:stop], fine, passed)
    share = np.max(false) / largest
    name = f"largest false line of the mesh force, {scene.__name__}, {rpm:g} rpm"
    record_figure(name, share, "below 1e-3", "", "own target")
    assert share < 1e-3
    assert np.sqrt(0.5 * np.sum(false**2) / HANN_BANDWIDTH) < error["folded"] + 1e-4 * largest
    assert highest_valid_order(run) >= 10
    peak = run.receipt["peaks"]["mesh_force"]["mesh"]["peak"]
    assert peak == pytest.approx(np.max(points), rel=1e-3)
    assert run.largest_mesh_force.max() == pytest.approx(peak, rel=5e-3)
    rms = run.receipt["peaks"]["mesh_force"]["mesh"]["rms"]
    assert rms == pytest.approx(np.sqrt(np.mean(points**2)), rel=2e-3)


@pytest.mark.drawn
@pytest.mark.parametrize("rpm", [500.0, 955.0, 9000.0])
@pytest.mark.parametrize("scene", SCENES)
def test_a_peak_does_not_depend_on_the_rate_of_the_output(scene, rpm, record_figure):
    """A rate far below the mode that the meshes excite: peaks are those of the motion, not of samples."""
    made = of_length(scene, rpm)
    truth = np.max(force_points(made, DENSE))
    missed = []
    for rate in (1e3, 2e3, 5e3, 20e3):
        run = simulate(replace(made, outputs=replace(made.outputs, sample_rate=rate)))
        peak = run.receipt["peaks"]["mesh_force"]["mesh"]["peak"]
        missed.append(abs(peak / truth - 1.0))
    name = f"largest error of a peak at output rates from 1 kHz, {scene.__name__}, {rpm:g} rpm"
    record_figure(name, 100.0 * max(missed), "below 0.2 %", "%", "own target")
    assert max(missed) < 2e-3


def test_points_at_a_fixed_rate_fold_a_false_line_and_miss_the_peak():
    """24 000 rpm of 20 teeth at 20 kHz: the second order, 16 kHz, appears at 4 kHz."""
    scene = of_length(spur, 24000.0)
    truth = simulate(scene)
    points = simulate(replace(scene, outputs=Outputs(20e3, anti_alias=False)))
    held = simulate(replace(scene, outputs=Outputs(12e3)))
    peak = truth.receipt["peaks"]["mesh_force"]["mesh"]["peak"]
    assert points.mesh_force.max() < 0.99 * peak
    for run in (points, held):
        assert run.receipt["peaks"]["mesh_force"]["mesh"]["peak"] == pytest.approx(peak, rel=1e-3)
    assert np.std(held.mesh_force) < 0.3 * np.std(points.mesh_force)
    assert highest_valid_order(held) == 0
    removed = held.receipt["error"]["sampling"]["mesh_force"]["mesh"]["removed"]
    assert removed == pytest.approx(np.std(truth.mesh_force), rel=0.1)


def test_the_rate_follows_orders_and_modes_and_says_so():
    slow, fast = (assemble(of_length(spur, rpm)).sampling for rpm in (500.0, 24000.0))
    assert slow.mode_frequency == fast.mode_frequency > 1000.0
    assert slow.rate >= 2.56 * slow.mode_frequency
    assert "mode" in slow.chosen
    assert fast.rate >= 25.6 * 8000.0
    assert "10 orders" in fast.chosen
    more = replace(of_length(spur, 24000.0), outputs=Outputs(mesh_orders=20, band=WIDE))
    assert assemble(more).sampling.rate >= 51.2 * 8000.0
    fixed = assemble(replace(more, outputs=Outputs(30e3))).sampling
    assert (fixed.rate, fixed.chosen) == (30e3, "sample_rate of the scene")


def test_a_run_is_made_for_the_audio_band_unless_it_is_wider():
    """24 000 rpm of 20 teeth: orders 1 and 2 are in the band, the others in the receipt by linear theory."""
    wide = of_length(spur, 24000.0)
    heard = replace(wide, outputs=Outputs(energy_audit=False))
    sampling = assemble(heard).sampling
    assert (sampling.rate, sampling.pass_frequency) == (51.2e3, 20e3)
    assert sampling.chosen == "band of the output, 2e+04 Hz; orders and modes reach 8e+04 Hz"
    slow, slower = (replace(part, outputs=Outputs()) for part in (of_length(spur, 500.0), heard))
    assert "mode" in assemble(slow).sampling.chosen and "band" in assemble(slower).sampling.chosen
    run = simulate(heard)
    assert highest_valid_order(run) == 2
    with pytest.raises(InputError, match=r"mesh_orders = 4 and outputs.band of 3.2e\+04 Hz"):
        order_track(run, "mesh_force", 16, 4)
    above = run.receipt["linear_orders"]
    assert above["order"] == [float(order) for order in range(3, 11)]
    whole = harmonic_response(assemble(wide), np.array([24000.0 * RPM]), 10)
    expected = np.abs(whole.dynamic_transmission_error[0, 0, 2:])
    np.testing.assert_allclose(above["dynamic_transmission_error"]["mesh"], expected, rtol=1e-9)
    assert "linear_orders" not in simulate(slow).receipt


def test_orders_of_the_audio_band_do_not_need_a_wider_one():
    """Elastic shafts resolved for the band: bearing forces of orders 1 and 2 within 0.1 dB of ten orders."""
    levels = []
    for band in (20e3, WIDE):
        scene = flexible_pair(gear=0.1, speed=TimeLaw.constant(24000.0 * RPM), table=square_wave_table())
        system = assemble(replace(scene, outputs=Outputs(band=band)))
        force = harmonic_response(system, np.array([24000.0 * RPM]), 2).bearing_force[:, :3, 0]
        levels.append(20.0 * np.log10(np.sqrt(np.sum(np.abs(force) ** 2, axis=(0, 1)))))
    assert np.max(np.abs(levels[0] - levels[1])) < 0.1


def test_orders_above_the_valid_one_are_refused_with_the_rate_to_ask_for():
    scene = replace(of_length(spur, 6000.0), outputs=Outputs(20e3))
    run = simulate(scene)
    assert highest_valid_order(run) == 3
    for name, call in (
        ("highest", lambda: order_track(run, "mesh_force", 16, 4)),
        ("orders", lambda: sidebands(run, run.mesh_force[0], 4)),
    ):
        with pytest.raises(InputError, match=rf"{name}.*4.*at most 3.*outputs.mesh_orders = 4.*2.048e\+04"):
            call()
    track = order_track(run, "mesh_force")
    assert track.line.tolist() == [0, 1, 2, 3]
    wider = simulate(replace(scene, outputs=Outputs(2.048e4)))
    assert order_track(wider, "mesh_force", 16, 4).line[-1] == 4


def test_the_filter_stops_what_would_fold_and_passes_the_rest():
    sampling = assemble(of_length(spur, 24000.0)).sampling
    taps = sampling.filter_taps()
    at = np.arange(taps.size)

    def gain(frequency):
        return np.abs(np.exp(-2j * np.pi * np.outer(frequency / sampling.inner_rate, at)) @ taps)

    stop = np.linspace(sampling.stop_frequency, 0.5 * sampling.inner_rate, 500)
    assert 20.0 * np.log10(gain(stop).max()) < -sampling.stop_band
    assert np.abs(gain(np.linspace(0.0, sampling.pass_frequency, 500)) - 1.0).max() < 2e-4
    assert np.abs(taps - taps[::-1]).max() == 0.0
