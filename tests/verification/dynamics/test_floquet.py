"""Floquet multipliers against closed forms, Liouville, and published bands of instability."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table, with_bushings, with_mesh
from scipy.optimize import brentq

from dynamics.assembly.assemble import assemble
from dynamics.joints import ImposedRotation
from dynamics.linearize import natural_modes
from dynamics.loads import LoadTorque, TimeLaw
from dynamics.meshes import GearMesh
from dynamics.periodic import Instability, find_orbit, periodic_problem
from dynamics.scene import Integration, Scene
from dynamics.shafts import GearBody, Inertia, Shaft

TEETH = 20
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
        GearBody(f"g{k}", f"s{k}", 0.5, TEETH, 1.0, 0.1, 0.0, Inertia(1.0, 1.0, 1.0)) for k in range(2)
    )
    scene = Scene(
        (Shaft("s0", 1.0), Shaft("s1", 1.0, (2.2, 0.0, 0.0))),
        gears,
        (GearMesh("m", "g0", "g1", rectangular_table(contact_ratio, ratio), damping=2.0 * zeta),),
        (ImposedRotation("d", "s0", TimeLaw.constant(1.0 / TEETH)),),
        duration=1.0,
        loads=(LoadTorque("l", "s1", TimeLaw.constant(1.0)),),
        integration=Integration(method),
    )
    return periodic_problem(assemble(scene), 0.9 / TEETH)


@pytest.mark.parametrize("case", BANDS)
def test_bands_of_a_rectangular_stiffness(case, record_figure):
    """Bounds of the unstable bands: where a multiplier passes -1 (main band) or +1."""
    problem, worst = hill(*case), 0.0
    for band in BANDS[case]:
        sign = -1.0 if band[0] > 1.5 else 1.0

        def stable(frequency, sign=sign):
            found = find_orbit(problem, frequency / TEETH).multipliers
            return float(np.prod(sign - found).real)

        middle = find_orbit(problem, np.mean(band) / TEETH)
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
        orbit = find_orbit(problem, frequency / TEETH)
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
