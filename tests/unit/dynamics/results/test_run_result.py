"""Series of a result belong together; files give them back bit by bit."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from geared_scenes import BASE_RADIUS, RPM, gear_pair_scene, with_gear

from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError, ResultError
from dynamics.loads import TimeLaw
from dynamics.results import RunResult
from dynamics.scene import Integration, Outputs
from dynamics.simulation import simulate


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


def test_other_files_are_refused(tmp_path: Path):
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
