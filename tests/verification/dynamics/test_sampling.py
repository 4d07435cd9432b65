"""What is stored of a run holds the motion up to its highest valid order, and nothing that folded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table, with_gear, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.loads import TimeLaw
from dynamics.meshes import CoastFlank
from dynamics.orders import highest_valid_order, order_track, sidebands
from dynamics.scene import Outputs
from dynamics.simulation import simulate

FINER = 20
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


def of_length(scene, rpm):
    frequency = 20.0 * rpm / 60.0
    outputs = Outputs(energy_audit=False, receipt="minimal")
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
    more = replace(of_length(spur, 24000.0), outputs=Outputs(mesh_orders=20))
    assert assemble(more).sampling.rate >= 51.2 * 8000.0
    fixed = assemble(replace(more, outputs=Outputs(30e3))).sampling
    assert (fixed.rate, fixed.chosen) == (30e3, "sample_rate of the scene")


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
