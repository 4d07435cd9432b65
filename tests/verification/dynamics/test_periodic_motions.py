"""One freedom with backlash by shooting, and its jumps, against converged numbers and the time domain."""

from __future__ import annotations

import numpy as np
import pytest
from backlash_oscillator import CONVERGED, TEETH, excitation, oscillator

from dynamics.integrators import integrate, static_equilibrium
from dynamics.periodic import BranchStatus, find_orbit, follow_branch, motion, periodic_problem, settled

JUMPS = {"up": 0.8285, "down": 0.7080}
CONTACT_LOSS = 0.8206


def problem_at(frequency, slowest=0.5):
    return periodic_problem(oscillator(frequency), slowest / TEETH)


def deflection(problem, orbit, frequency):
    """d - e over the period."""
    found = motion(problem, orbit)
    error = excitation(frequency) * np.cos(2 * np.pi * np.arange(found.time.size) / found.time.size)
    return found.dynamic_transmission_error[0] - error


@pytest.mark.parametrize("branch", [0, 1], ids=["up", "down"])
def test_both_branches_by_shooting(branch, record_figure):
    """Each settled from the motion at the frequency before it in the sweep."""
    state, errors = None, {}
    for frequency in sorted(CONVERGED, reverse=branch == 1):
        problem = problem_at(frequency)
        state = settled(problem, frequency / TEETH, state)
        orbit = find_orbit(problem, frequency / TEETH, state)
        assert orbit.status.usable
        assert orbit.stable
        state = orbit.state
        rms = np.std(deflection(problem, orbit, frequency))
        errors[frequency] = rms / CONVERGED[frequency][branch] - 1.0
    worst = max(map(abs, errors.values()))
    name = f"oscillator with backlash by shooting, rms, {'up' if branch == 0 else 'down'}, worst"
    record_figure(name, 100.0 * worst, "at most 0.5 %", "%", "converged numbers")
    assert worst < 5e-4, errors


@pytest.mark.law
@pytest.mark.parametrize("name", JUMPS)
def test_the_branch_turns_back_where_a_sweep_jumps(name, record_figure):
    """The excitation is exact at the jump, and the branch in between is unstable."""
    jump = JUMPS[name]
    problem = problem_at(jump, 0.6)
    start, end = (0.65, 0.9) if name == "up" else (0.9, 0.65)
    branch = follow_branch(problem, start / TEETH, end / TEETH, 0.05, settled(problem, start / TEETH))
    assert branch.status is BranchStatus.COMPLETED
    assert branch.folds.size == 2
    found = branch.folds[0] * TEETH
    record_figure(f"jump {name} by shooting", found, f"{jump} within 0.003", "1", "converged numbers")
    assert abs(found - jump) < 3e-4
    first, last = (b.point for b in branch.bifurcations)
    assert [orbit.stable for orbit in branch.orbits].count(False) == last - first
    assert not any(orbit.stable for orbit in branch.orbits[first + 1 : last + 1])


def test_flanks_part_from_the_converged_frequency_on():
    problem = problem_at(CONTACT_LOSS)
    for frequency, parts in ((CONTACT_LOSS - 3e-4, False), (CONTACT_LOSS + 3e-4, True)):
        found = motion(problem, find_orbit(problem, frequency / TEETH))
        assert bool(found.parted[0] > 0.0) is parts


@pytest.mark.law
def test_a_run_from_a_motion_stays_on_it_and_leaves_an_unstable_one():
    frequency = 0.8
    problem = problem_at(frequency)
    speed = frequency / TEETH
    branch = follow_branch(problem, 0.7 / TEETH, 0.9 / TEETH, 0.05)
    states = [orbit.state for orbit in branch.orbits]
    near = np.argsort(np.abs(branch.speed - speed))
    kinds = {branch.orbits[k].stable: states[k] for k in near[::-1]}
    for stable in (True, False):
        orbit = find_orbit(problem, speed, kinds[stable])
        assert orbit.stable is stable
        nudged = orbit.state + 1e-4
        q, v = nudged[:1] / problem.scale[:1], nudged[1:] / problem.scale[1:]
        system = oscillator(frequency, periods=20)
        start = static_equilibrium(system)
        start = type(start)(start.status, q, start.mesh_force, start.residual, start.iterations)
        run = integrate(system, start, system.scene.integration, velocity=v)
        left = abs(run.q[64 * 19, 0] * problem.scale[0] - orbit.state[0])
        growth = abs(orbit.multipliers[0]) ** 19
        if stable:
            assert left < 20 * 1e-4 * growth + 1e-5
        else:
            assert left > 0.1
