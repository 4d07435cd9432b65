"""Periodic motions of a gear pair: against the linear response and a long run, their errors, bad input."""

from dataclasses import replace

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import RPM, gear_pair_scene, repeated, spring_table, square_wave_table, with_bushings
from planetary_scenes import MESH_STIFFNESS, driven_scene, planetary_scene, published_set

from dynamics import Integration, Outputs, RollingContact, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError
from dynamics.linearize import common_period, harmonic_response
from dynamics.periodic import (
    BranchStatus,
    OrbitStatus,
    PeriodMap,
    find_orbit,
    follow_branch,
    motion,
    periodic_problem,
    spectrum,
)
from dynamics.periodic.period_map import PeriodGrid

SPEED = 900.0 * RPM


def on_rolling_bearings(scene):
    """Four roller bearings with clearance instead of springs across the axis."""
    scene = with_bushings(scene, radial_stiffness=0.0)
    contacts = tuple(
        RollingContact(bushing.name, stiffness=5e8, clearance=2e-5, exponent=10.0 / 9.0)
        for bushing in scene.bushings
    )
    return replace(scene, rolling_contacts=contacts)


@pytest.mark.parametrize("bearings", ["springs", "rolling", "springs under flexible shafts"])
def test_a_small_ripple_gives_the_harmonic_response(bearings):
    """The same phases, through all bearings."""
    scene = gear_pair_scene(spring_table(4e8, 1e-8 if bearings == "rolling" else 1e-7))
    if bearings.endswith("flexible shafts"):
        scene = flexible_pair(gear=0.07, table=spring_table(4e8, 1e-7))
        drive = replace(scene.drives[0], position=0.07)  # a shaft that winds up moves the position a little
        scene = replace(scene, drives=(drive,))
    system = assemble(on_rolling_bearings(scene) if bearings == "rolling" else scene)
    problem = periodic_problem(system, SPEED)
    found = motion(problem, find_orbit(problem, SPEED))
    linear = harmonic_response(system, [SPEED], 1)
    for mine, theirs in (
        (found.dynamic_transmission_error, linear.dynamic_transmission_error[:, 0, 0]),
        (found.bearing_force, linear.bearing_force[:, :, 0, 0]),
        (found.mesh_force, linear.mesh_force[:, 0, 0]),
    ):
        line = spectrum(mine)[..., np.flatnonzero(found.order == 1.0)[0]]
        np.testing.assert_allclose(line, theirs, rtol=0.0, atol=2e-5 * np.max(np.abs(theirs)))


@pytest.mark.law
def test_a_long_run_settles_on_the_orbit():
    """On a table with a handover; samples of the run's last pitch against the orbit's."""
    scene = gear_pair_scene(speed=TimeLaw.constant(SPEED))
    problem = periodic_problem(assemble(scene), SPEED)
    orbit = find_orbit(problem, SPEED)
    found = motion(problem, orbit)
    rate = found.time.size / orbit.duration
    pitches = 120
    fine = Integration(tolerance=1e-11)
    run = simulate(
        replace(
            scene,
            duration=pitches * orbit.duration,
            outputs=Outputs(rate, anti_alias=False),
            integration=fine,
        )
    )
    last = run.dynamic_transmission_error[0, -found.time.size - 1 : -1]
    difference = np.sqrt(np.mean((last - found.dynamic_transmission_error[0]) ** 2))
    assert difference < 1e-11 + orbit.step_error
    assert orbit.step_error < 1e-10


def test_the_step_error_is_what_finer_steps_change():
    system = assemble(gear_pair_scene(square_wave_table()))
    coarse, fine = (
        find_orbit(periodic_problem(system, SPEED, steps_per_cycle=steps), SPEED) for steps in (12, 96)
    )
    moved = np.max(np.abs(coarse.state - fine.state))
    assert moved == pytest.approx(coarse.step_error, rel=0.2)


