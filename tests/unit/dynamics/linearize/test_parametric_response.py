"""Response with a stiffness that varies along the pitch: linear limit, time domain, swept resonances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, spring_table, square_wave_table, with_mesh

from dynamics.assembly.assemble import assemble
from dynamics.linearize import harmonic_response
from dynamics.linearize.harmonic_response import extremes, parametric_response
from dynamics.linearize.steady_vibration import excited, swept_vibration
from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate

STIFFNESS, RIPPLE = 4e8, 1e-7
MASS = 1.1344291072112745e-3 / BASE_RADIUS**2
NATURAL = np.sqrt(STIFFNESS / MASS)


def test_a_constant_stiffness_leaves_the_harmonic_response():
    system = assemble(gear_pair_scene(spring_table(STIFFNESS, RIPPLE)))
    speed = np.array([60.0, 300.0])
    found, shift = parametric_response(excited(system, 0.0, 4), speed, np.zeros(2), 4)
    plain = harmonic_response(system, speed, 4)
    first = found.dynamic_transmission_error[:, :, :1]
    largest = np.max(np.abs(plain.dynamic_transmission_error))
    np.testing.assert_allclose(first, plain.dynamic_transmission_error, atol=1e-9 * largest, rtol=0.0)
    np.testing.assert_allclose(shift, 0.0, atol=1e-9 * largest)
    np.testing.assert_allclose(found.bearing_force[..., :1], plain.bearing_force, rtol=1e-6)


@pytest.mark.parametrize("rpm", [700.0, 2300.0, 6000.0])
def test_a_varying_stiffness_is_that_of_the_time_domain(rpm):
    """The 20/20 pair, one or two teeth in contact; with the mean stiffness alone it is far off."""
    scene = gear_pair_scene(
        square_wave_table(), speed=TimeLaw.constant(rpm * RPM), duration=0.3, on_violation="report"
    )
    scene = with_mesh(scene, damping_ratio=0.1)
    at = excited(assemble(scene), 0.0, 24, 256)
    found, shift = parametric_response(at, np.array([rpm * RPM]), np.zeros(1), 24)
    least, most = extremes(found.dynamic_transmission_error, found.order)
    outputs = Outputs(sample_rate=1e5, energy_audit=False, receipt="minimal")
    run = simulate(replace(scene, outputs=outputs, integration=Integration(tolerance=1e-10)))
    error = run.dynamic_transmission_error[0, run.time.size // 2 :]
    assert (most - least)[0, 0] == pytest.approx(np.ptp(error), rel=0.05)
    mean = np.mean(at.cycles[0].static_error) + shift[0, 0]
    assert mean == pytest.approx(np.mean(error), rel=2e-3)
    force = run.bearing_force[0, 1, run.time.size // 2 :]
    low, high = extremes(found.bearing_force[:1, 1], found.order)
    assert (high - low)[0, 0] == pytest.approx(np.ptp(force), rel=0.1)
    assert found.least_mesh_force[0, 0] == pytest.approx(
        np.min(run.mesh_force[0, run.time.size // 2 :]), abs=0.06 * 2660.0
    )


def test_a_swept_resonance_is_as_high_as_it_can_grow():
    """One freedom hardly damped, driven through its resonance in 0.4 s (Lewis, 1932)."""
    top = 2.0 * NATURAL / 20
    scene = replace(gear_pair_scene(spring_table(STIFFNESS, RIPPLE), duration=0.4), bushings=(), effects={})
    scene = with_mesh(scene, damping=2e-4 * MASS * NATURAL)
    scene = replace(
        scene,
        drives=(replace(scene.drives[0], speed=TimeLaw((0.0, 0.4), (0.02 * top, top))),),
        outputs=Outputs(sample_rate=1e5, energy_audit=False, receipt="minimal"),
    )
    run = simulate(scene)
    swing = np.ptp(run.dynamic_transmission_error[0]) / 2.0
    speed, rate = np.array([NATURAL / 20]), np.array([0.98 * top / 0.4])
    at = excited(assemble(scene), 0.0, 4)
    found = swept_vibration(at, speed, rate, np.array([1]))
    amplitude = np.abs(found.displacement @ at.system.arrays.direction[0])[0, 0]
    assert amplitude == pytest.approx(swing, rel=0.15)
    standing = swept_vibration(at, speed, np.zeros(1), np.array([1]))
    assert np.abs(standing.displacement @ at.system.arrays.direction[0])[0, 0] > 4.0 * amplitude
