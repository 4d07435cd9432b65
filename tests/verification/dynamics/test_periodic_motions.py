"""Periodic motions: their branches, folds and Floquet multipliers."""

from dataclasses import replace

import numpy as np
import pytest
from backlash_oscillator import CONVERGED, TEETH, excitation, oscillator
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table, with_bushings, with_mesh
from scipy.optimize import brentq

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.joints import ImposedRotation
from dynamics.linearize import natural_modes
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import GearMesh
from dynamics.periodic import (
    BranchStatus,
    Instability,
    find_orbit,
    follow_branch,
    motion,
    periodic_problem,
    settled,
)
from dynamics.scene import Integration, Scene
from dynamics.shafts import GearBody, Inertia, Shaft

# Floquet multipliers against closed forms, Liouville, and published bands of instability.


TEETH_OF_THE_PAIR = 20
# contact ratio, stiffness ratio, damping ratio: unstable bands of mesh frequency over natural frequency,
# converged independently to the digits given
BANDS = {
    (1.5, 1.6, 0.0): ((1.851003, 2.144158), (0.979949, 1.006525)),
    (1.5, 1.6, 0.03): ((1.862880, 2.130474),),
    (1.3, 2.0, 0.0): ((1.792849, 2.199089),),
    (1.7, 1.3, 0.03): ((1.979004, 2.018809),),
}


def rectangular_table(contact_ratio, ratio):
    """Two stiffnesses of mean 1; the deflection at 1 N is 2 m throughout, so that nothing is excited."""
    double = contact_ratio - 1.0
    low = 1.0 / (1.0 + (ratio - 1.0) * double)
    k = np.array([ratio * low, ratio * low, low, low])
    table = spring_table(1.0, 0.0, positions=4)
    deflection = np.stack([2.0 - 1.0 / k, np.full(4, 2.0)], axis=-1)
    position = np.array([0.0, double, double + 1e-7, 1.0 - 1e-7])
    zero = np.zeros((1, 1, 4, 2))
    stiffness = np.repeat(k[:, None], 2, axis=1)[None, None]
    return replace(
        table,
        position=position,
        deflection=deflection[None, None],
        deflection_slope=zero,
        stiffness=stiffness,
        stiffness_slope=zero,
    )


def hill(contact_ratio, ratio, zeta, method="implicit"):
    """x'' + 2 zeta x' + k(t) x = 0 about the equilibrium of a gear on the rectangular table."""
    gears = tuple(
        GearBody(f"g{k}", f"s{k}", 0.5, TEETH_OF_THE_PAIR, 1.0, 0.1, 0.0, Inertia(1.0, 1.0, 1.0))
        for k in range(2)
    )
    scene = Scene(
        (Shaft("s0", 1.0), Shaft("s1", 1.0, (2.2, 0.0, 0.0))),
        gears,
        (GearMesh("m", "g0", "g1", rectangular_table(contact_ratio, ratio), damping=2.0 * zeta),),
        (ImposedRotation("d", "s0", TimeLaw.constant(1.0 / TEETH_OF_THE_PAIR)),),
        duration=1.0,
        loads=(LoadTorque("l", "s1", TimeLaw.constant(1.0)),),
        integration=Integration(method),
    )
    return periodic_problem(assemble(scene), 0.9 / TEETH_OF_THE_PAIR)


@pytest.mark.parametrize("case", BANDS)
def test_bands_of_a_rectangular_stiffness(case, record_figure):
    """Bounds of the unstable bands: where a multiplier passes -1 (main band) or +1."""
    problem, worst = hill(*case), 0.0
    for band in BANDS[case]:
        sign = -1.0 if band[0] > 1.5 else 1.0

        def stable(frequency, sign=sign):
            found = find_orbit(problem, frequency / TEETH_OF_THE_PAIR).multipliers
            return float(np.prod(sign - found).real)

        middle = find_orbit(problem, np.mean(band) / TEETH_OF_THE_PAIR)
        assert middle.instability is (Instability.PERIOD_DOUBLING if sign < 0.0 else Instability.FOLD)
        for bound in band:
            assert stable(bound - 0.01) * stable(bound + 0.01) < 0.0
            worst = max(worst, abs(brentq(stable, bound - 0.01, bound + 0.01, xtol=1e-8) - bound))
    name = "rectangular stiffness {}/{}/{}, bounds of the unstable bands".format(*case)
    record_figure(name, worst, "at most 1e-3", "1", "converged numbers")
    assert worst < 5e-6


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_the_product_of_the_multipliers_is_liouvilles(method):
    """exp(-T trace C) on a jumping stiffness, whatever the stiffness does."""
    problem = hill(1.5, 1.6, 0.03, method)
    for frequency in (0.95, 1.3, 2.0):
        orbit = find_orbit(problem, frequency / TEETH_OF_THE_PAIR)
        expected = np.exp(-2.0 * 0.03 * orbit.duration)
        assert np.prod(orbit.multipliers).real == pytest.approx(expected, rel=1e-6)


def test_damped_bearings_and_mesh_obey_liouville_too():
    system = assemble(gear_pair_scene(spring_table(4e8, 1e-6), speed=TimeLaw.constant(900.0 * RPM)))
    problem = periodic_problem(system, 900.0 * RPM)
    orbit = find_orbit(problem, 900.0 * RPM)
    g = system.arrays.direction[0]
    damping = system.arrays.damping + system.flanks.law.damping[0] * np.outer(g, g)
    expected = np.exp(-np.trace(np.linalg.solve(system.arrays.mass, damping)) * orbit.duration)
    assert np.prod(orbit.multipliers).real == pytest.approx(expected, rel=1e-4)


def undamped(table):
    scene = gear_pair_scene(table, speed=TimeLaw.constant(3000.0 * RPM))
    scene = with_bushings(scene, radial_damping=0.0, axial_damping=0.0)
    return assemble(with_mesh(replace(scene, integration=Integration("explicit")), damping=0.0))


def test_a_constant_stiffness_turns_each_mode_by_its_frequency():
    """Multipliers exp(+-i omega_j T)."""
    system = undamped(spring_table(4e8))
    orbit = find_orbit(periodic_problem(system, 3000.0 * RPM, steps_per_cycle=48), 3000.0 * RPM)
    omega = 2.0 * np.pi * natural_modes(system).frequency
    expected = np.exp(1j * np.concatenate([omega, -omega]) * orbit.duration)
    nearest = [np.min(np.abs(orbit.multipliers - value)) for value in expected]
    assert max(nearest) < 1e-6


def test_undamped_multipliers_come_in_reciprocal_pairs():
    """On a stiffness that varies: the map is symplectic."""
    system = undamped(square_wave_table())
    orbit = find_orbit(periodic_problem(system, 3000.0 * RPM, steps_per_cycle=48), 3000.0 * RPM)
    assert orbit.status.usable
    for value in orbit.multipliers:
        assert np.min(np.abs(orbit.multipliers - 1.0 / value)) < 1e-5


# One freedom with backlash by shooting, and its jumps, against converged numbers and the time domain.


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
