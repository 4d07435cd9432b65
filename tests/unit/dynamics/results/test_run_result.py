"""Results of runs: their quantities, orders that are fitted, figures of contact."""

from dataclasses import fields, replace

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, with_gear
from planetary_scenes import planetary_scene, published_set

from bounds import engineering
from bounds.brief import MAX_LINES, WIDTH
from dynamics import Integration, Outputs, RunResult, TimeLaw, simulate
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError, ResultError
from dynamics.results.mesh_figures import ContactState, contact_shares, dynamic_factor, planet_load_sharing
from dynamics.results.order_fit import order_amplitudes, orders_seen, unwrapped

# Series of a result belong together; files give them back bit by bit.


@pytest.fixture(scope="module")
def result():
    """A run-up with all outputs on."""
    scene = gear_pair_scene(speed=TimeLaw.ramp(0.0, 955.0 * RPM, 0.2), duration=0.2)
    return simulate(replace(scene, outputs=Outputs(displacements=True)))


def test_bearings_carry_the_mesh_and_what_accelerates_the_shaft():
    """Newton's second law for each shaft, from displacements alone."""
    rate, mass = 400e3, 1.9729201864543904 + 0.7398450699203964
    scene = replace(gear_pair_scene(duration=0.02), integration=Integration(tolerance=1e-11))
    result = simulate(replace(scene, outputs=Outputs(rate, displacements=True)))
    line = np.array(result.case["meshes"][0]["line_of_action"])
    for shaft, sign in (("input", -1.0), ("output", 1.0)):
        rows = [k for k, name in enumerate(result.bearing) if name.startswith(shaft)]
        ground = result.bearing_force[rows].sum(axis=0)
        for axis, direction in enumerate("xy"):
            velocity = result.velocity[result.freedom.index(f"{shaft}.{direction}")]
            acceleration = (velocity[2:] - velocity[:-2]) * rate / 2.0
            balance = sign * line[axis] * result.mesh_force[0, 1:-1] - mass * acceleration
            assert np.ptp(mass * acceleration) > 100.0
            assert np.abs(ground[axis, 1:-1] - balance).max() < 0.5  # N of 2660
        np.testing.assert_array_equal(ground[2], 0.0)


def test_the_text_of_a_run_says_its_parts_and_forces_in_a_dozen_lines(result):
    lines = repr(result).split("\n")
    assert lines[0] == f"RunResult, 0.2 s in {result.time.size} samples, completed"
    assert len(lines) <= MAX_LINES and max(map(len, lines)) <= WIDTH
    assert "2 shafts, 1 mesh, 4 bearings, 1 drive" in lines[1]
    (peaks,) = result.receipt["peaks"]["mesh_force"].values()  # what a terminal prints
    assert f" to {engineering(peaks['peak'], 4)} N" in lines[2]


def test_two_equal_bushings_share_equally(result):
    np.testing.assert_array_equal(result.bearing_force[0], result.bearing_force[1])


def test_drive_torque_is_mesh_force_times_base_radius_and_inertia(result):
    inertia = 1.1344291072112745e-3
    expected = BASE_RADIUS * result.mesh_force[0] + inertia * 955.0 * RPM / 0.2
    np.testing.assert_allclose(result.drive_torque[0, :-1], expected[:-1], rtol=1e-9)


