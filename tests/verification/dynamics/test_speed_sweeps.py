"""Slow run-up and run-down of a lightly loaded pair through resonance, against branches by shooting."""

from __future__ import annotations

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, square_wave_table, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.loads import TimeLaw
from dynamics.periodic import Instability, follow_branch, motion, periodic_problem, sweep
from dynamics.scene import Outputs
from dynamics.simulation import simulate

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