def test_steps_end_on_knots_and_halve():
    table = square_wave_table(8)
    table = replace(table, position=table.position + 0.03 * np.sin(np.arange(8)) ** 2)
    system = assemble(gear_pair_scene(repeated(table, 2)))
    grid = PeriodGrid.of(system, common_period(system), 1.0 / 40.0)
    knots = np.concatenate([table.position, table.position + 1.0]) / 2.0
    np.testing.assert_allclose(np.min(np.abs(grid.phase[:, None] - knots), axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.diff(grid.phase), grid.size[grid.level], atol=1e-11)
    assert np.max(grid.size) <= 1.0 / 40.0
    assert grid.halved.phase.size == 2 * grid.phase.size - 1
    fine = grid.halved
    np.testing.assert_allclose(np.diff(fine.phase), fine.size[fine.level], atol=1e-11)


def test_steps_end_on_no_knots_but_those_of_each_flanks_own_table():
    sun, ring = square_wave_table(8), spring_table(MESH_STIFFNESS, 1e-6, positions=40)
    uneven = sun.position + 0.03 * np.sin(np.arange(8)) ** 2
    tables = {"sun_table": replace(sun, position=uneven), "ring_table": ring}
    system = assemble(driven_scene(published_set(3, teeth=(28, 35, 98), ring_phase=0.013, **tables)))
    grid = PeriodGrid.of(system, common_period(system), 1.0)
    offset, knots = system.arrays.reference.offset, (uneven, ring.position)
    phases = np.concatenate([[0.0], *((knots[k % 2] - offset[k]) % 1.0 for k in range(6))])
    expected = np.unique(np.round(phases % 1.0, 11) % 1.0)
    np.testing.assert_allclose(grid.phase[:-1], expected, atol=2e-11)


def test_a_planetary_set_has_a_common_period():
    """All six meshes are in phase again when the ring's and the sun's pitch counts are whole."""
    table = spring_table(MESH_STIFFNESS, 1e-6)
    system = assemble(driven_scene(published_set(3, teeth=(28, 35, 98), sun_table=table, ring_table=table)))
    assert set(common_period(system).pitches) == {1}
    problem = periodic_problem(system, 150.0)
    orbit = find_orbit(problem, 150.0)
    assert orbit.status.usable
    assert orbit.residual < 1e-9 * problem.size
    assert orbit.multipliers.size == 2 * len(system.freedoms.name)
    found = motion(problem, orbit)
    turned = np.roll(found.mesh_force[0], -found.time.size // 3)
    others = [np.max(np.abs(turned - found.mesh_force[k])) for k in (2, 4)]
    assert min(others) < 1e-2 * np.ptp(found.mesh_force[0])  # the next planet a third of a pitch later


def test_twice_the_period_repeats_the_motion():
    system = assemble(gear_pair_scene(square_wave_table()))
    one, two = (find_orbit(periodic_problem(system, SPEED, repeat=k), SPEED) for k in (1, 2))
    np.testing.assert_allclose(two.state, one.state, atol=1e-14)
    np.testing.assert_allclose(np.abs(two.multipliers), np.abs(one.multipliers) ** 2, rtol=1e-4, atol=1e-8)


def test_searches_that_fail_say_so():
    system = assemble(gear_pair_scene(square_wave_table()))
    problem = periodic_problem(system, SPEED)
    lost = find_orbit(problem, SPEED, problem.rest * np.nan)
    assert lost.status is OrbitStatus.NOT_FINITE
    assert not lost.status.usable
    branch = follow_branch(problem, SPEED, 1.01 * SPEED, guess=problem.rest * np.nan)
    assert branch.status is BranchStatus.NO_START
    short = follow_branch(problem, SPEED, 2.0 * SPEED, points=2)
    assert short.status is BranchStatus.POINT_LIMIT
    assert len(short.orbits) == 2


def test_bad_input_is_named():
    with pytest.raises(InputError, match="free_rotations"):
        periodic_problem(assemble(planetary_scene(published_set(3))), 100.0)
    problem = periodic_problem(assemble(gear_pair_scene()), SPEED)
    with pytest.raises(InputError, match="speed"):
        find_orbit(problem, -SPEED)
    with pytest.raises(InputError, match="last"):
        follow_branch(problem, SPEED, SPEED)
    with pytest.raises(InputError, match="repeat"):
        periodic_problem(assemble(gear_pair_scene()), SPEED, repeat=0)


def test_the_monodromy_is_the_map_s_derivative():
    problem = periodic_problem(assemble(gear_pair_scene(square_wave_table())), SPEED)
    over_period, y = PeriodMap(problem, SPEED), find_orbit(problem, SPEED).state
    direction = np.random.default_rng(1).standard_normal(y.size) * 1e-9
    moved = over_period(y + direction) - over_period(y)
    np.testing.assert_allclose(over_period.monodromy(y) @ direction, moved, atol=2e-3 * np.max(np.abs(moved)))