def test_speed_position_and_frequency_belong_together(result):
    assert result.shaft == ("input", "output")
    np.testing.assert_allclose(result.speed[0], 955.0 * RPM * result.time / 0.2, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(result.mesh_frequency[0], 20.0 * result.speed[0] / (2 * np.pi), rtol=1e-12)
    turned = 20.0 * 955.0 * RPM * result.time**2 / 0.4 / (2 * np.pi)
    difference = result.position[0] - turned
    np.testing.assert_allclose(difference - np.round(difference), 0.0, atol=1e-12)
    # the driven gear follows with the opposite sense, up to the rate of its transmission error
    lag = np.gradient(result.dynamic_transmission_error[0], result.time)
    assert np.abs(result.speed.sum(axis=0)).max() * BASE_RADIUS < 3.0 * np.abs(lag).max()


def test_the_run_starts_in_equilibrium_with_load_and_inertia_and_stays_around_the_static_error(result):
    dte, ste = result.dynamic_transmission_error[0], result.static_transmission_error[0]
    inertial = 1.1344291072112745e-3 * 955.0 * RPM / 0.2 / BASE_RADIUS
    assert result.mesh_force[0, 0] == pytest.approx(100.0 / BASE_RADIUS + inertial, rel=1e-8)
    np.testing.assert_allclose(dte[:20], dte[0], rtol=1e-6)  # no transient at the start
    more = (1.0 + inertial * BASE_RADIUS / 100.0) ** 0.96  # the table's deflection grows with force^0.96
    assert dte.mean() == pytest.approx(ste.mean() * more, rel=1e-3)


def test_the_case_spells_out_every_damping(result):
    assert all(bushing["radial_damping"] > 0.0 for bushing in result.case["bushings"])
    assert result.case["meshes"][0]["damping"] > 0.0
    assert result.effect_ledger["left_out"]
    assert 0.0 < result.receipt["error"]["time_step"]["rms"] < 1e-9


@pytest.mark.law
def test_files_give_back_every_bit(result, tmp_path):
    path = tmp_path / "run.nc"
    result.to_netcdf(path)
    back = RunResult.from_netcdf(path)
    for entry in fields(RunResult):
        before, after = getattr(result, entry.name), getattr(back, entry.name)
        if isinstance(before, np.ndarray):
            assert before.tobytes() == after.tobytes()
            assert before.shape == after.shape
        else:
            assert before == after
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


def test_empty_series_come_back_empty(tmp_path):
    small = simulate(replace(gear_pair_scene(duration=0.001), outputs=Outputs(bearing_forces=False)))
    small.to_netcdf(tmp_path / "run.nc")
    back = RunResult.from_netcdf(tmp_path / "run.nc")
    assert back.bearing_force.shape == small.bearing_force.shape == (0, 3, small.time.size)
    assert back.displacement.shape == small.displacement.shape


def test_what_no_output_has_takes_nothing_and_changes_nothing_else():
    scene = gear_pair_scene(duration=0.02)
    whole, part = (
        simulate(replace(scene, outputs=Outputs(bearing_forces=stored))) for stored in (True, False)
    )
    assert part.receipt["peaks"]["bearing_force"] == {}
    assert part.receipt["peaks"]["mesh_force"] == whole.receipt["peaks"]["mesh_force"]
    np.testing.assert_array_equal(part.mesh_force, whole.mesh_force)


def test_other_files_are_refused(tmp_path):
    import xarray  # noqa: PLC0415

    (tmp_path / "text.nc").write_text("no netCDF")
    xarray.Dataset(attrs={"schema": "other"}).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    for name in ("text.nc", "other.nc", "missing.nc"):
        with pytest.raises(ResultError, match=name):
            RunResult.from_netcdf(tmp_path / name)


def test_csv_has_a_column_per_series_with_units(result, tmp_path):
    result.to_csv(tmp_path / "run.csv")
    with (tmp_path / "run.csv").open() as file:
        header = file.readline().strip().split(",")
    table = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    assert table.shape == (result.time.size, len(header))
    column = header.index("bearing_force[output.right y] (N)")
    np.testing.assert_allclose(table[:, column], result.bearing_force[3, 1], rtol=1e-8, atol=1e-9)


def test_windows_outside_the_run_are_refused(result):
    cut = result.time[result.window(0.05, 0.1)]
    assert cut[0] == pytest.approx(0.05)
    assert cut[-1] == pytest.approx(0.1)
    with pytest.raises(InputError, match="window"):
        result.window(0.3, 0.4)


def test_mirrored_hand_mirrors_the_axial_forces():
    def run(helix):
        scene = gear_pair_scene(duration=0.01)
        return simulate(with_gear(with_gear(scene, 0, base_helix_angle=helix), 1, base_helix_angle=-helix))

    right, left = run(0.25), run(-0.25)
    np.testing.assert_allclose(right.bearing_force[:, 2], -left.bearing_force[:, 2], rtol=1e-6, atol=1e-3)
    np.testing.assert_allclose(right.mesh_force, left.mesh_force, rtol=1e-9)
    assert right.bearing_force[0, 2].mean() > 100.0  # the driver's right hand pushes it along +z


def test_accelerations_of_a_scene_without_bearings():
    """The one freedom of the driven gear obeys J a = r F - T, its kinematic motion having none."""
    scene = replace(
        gear_pair_scene(duration=0.005, bushings=()), outputs=Outputs(displacements=True, accelerations=True)
    )
    result = simulate(scene)
    assert result.bearing_acceleration.shape == (0, 3, result.time.size)
    polar = assemble(scene).arrays.mass[0, 0]
    expected = (BASE_RADIUS * result.mesh_force[0] - 100.0) / polar
    assert np.ptp(expected) > 100.0
    np.testing.assert_allclose(np.abs(result.acceleration[0]), np.abs(expected), rtol=1e-6, atol=1e-3)


# Orders of a stretch of a run by least squares: exact on what is periodic, whatever the speed does.


TIME = np.linspace(0.0, 1.0, 700)
POSITION = 0.3 + 5.0 * TIME + 9.7 * TIME**2  # a ramp over a broken number of pitches


def test_amplitudes_of_a_ramp_over_a_broken_number_of_pitches_are_exact():
    angle = 2.0 * np.pi * POSITION
    values = 7.0 - 2.0 * TIME + 3.0 * np.cos(angle + 0.4) + 0.2 * np.sin(3 * angle - 1.0)
    found = order_amplitudes(POSITION, np.stack([values, 2.0 * values]), 4)
    np.testing.assert_allclose(found, np.outer([1.0, 2.0], [3.0, 0.0, 0.2, 0.0]), atol=1e-12)


@pytest.mark.parametrize("period", [1, 7])
def test_wrapped_positions_run_on(period):
    np.testing.assert_allclose(np.diff(unwrapped(POSITION % period)), np.diff(POSITION), atol=1e-12)
    backwards = unwrapped(-POSITION % period)
    np.testing.assert_allclose(np.diff(backwards), -np.diff(POSITION), atol=1e-12)


def test_orders_with_fewer_than_four_samples_a_period_are_left_out():
    assert orders_seen(np.arange(50) / 8.1, 5) == 2
    assert orders_seen(np.arange(50) / 3.9, 5) == 0
    assert orders_seen(np.arange(50) / 100.0, 5) == 5
    assert orders_seen(np.zeros(50), 5) == 0


# Contact state, dynamic factor, load sharing and accelerations of runs.


def test_the_dynamic_factor_is_one_in_the_quasi_static_limit():
    slow = simulate(gear_pair_scene(speed=TimeLaw.constant(10.0 * RPM), duration=1.0))
    quiet = dynamic_factor(slow, pitches=1)
    np.testing.assert_allclose(quiet.mean, 1.0, rtol=2e-3)
    assert 1.0 < quiet.largest.max() < 1.02
    loud = dynamic_factor(simulate(gear_pair_scene(duration=0.1)), pitches=1)
    assert loud.largest.max() > 1.1
    assert np.all(loud.minimum <= loud.mean)
    assert np.all(loud.mean <= loud.largest)


def test_blocks_of_the_dynamic_factor_cover_whole_pitches():
    run = simulate(gear_pair_scene(duration=0.1))
    found = dynamic_factor(run, pitches=4)
    assert found.time.size == 7  # 30 pitches
    np.testing.assert_allclose(np.diff(found.time), 4.0 / 300.0, rtol=0.01)
    np.testing.assert_allclose(found.mesh_frequency, 300.0)
    with pytest.raises(InputError, match="pitches"):
        dynamic_factor(run, pitches=31)


@pytest.mark.parametrize("planets", [3, 5])
def test_load_sharing_sums_to_the_number_of_planets(planets):
    errors = tuple((0.0, 5e-5 if index == 0 else 0.0) for index in range(planets))
    scene = planetary_scene(published_set(planets, pin_errors=errors), duration=0.01)
    found = planet_load_sharing(simulate(scene))
    assert [sharing.central for sharing in found] == ["sun", "ring"]
    for sharing in found:
        assert len(sharing.mesh) == planets
        np.testing.assert_allclose(sharing.ratio.sum(axis=0), planets, rtol=1e-12)
        assert sharing.mean.sum() == pytest.approx(planets, rel=1e-12)
        assert sharing.mean[0] > 1.05 or sharing.mean[0] < 0.95
        assert sharing.mesh_load_factor == sharing.mean.max() > 1.0


def test_planets_without_errors_share_equally_and_a_pair_has_none():
    (sun, _) = planet_load_sharing(simulate(planetary_scene(published_set(3), duration=0.005)))
    np.testing.assert_allclose(sun.ratio, 1.0, atol=1e-6)
    assert planet_load_sharing(simulate(gear_pair_scene(duration=0.001))) == ()


def test_contact_states_tell_the_flanks_that_carry():
    run = simulate(gear_pair_scene(duration=0.002))
    contact = np.zeros((1, 41))
    contact[0, 10:20] += 1.0
    contact[0, 15:30] += 2.0
    state = replace(run, contact=contact).contact[0]
    assert [int(state[k]) for k in (0, 12, 17, 25)] == [
        ContactState.OFF,
        ContactState.DRIVING,
        ContactState.BOTH,
        ContactState.COAST,
    ]
    (shares,) = contact_shares(replace(run, contact=contact))
    assert shares == pytest.approx({"off": 21 / 41, "driving": 5 / 41, "coast": 10 / 41, "both": 5 / 41})


@pytest.fixture(scope="module")
def moved():
    """A run with everything stored, at a rate at which differences show accelerations."""
    scene = replace(gear_pair_scene(duration=0.02), integration=Integration(tolerance=1e-11))
    return simulate(replace(scene, outputs=Outputs(400e3, displacements=True, accelerations=True)))


def test_accelerations_are_the_rates_of_velocities(moved):
    rates = (moved.velocity[:, 2:] - moved.velocity[:, :-2]) * 400e3 / 2.0
    for row, rate in zip(moved.acceleration[:, 1:-1], rates, strict=True):
        assert np.ptp(row) > 1.0
        np.testing.assert_allclose(row, rate, atol=2e-3 * np.ptp(row))


def test_bearing_seats_move_with_their_shaft(moved):
    row = moved.acceleration[moved.freedom.index("input.x")]
    for bearing, name in enumerate(moved.bearing):
        if name.startswith("input"):
            np.testing.assert_allclose(moved.bearing_acceleration[bearing, 0], row, rtol=1e-12)


def test_accelerations_are_off_unless_requested_and_change_nothing(moved, tmp_path):
    scene = replace(gear_pair_scene(duration=0.02), integration=Integration(tolerance=1e-11))
    plain = simulate(replace(scene, outputs=Outputs(400e3, displacements=True)))
    assert plain.acceleration.shape == (0, 8001)
    assert plain.bearing_acceleration.shape == (0, 3, 8001)
    assert plain.displacement.tobytes() == moved.displacement.tobytes()
    moved.to_netcdf(tmp_path / "run.nc")
    back = RunResult.from_netcdf(tmp_path / "run.nc")
    assert back.bearing_acceleration.tobytes() == moved.bearing_acceleration.tobytes()


def test_a_run_knows_the_modes_of_its_scene(moved):
    assert moved.modes["frequency"] == sorted(moved.modes["frequency"])
    assert len(moved.modes["frequency"]) == len(moved.freedom)
    assert set(moved.modes["freedom"]) <= set(moved.freedom)
    assert max(moved.modes["damping_ratio"]) > 0.01
