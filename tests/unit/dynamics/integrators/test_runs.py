"""Whole runs: their status, what they cost, knots of laws and pitches that hunt."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, gear_pair_scene, repeated, spring_table, square_wave_table, with_mesh

from dynamics import CoastFlank, Integration, Outputs, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import SolveError
from dynamics.integrators import integrate, static_equilibrium
from dynamics.integrators.advance import advance
from dynamics.integrators.march import ending, start_march
from dynamics.integrators.state_sink import MemorySink
from dynamics.integrators.workspace import Count
from dynamics.kernels.by_address import by_address
from dynamics.loads import AngleLaw
from dynamics.meshes.technique import PlainTable
from dynamics.types import RunStatus
from model_studies.stage_clock import TimeTaken

# Outcomes of runs: complete, or ended early with a status and what was computed.


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
    def stop(fraction, text):
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


def test_a_march_goes_on_as_if_its_end_had_not_been_taken_before():
    system = assemble(gear_pair_scene(speed=TimeLaw.constant(90.0), duration=0.02))
    start = static_equilibrium(system)

    def run(stops):
        march = start_march(system, start, Integration(tolerance=1e-9))
        sink, ends = MemorySink(march.samples, march.widths), []
        for stop in stops:
            advance(*march.compiled, stop, by_address(sink.states(0, march.samples)))
            ends.append(ending(march, sink, RunStatus.COMPLETED, TimeTaken()))
        return *(vars(end.figures) for end in ends), sink.all._asdict()

    (short, _), (whole, states), (early, late, cut) = run([1e-4]), run([0.02]), run([1e-4, 0.02])
    for alone, taken in ((short, early), (whole, late), (states, cut)):
        for name, values in alone.items():
            np.testing.assert_array_equal(taken[name], values, err_msg=name)
    assert np.max(early["bearing_peak"]) < np.max(late["bearing_peak"])


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


# What a run costs, in steps and evaluations: in proportion to its duration, nothing for what is off.


SPATIAL_SCENE = replace(gear_pair_scene(duration=0.1), effects={"lateral": "on", "tilt": "on"})


def cost(scene, method="implicit"):
    """Steps tried, and evaluations of the force laws' stages."""
    found = simulate(replace(scene, integration=Integration(method=method))).statistics
    tried = found.accepted + found.rejected
    return np.array([tried, tried * max(found.newton_mean, 1.0)])


def with_axes(table):
    knots = np.array([-1e-5, 0.0, 1e-5])
    names = ("deflection", "deflection_slope", "stiffness", "stiffness_slope")
    shape = (3, 3, *table.deflection.shape[2:])
    fields = {name: np.broadcast_to(getattr(table, name), shape).copy() for name in names}
    levers = dict.fromkeys(("load_arm", "sliding_share", "sliding_lever"), np.full(shape, 1e-3))
    return PlainTable(table.position, table.level, knots, knots, **fields, **levers)


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_steps_and_evaluations_grow_in_proportion_to_the_duration(method):
    short, middle, long = (
        cost(replace(SPATIAL_SCENE, duration=seconds), method) for seconds in (0.1, 0.2, 0.4)
    )
    assert np.all(short > 500)
    np.testing.assert_allclose(long - middle, 2.0 * (middle - short), rtol=0.02)


AXES = ("dynamic_misalignment", "dynamic_center_distance", "moving_application_point")


@pytest.mark.parametrize(
    ("able", "effects"),
    [
        ({"coast": CoastFlank(50e-6)}, ("backlash",)),
        ({"friction": 0.05, "table": with_axes(square_wave_table())}, ("friction", *AXES)),
        ({"table": with_axes(square_wave_table())}, AXES),
    ],
    ids=["backlash", "friction", "axes"],
)
def test_an_effect_that_is_off_takes_no_step_and_no_evaluation(able, effects):
    off = replace(
        with_mesh(SPATIAL_SCENE, **able), effects={**SPATIAL_SCENE.effects, **dict.fromkeys(effects, "off")}
    )
    with_it, without = simulate(off), simulate(SPATIAL_SCENE)
    assert with_it.statistics == without.statistics
    np.testing.assert_array_equal(with_it.mesh_force, without.mesh_force)
    assert len(assemble(off).elements) == len(assemble(SPATIAL_SCENE).elements) == 1


# Steps end where the acceleration of an imposed motion jumps: no impulse is lost, none is made up.


STIFFNESS = 4e8
INERTIA = 1.1344291072112745e-3
NATURAL = np.sqrt(STIFFNESS * BASE_RADIUS**2 / INERTIA)
KNOTS, SPEEDS = (0.0, 0.0101, 0.0202, 0.0304), (10.0, 30.0, 20.0, 50.0)


