"""The static part of the mesh force: what the table gives, with the impulses of the handover of teeth."""

from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import NOMINAL_FORCE, RPM, gear_pair_scene, square_wave_table

from dynamics import RunResult, TimeLaw, simulate, simulate_to_file

HANDOVER = 0.22
"""Half of the part of a base pitch that two pairs share, where the stiffness steps."""


def run(technique: str, rpm: float = 300.0, **outputs: bool) -> RunResult:
    scene = gear_pair_scene(speed=TimeLaw.constant(rpm * RPM), duration=0.06, technique=technique)
    stated = replace(scene.outputs, sample_rate=40_000.0, elastic_forces=True, **outputs)
    return simulate(replace(scene, outputs=stated))


def test_with_constant_torque_it_is_the_secant_stiffness_times_the_deflection():
    result = run("constant_torque", anti_alias=False)
    secant = result.nominal_force[0] / result.static_transmission_error[0]
    deflection = np.maximum(result.dynamic_transmission_error[0], 0.0)
    np.testing.assert_allclose(result.elastic_force[0], secant * deflection, rtol=1e-5)
    assert np.ptp(result.elastic_force[0] - result.mesh_force[0]) > 1.0  # damping is not in it


def test_it_jumps_where_teeth_hand_over():
    """k steps by half where a pair enters or leaves, and the deflection has no time to follow."""
    result = run("constant_torque", 900.0)
    force, position = result.elastic_force[0], result.position[0]
    jump = np.abs(np.diff(force))
    steepest = position[:-1][np.argsort(jump)[-12:]]
    distance = np.abs(np.abs(steepest - np.round(steepest)) - HANDOVER)
    assert distance.max() < 0.05  # the step of the table is 0.04 wide
    assert np.ptp(force) > 0.05 * result.nominal_force[0]


@pytest.mark.parametrize("technique", ["constant_torque", "variable_torque"])
def test_less_the_mesh_force_it_is_the_damping_which_has_no_mean(technique):
    result = run(technique, anti_alias=False)
    damping = result.mesh_force[0] - result.elastic_force[0]
    rate = np.gradient(result.dynamic_transmission_error[0], result.time)
    assert np.corrcoef(damping[10:-10], rate[10:-10])[0, 1] > 0.99


def test_it_is_stored_if_it_is_asked_for_alone(tmp_path):
    scene = gear_pair_scene(table=square_wave_table(), duration=0.02)
    assert simulate(scene).elastic_force.size == 0
    stated = replace(scene, outputs=replace(scene.outputs, elastic_forces=True))
    whole = simulate(stated)
    assert whole.elastic_force.shape == whole.mesh_force.shape
    assert whole.elastic_force.max() < 3.0 * NOMINAL_FORCE
    simulate_to_file(stated, tmp_path / "run.nc")
    streamed = RunResult.from_netcdf(tmp_path / "run.nc")
    np.testing.assert_array_equal(streamed.elastic_force, whole.elastic_force)
