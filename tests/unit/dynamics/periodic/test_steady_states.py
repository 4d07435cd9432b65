"""Steady states as a study: jumps beside the folds, linear limit, flanks of several rows, status, files."""

import json
from dataclasses import replace

import h5netcdf
import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, spring_table, square_wave_table, with_gear, with_mesh
from sliced_face import sliced_database

from dynamics import CoastFlank, Integration, Outputs, TimeLaw, simulate, steady_states
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError, ResultError
from dynamics.linearize import harmonic_response
from dynamics.periodic import OrbitStatus, SteadyStates, find_orbit, periodic_problem, sweep
from dynamics.periodic.steady_states import BRANCH, DOWN, UP

SPEEDS = np.array([11600.0, 11900.0, 12300.0, 12700.0]) * RPM


def light_pair(sense=1.0):
    """The 20/20 pair at 20 N m: its flanks part in the resonance near 12 000 rpm."""
    scene = gear_pair_scene(square_wave_table(), torque=20.0, speed=TimeLaw.constant(sense * 11600.0 * RPM))
    return with_mesh(scene, damping_ratio=0.07, damping=None)


@pytest.fixture(scope="module")
def light():
    return steady_states(assemble(light_pair()), SPEEDS)


def on(found: SteadyStates, curve: int) -> np.ndarray:
    points = np.flatnonzero(found.curve == curve)
    return points[np.argsort(found.speed[points], kind="stable")] if curve != BRANCH else points


def test_sweeps_jump_at_the_folds_of_the_branch(light):
    assert light.metadata["branch"] == "COMPLETED"
    folds = light.bifurcation_speed[light.bifurcation_kind == 1]
    jumps = {int(curve): ends for curve, ends in zip(light.jump_curve, light.jump_speed, strict=True)}
    assert set(jumps) == {UP, DOWN}
    assert jumps[UP].tolist() == SPEEDS[[2, 3]].tolist()
    assert jumps[DOWN].tolist() == SPEEDS[[1, 0]].tolist()
    assert jumps[UP][0] < folds[0] < jumps[UP][1]
    assert jumps[DOWN][1] < folds[-1] < jumps[DOWN][0]
    up, down = on(light, UP), on(light, DOWN)
    np.testing.assert_allclose(light.rms_error[up[[0, 3]]], light.rms_error[down[[0, 3]]], rtol=0.02)
    assert np.all(light.rms_error[down[1:3]] > 1.5 * light.rms_error[up[1:3]])


def test_the_branch_is_unstable_between_its_folds_and_parts_where_the_sweep_does(light):
    along = on(light, BRANCH)
    backwards = np.diff(light.speed[along]) < 0.0
    inner = along[1:-1][backwards[:-1] & backwards[1:]]
    assert inner.size > 5 and np.mean(light.instability[inner] == 1) > 0.8
    assert np.all(np.abs(light.multiplier[along[:5], 0]) < 1.0)
    down, up = on(light, DOWN), on(light, UP)
    assert np.all(light.parted[down[1:], 0] > 0.2) and np.all(light.parted[up[:3], 0] == 0.0)
    parts = light.parted[:, 0] > 0.0
    np.testing.assert_array_equal(light.least_force[:, 0] <= 0.0, parts)
    assert not np.any(light.coasting)


def test_a_pair_that_turns_the_other_way_does_the_same(light):
    found = steady_states(assemble(light_pair(-1.0)), SPEEDS[:1])
    np.testing.assert_allclose(found.rms_error[0], light.rms_error[on(light, UP)[0]], rtol=1e-6)
    assert found.speed[0] == pytest.approx(SPEEDS[0])
    assert found.metadata["branch"] == "none" and not np.any(found.curve != UP)


def test_a_small_ripple_gives_the_harmonic_response():
    speeds = np.array([300.0, 900.0]) * RPM
    system = assemble(gear_pair_scene(spring_table(4e8, 1e-7)))
    found = steady_states(system, speeds, branch=False)
    linear = harmonic_response(system, speeds, 1)
    up = on(found, UP)
    amplitude = np.abs(linear.dynamic_transmission_error[0, :, 0])
    np.testing.assert_allclose(found.rms_error[up, 0], amplitude / np.sqrt(2.0), rtol=2e-5)
    np.testing.assert_allclose(found.peak_to_peak_error[up, 0], 2.0 * amplitude, rtol=2e-4)
    force = np.sqrt(0.5 * np.sum(np.abs(linear.bearing_force[:, :3, :, 0]) ** 2, axis=1)).T
    np.testing.assert_allclose(found.rms_bearing_force[up], force, rtol=1e-4)
    minimum = linear.mean_force - np.abs(linear.mesh_force[:, :, 0]).T
    np.testing.assert_allclose(found.least_force[up], minimum, rtol=1e-5)
    np.testing.assert_array_equal(found.instability, 0)


