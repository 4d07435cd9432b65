"""What the receipt of a run says of its errors, against runs that are right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, square_wave_table
from planetary_scenes import planetary_scene, published_set

from dynamics.assembly.assemble import assemble
from dynamics.integrators import integrate, static_equilibrium
from dynamics.loads import TimeLaw
from dynamics.results.order_fit import order_amplitudes, unwrapped
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate
from dynamics.simulation.error_by_source import windows


def run_up(positions, **changes):
    speed = TimeLaw.ramp(0.0, 955.0 * RPM, 1.0)
    return gear_pair_scene(square_wave_table(positions), speed=speed, duration=1.0, **changes)


def free_planets():
    tables = {"sun_table": square_wave_table(), "ring_table": square_wave_table()}
    return planetary_scene(published_set(3, **tables), duration=0.1)


def difference(one, other, error):
    """rms of the transmission errors' difference, and its worst order amplitudes in the windows."""
    apart = one.dynamic_transmission_error - other.dynamic_transmission_error
    pushed = one.bearing_force - other.bearing_force
    parts = [slice(first, last + 1) for first, last in error["windows"]]
    position = [unwrapped(one.position[0, part]) for part in parts]
    by_error = [order_amplitudes(x, apart[0, part], 5) for x, part in zip(position, parts, strict=True)]
    by_force = [
        np.linalg.norm(order_amplitudes(x, pushed[..., part], 5), axis=1).max(axis=0)
        for x, part in zip(position, parts, strict=True)
    ]
    return np.sqrt(np.mean(apart**2)), np.max(by_error, axis=0), np.max(by_force, axis=0)


@pytest.mark.parametrize("tolerance", [1e-8, 1e-9])
def test_the_error_of_the_steps_is_the_one_stated(tolerance, record_figure):
    scene = run_up(64, integration=Integration(tolerance=tolerance))
    run, right = simulate(scene), simulate(replace(scene, integration=Integration(tolerance=1e-12)))
    stated = run.receipt["error"]["time_step"]
    rms, by_error, by_force = difference(run, right, run.receipt["error"])
    record_figure(
        f"stated over true step error, {1e9 * tolerance:g} nm", stated["rms"] / rms, "0.5 to 2", "1", "own"
    )
    assert 0.5 < stated["rms"] / rms < 2.0
    assert 0.3 < max(stated["transmission_error_orders"]) / max(by_error) < 3.0
    assert 0.3 < max(stated["bearing_force_orders"]) / max(by_force) < 3.0


@pytest.mark.parametrize("positions", [24, 64])
def test_the_error_of_the_table_is_within_the_one_stated(positions, record_figure):
    fine = Integration(tolerance=1e-10)
    run, right = simulate(run_up(positions, integration=fine)), simulate(run_up(1024, integration=fine))
    stated = run.receipt["error"]["table_interpolation"]
    rms, by_error, _ = difference(run, right, run.receipt["error"])
    name = f"stated over true error of a table of {positions} positions"
    record_figure(name, stated["rms"] / rms, "0.5 to 10", "1", "own")
    assert 0.5 < stated["rms"] / rms < 10.0
    assert 0.3 * max(by_error) < max(stated["transmission_error_orders"]) < 30.0 * max(by_error)


@pytest.mark.parametrize("make", [lambda: run_up(64), free_planets], ids=["drive", "free train"])
def test_a_window_run_again_as_it_was_is_the_run(make):
    """Law, loads and counted quanta at its start are right: only the choice of steps is another."""
    system = assemble(make())
    found = integrate(system, static_equilibrium(system), system.scene.integration)
    looked = windows(system, found.states.rows, found.samples)
    for window in looked:
        again = window.repeated(window.system, system.scene.integration)
        assert again is not None
        assert again.rms < 1e-9 < 1e-3 * np.ptp(window.error)
    assert found.states.moved[-1].any() == (system.scene.drives[0].name == "ring held")


def test_a_minimal_receipt_states_the_tolerance_and_changes_no_series():
    scene = run_up(64)
    full = simulate(scene)
    lean = simulate(replace(scene, outputs=Outputs(receipt="minimal")))
    np.testing.assert_array_equal(full.mesh_force, lean.mesh_force)
    assert lean.receipt["error"]["time_step"]["rms"] == 1e-9
    assert "table_interpolation" not in lean.receipt["error"]
    assert full.receipt["error"]["left_out_effects"] == lean.receipt["error"]["left_out_effects"]


def test_effects_that_are_off_are_named_with_their_influence():
    off = run_up(64, effects={"lateral": "off"}, outputs=Outputs(receipt="minimal"))
    found = simulate(replace(off, duration=0.01)).receipt["error"]["left_out_effects"]
    assert found["effects"]["lateral of input"] == found["effects"]["lateral of output"] > 1e-6
    assert found["rms"] == max(found["effects"].values())
