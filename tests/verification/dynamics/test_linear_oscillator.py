"""One linear freedom against its closed form, and the measured order of both integrators."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, spring_table, with_mesh

from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate

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
