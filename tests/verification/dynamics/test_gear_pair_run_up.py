"""The run-up of the 20/20 pair: both techniques overlap, mean force, spectrum of the bearing force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, square_wave_table

from dynamics.loads import TimeLaw
from dynamics.orders import find_peaks, mesh_orders, window_spectrum
from dynamics.simulation import simulate


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
