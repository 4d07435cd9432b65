"""One freedom with backlash by time integration: rms of both branches, and the jumps between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from backlash_oscillator import CONVERGED, SAMPLES, excitation, oscillator

from dynamics.integrators import integrate, static_equilibrium


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