def test_flanks_that_feel_misalignment_give_the_figures_of_a_long_run():
    """Their elements have several rows, and a coast flank follows."""
    table = sliced_database((-60e-6, 0.0, 60e-6), (-1e-4, 0.0, 1e-4), positions=12).force_table()
    effects = {"dynamic_misalignment": "on", "moving_application_point": "on", "tilt": "on", "backlash": "on"}
    scene = gear_pair_scene(table, speed=TimeLaw.constant(3000.0 * RPM), duration=0.1, effects=effects)
    scene = with_gear(with_gear(scene, 0, position=0.06), 1, position=0.06)
    scene = with_mesh(scene, coast=CoastFlank(40e-6))
    rate = 64 * 20 * 3000 / 60
    outputs = Outputs(rate, energy_audit=False)
    run = simulate(replace(scene, outputs=outputs, integration=Integration(tolerance=1e-10)))
    error = run.dynamic_transmission_error[0, -65:-1]
    found = steady_states(assemble(scene), [3000.0 * RPM])
    assert found.rms_error[0, 0] == pytest.approx(error.std(), rel=2e-3)
    assert found.mean_error[0, 0] == pytest.approx(error.mean(), rel=1e-4)
    assert found.largest_force[0, 0] == pytest.approx(run.mesh_force[0, -65:-1].max(), rel=2e-3)
    assert found.coasting[0, 0] == 0.0


def test_motions_of_a_sweep_differ_by_their_step_errors_from_those_of_finer_steps():
    """Each has the steps of its own speed, and its error is stated by them."""
    speeds = np.array([300.0, 900.0, 2700.0]) * RPM
    problem = periodic_problem(system := assemble(gear_pair_scene()), speeds[0])
    swept, fine = sweep(problem, speeds, 8), [find_orbit(problem, speed) for speed in speeds]
    steps = [problem.at(speed).grid.level.size for speed in speeds]
    assert steps == [periodic_problem(system, speed).grid.level.size for speed in speeds]
    assert steps[0] == problem.grid.level.size > steps[1] > steps[2]
    for orbit, other in zip(swept, fine, strict=True):
        apart = np.max(np.abs(orbit.state - other.state))
        assert apart <= 1.5 * orbit.step_error + 1e-8 * problem.size
    moved = np.max(np.abs(swept[2].state - fine[2].state))
    assert moved == pytest.approx(swept[2].step_error, rel=0.2, abs=0.0)


def test_a_motion_that_is_not_found_has_a_status_and_no_figures(monkeypatch):
    monkeypatch.setitem(find_orbit.__globals__, "ITERATION_LIMIT", 0)
    found = steady_states(assemble(gear_pair_scene()), [900.0 * RPM], periods=0)
    assert found.status[0] == OrbitStatus.ITERATION_LIMIT
    assert found.residual[0] > 0.0
    assert np.isnan(found.rms_error[0, 0])


def test_alone_a_sweep_is_not_timed_for_others(monkeypatch):
    monkeypatch.setitem(steady_states.__globals__, "_settling_seconds", None)  # were it called: TypeError
    speeds = np.array([300.0, 330.0]) * RPM
    found = steady_states(assemble(gear_pair_scene()), speeds, periods=0, branch=False)
    assert np.all(found.status == OrbitStatus.CONVERGED)


def test_progress_runs_over_all_curves():
    seen: list[tuple[str, float]] = []
    steady_states(
        assemble(gear_pair_scene(spring_table(4e8, 1e-7))),
        np.array([300.0, 330.0]) * RPM,
        periods=1,
        progress=lambda *step: seen.append(step),
    )
    for curve in ("up", "down", "branch"):
        part = [fraction for name, fraction in seen if name == curve]
        assert part == sorted(part) and part[-1] == 1.0


def test_progress_of_a_sweep_is_that_of_its_steps():
    speeds, seen = np.array([300.0, 900.0, 2700.0]) * RPM, []
    problem = periodic_problem(assemble(gear_pair_scene()), speeds[0])
    sweep(problem, speeds, 0, seen.append)
    steps = np.cumsum([problem.at(speed).grid.level.size for speed in speeds])
    np.testing.assert_allclose(seen, steps / steps[-1], rtol=1e-12)
    assert seen[0] > 0.6  # the slowest motion takes most of the time


def test_a_file_gives_back_every_bit(light, tmp_path):
    light.to_netcdf(tmp_path / "steady.nc")
    with h5netcdf.File(tmp_path / "steady.nc") as file:
        fields = json.loads(file.attrs["documents"])["fields"]
    assert fields["facts"]["branch"] == "COMPLETED" and "metadata" not in fields
    again = SteadyStates.from_netcdf(tmp_path / "steady.nc")
    for name, value in vars(light).items():
        if isinstance(value, np.ndarray):
            assert np.array_equal(getattr(again, name), value, equal_nan=True), name
        else:
            assert getattr(again, name) == value, name
    with pytest.raises(ResultError, match="no such file"):
        SteadyStates.from_netcdf(tmp_path / "none.nc")


@pytest.mark.parametrize(
    ("speed", "further", "field"),
    [
        ([], {}, "speed"),
        ([0.0], {}, "speed[0]"),
        ([2.0, 1.0], {}, "speed[1]"),
        ([90.0], {"repeat": 0}, "repeat"),
        ([90.0], {"periods": -1}, "periods"),
    ],
)
def test_what_cannot_be_used_is_named(speed, further, field):
    with pytest.raises(InputError) as caught:
        steady_states(assemble(gear_pair_scene()), speed, **further)
    assert caught.value.field == field
