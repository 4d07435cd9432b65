"""Outcomes of runs: complete, or ended early with a status and what was computed."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, square_wave_table

from dynamics.assembly.assemble import assemble
from dynamics.errors import SolveError
from dynamics.integrators import static_equilibrium
from dynamics.integrators.advance import advance
from dynamics.integrators.march import start_march
from dynamics.integrators.workspace import Count
from dynamics.kernels.by_address import by_address
from dynamics.loads import TimeLaw
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate
from dynamics.types import RunStatus

SCENE = gear_pair_scene(duration=0.02)


def test_a_complete_run_covers_its_duration_and_tells_how():
    seen = []
    scene = replace(SCENE, integration=Integration("implicit"))
    result = simulate(scene, progress=lambda fraction, text: seen.append((fraction, text)))
    assert result.status is RunStatus.COMPLETED
    assert result.time[-1] == pytest.approx(SCENE.duration, abs=1.0 / result.sample_rate)
    np.testing.assert_allclose(result.time, np.arange(result.time.size) / result.sample_rate)
    assert [fraction for fraction, _ in seen] == sorted(fraction for fraction, _ in seen)
    assert seen[-1] == (1.0, "done")
    assert result.statistics.accepted > 100
    assert 0.0 < result.statistics.smallest_step <= result.statistics.largest_step <= 1e-3
    assert 1.0 <= result.statistics.newton_mean <= result.statistics.newton_most <= 25


def test_no_step_jumps_over_a_part_of_the_table():
    """With a stiff, silent system the error would allow steps of many base pitches."""
    silent = replace(SCENE, meshes=(replace(SCENE.meshes[0], table=spring_table(4e8)),), duration=0.2)
    statistics = simulate(replace(silent, integration=Integration(largest_step=0.1))).statistics
    assert statistics.largest_step * 300.0 <= 1.0 / 64.0
    assert statistics.largest_step * 300.0 > 0.5 / 64.0


def test_an_exception_in_the_progress_callback_ends_the_run():
    def stop(fraction: float, text: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate(SCENE, progress=stop)


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"step_limit": 50}, RunStatus.STEP_LIMIT),
        ({"tolerance": 1e-22, "smallest_step": 1e-8}, RunStatus.STEP_FLOOR),
        ({"method": "explicit", "fixed_step": 1e-3}, RunStatus.NOT_FINITE),
    ],
)
def test_a_run_that_cannot_go_on_keeps_what_it_has(changes, status):
    with pytest.raises(SolveError) as caught:
        simulate(replace(SCENE, duration=5.0, integration=Integration(**changes)))
    partial = caught.value.partial
    assert partial.status is status
    assert 1 <= partial.time.size < 100_000
    assert partial.mesh_force.shape == (1, partial.time.size)
    assert np.isfinite(partial.time[-1])
    assert status.name.lower() in str(caught.value)
    assert pickle.loads(pickle.dumps(caught.value)).partial.status is status


@pytest.mark.parametrize("speed", [TimeLaw.constant(90.0), TimeLaw((0.0, 0.007, 0.0145), (0.0, 50.0, 90.0))])
def test_cutting_a_run_into_chunks_changes_no_bit(speed):
    system = assemble(gear_pair_scene(speed=speed, duration=0.02))
    start = static_equilibrium(system)

    def run(stops):
        march = start_march(system, start, Integration(tolerance=1e-9))
        out = march.widths.states(march.samples)
        for stop in stops:
            advance(*march.compiled, stop, by_address(out))
        work = march.work
        return out.q, out.filtered, out.largest, work.work, int(work.counts[Count.ACCEPTED])

    whole, parts = run([0.02]), run([*np.linspace(0.0, 0.014, 29)[1:], 0.0145, 0.0146, 0.02])
    assert whole[-1] == parts[-1] > 100
    for a, b in zip(whole[:-1], parts[:-1], strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_run_of_no_duration_is_the_equilibrium():
    result = simulate(replace(SCENE, duration=0.0))
    assert result.time.tolist() == [0.0]
    assert result.mesh_force[0, 0] == pytest.approx(result.nominal_force[0], rel=1e-6)


def test_outputs_not_requested_are_empty():
    result = simulate(replace(SCENE, outputs=Outputs(bearing_forces=False, energy_audit=False)))
    samples = result.time.size
    assert result.bearing_force.shape == (0, 3, samples)
    assert result.bearing == result.freedom == ()
    assert result.energy is None
    everything = simulate(replace(SCENE, outputs=Outputs(displacements=True)))
    assert everything.displacement.shape == (5, samples)
    np.testing.assert_array_equal(result.mesh_force, everything.mesh_force)  # the audit changes no bit


def test_the_error_estimate_bounds_the_true_error():
    scene = gear_pair_scene(square_wave_table(), duration=0.05)
    changed = replace(scene, integration=Integration(tolerance=1e-8, estimate_error=True))
    result = simulate(changed)
    fine = simulate(replace(scene, integration=Integration(tolerance=1e-13)))
    true = np.sqrt(np.mean((result.dynamic_transmission_error - fine.dynamic_transmission_error) ** 2))
    estimate = result.receipt["error"]["time_step"]["rms"]
    assert 0.5 * true < estimate < 2.0 * true
    assert true < 1e-8