def torsional(speed, **changes):
    """The driven shaft alone on a mesh of constant stiffness, undamped."""
    scene = gear_pair_scene(spring_table(STIFFNESS), speed=speed, duration=0.04)
    outputs = Outputs(20e3, anti_alias=False)
    return with_mesh(replace(scene, bushings=(), effects={}, outputs=outputs, **changes), damping=0.0)


def ringing(time):
    """Closed form: the inertial force INERTIA a/r on the mesh steps at every knot, and each step rings on."""
    accelerations = [*(np.diff(SPEEDS) / np.diff(KNOTS)), 0.0]
    error = (100.0 + INERTIA * accelerations[0]) / BASE_RADIUS / STIFFNESS * np.ones_like(time)
    for knot, jump in zip(KNOTS[1:], np.diff(accelerations), strict=True):
        since = np.maximum(time - knot, 0.0)
        error += INERTIA * jump / BASE_RADIUS / STIFFNESS * (1.0 - np.cos(NATURAL * since))
    return error


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_every_knot_of_a_speed_law_rings_as_the_closed_form(method):
    scene = torsional(TimeLaw(KNOTS, SPEEDS), integration=Integration(method, tolerance=1e-11))
    result = simulate(scene)
    exact = ringing(result.time)
    assert np.ptp(exact) > 3e-7
    assert np.max(np.abs(result.dynamic_transmission_error[0] - exact)) < 2e-10
    assert abs(result.energy.residual) < 1e-9 * result.energy.kinetic


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_a_jump_costs_no_energy_at_any_tolerance(method):
    """A wrong speed after a jump shows in the balance, though the displacements are right."""
    kicked = torsional(TimeLaw(KNOTS, SPEEDS), integration=Integration(method, tolerance=1e-8))
    energy = simulate(kicked).energy
    assert abs(energy.residual) < 1e-6 * energy.kinetic


def test_a_run_ends_at_a_knot_at_its_end():
    scene = torsional(TimeLaw.ramp(0.0, 100.0, 0.04))
    system = assemble(scene)
    run = integrate(system, static_equilibrium(system), scene.integration)
    assert run.end == 0.04
    assert run.time.size == 801


def steps(speed):
    system = assemble(torsional(speed))
    run = integrate(system, static_equilibrium(system), system.scene.integration)
    return int(run.count[Count.ACCEPTED])


def test_smooth_laws_are_not_stopped_at():
    """A spline through 400 angles has no jump of the acceleration: it runs in as many steps as one of 40."""

    def spline(points):
        time = np.linspace(0.0, 0.04, points)
        return AngleLaw(tuple(time), tuple(30.0 * time + 100.0 * time**2))

    assert steps(spline(400)) < 1.05 * steps(spline(40))


# Runs on tables of several base pitches.


TABLE = square_wave_table()
SCENE_OF_A_TABLE = gear_pair_scene(TABLE, duration=0.03)


def one_tooth_behind(period, error):
    """The table of one pitch written out, one of them `error` m further from contact."""
    table = repeated(TABLE, period)
    third = np.floor(table.position) == 2
    bump = np.where(third, np.sin(np.pi * (table.position - 2.0)) ** 2, 0.0)
    slope = np.where(third, np.pi * np.sin(2 * np.pi * (table.position - 2.0)), 0.0)
    return replace(
        table,
        deflection=table.deflection + error * bump[:, None],
        deflection_slope=table.deflection_slope + error * slope[:, None],
    )


def test_equal_pitches_written_out_run_as_one():
    one, many = simulate(SCENE_OF_A_TABLE), simulate(with_mesh(SCENE_OF_A_TABLE, table=repeated(TABLE, 20)))
    assert many.position.max() > 8.9
    np.testing.assert_allclose(many.position % 1.0, one.position, atol=1e-12)
    for name in ("mesh_force", "dynamic_transmission_error", "static_transmission_error"):
        mine, theirs = getattr(many, name), getattr(one, name)
        np.testing.assert_allclose(mine, theirs, rtol=1e-7, atol=1e-9 * np.abs(theirs).max())


def test_an_error_of_one_tooth_returns_with_its_period():
    result = simulate(with_mesh(SCENE_OF_A_TABLE, table=one_tooth_behind(5, 3e-6)))
    smooth = simulate(SCENE_OF_A_TABLE)
    plain = np.interp(result.time, smooth.time, smooth.static_transmission_error[0])
    pitch = np.floor(result.position[0]) % 5
    raised = np.abs(result.static_transmission_error[0] - plain)
    assert raised[pitch == 2].max() > 2.5e-6
    assert raised[pitch != 2].max() < 0.1e-6
    assert result.case["meshes"][0]["table"]["period"] == 5
