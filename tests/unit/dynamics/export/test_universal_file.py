"""Universal files, read back by pyuff: units, positions, directions, values."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene

from dynamics import Outputs, TimeLaw, simulate
from dynamics.errors import InputError
from dynamics.export import write_universal_file
from dynamics.orders import order_waterfall, window_spectrum

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import pyuff


@pytest.fixture(scope="module")
def run():
    scene = gear_pair_scene(speed=TimeLaw.ramp(0.0, 955.0 * RPM, 0.2), duration=0.2)
    return simulate(replace(scene, outputs=Outputs(accelerations=True)))


def read(run, path, *arguments):
    """Write, and read with pyuff: units, nodes, functions by node and direction and ordinate."""
    count = write_universal_file(run, path, *arguments)
    units, nodes, *functions = pyuff.UFF(str(path)).read_sets()
    assert len(functions) == count
    found = {(f["rsp_node"], f["rsp_dir"], f["ordinate_spec_data_type"]): f for f in functions}
    assert len(found) == count
    return units, nodes, found


def test_time_series_come_back_with_units_positions_and_directions(run, tmp_path):
    units, _, functions = read(run, tmp_path / "run.unv")
    assert (units["units_code"], units["length"], units["force"]) == (1, 1.0, 1.0)
    for bearing, name in enumerate(run.bearing):
        for axis in range(3):
            force = functions[bearing + 1, axis + 1, 9]
            assert force["id1"] == f"bearing_force {name} {'xyz'[axis]} (N)"
            assert (force["func_type"], force["abscissa_spec_data_type"]) == (1, 17)
            assert (force["ordinate_len_unit_exp"], force["ordinate_force_unit_exp"]) == (0, 1)
            assert force["ordinate_axis_units_lab"].strip() == "N"
            np.testing.assert_allclose(force["data"], run.bearing_force[bearing, axis], rtol=1e-12)
            np.testing.assert_allclose(force["x"], run.time, atol=1e-12)
            motion = functions[bearing + 1, axis + 1, 12]
            assert motion["ordinate_axis_units_lab"].strip() == "m/s2"
            np.testing.assert_allclose(motion["data"], run.bearing_acceleration[bearing, axis], rtol=1e-12)
    error = functions[1001, 0, 8]
    assert (error["ordinate_len_unit_exp"], error["ordinate_axis_units_lab"].strip()) == (1, "m")
    np.testing.assert_allclose(error["data"], run.dynamic_transmission_error[0], rtol=1e-12)
    np.testing.assert_allclose(functions[1001, 0, 9]["data"], run.mesh_force[0], rtol=1e-12)


def test_a_tacho_counts_the_teeth_that_pass(run, tmp_path):
    """Its speed over time, times the teeth, is the travel of the mesh in base pitches."""
    _, _, functions = read(run, tmp_path / "run.unv")
    tacho = functions[1001, 0, 19]
    assert tacho["ordinate_axis_units_lab"].strip() == "rpm"
    teeth = {gear["name"]: gear["teeth"] for gear in run.case["gears"]}[run.case["meshes"][0]["driver"]]
    traveled = np.sum(tacho["data"]) / run.sample_rate * teeth / 60.0
    assert traveled == pytest.approx(np.ptp(np.unwrap(run.position[0], period=1.0)), rel=2e-3)
    assert not [key for key in read(run, tmp_path / "o.unv", "orders")[2] if key[2] == 19]


def test_nodes_are_at_bearings_and_meshes(run, tmp_path):
    _, nodes, _ = read(run, tmp_path / "run.unv")
    assert list(nodes["node_nums"]) == [1, 2, 3, 4, 1001]
    locations = np.stack([nodes["x"], nodes["y"], nodes["z"]], axis=1)
    bushings = run.case["bushings"]
    origin = {shaft["name"]: shaft["origin"] for shaft in run.case["shafts"]}
    for location, bushing in zip(locations[:4], bushings, strict=True):
        x, y, z = origin[bushing["shaft"]]
        np.testing.assert_allclose(location, [x, y, z + bushing["position"]], atol=1e-12)
    np.testing.assert_allclose(locations[4], run.case["meshes"][0]["point_of_action"], atol=1e-12)
    assert np.ptp(locations[:4, 2]) > 0.1


def test_spectra_are_those_of_the_stretch(run, tmp_path):
    _, _, functions = read(run, tmp_path / "run.unv", "spectrum", 0.1, 0.2)
    expected = window_spectrum(run, "bearing_force", 0.1, 0.2)
    force = functions[1, 2, 9]
    assert (force["func_type"], force["abscissa_spec_data_type"]) == (12, 18)
    np.testing.assert_allclose(force["data"], expected.amplitude[0, 1], rtol=1e-12)
    np.testing.assert_allclose(force["x"], expected.frequency, rtol=1e-5)


def test_orders_are_the_power_mean_of_the_waterfall(run, tmp_path):
    _, _, functions = read(run, tmp_path / "run.unv", "orders")
    force = functions[1, 1, 9]
    assert (force["func_type"], force["abscissa_spec_data_type"]) == (24, 20)
    blocks = order_waterfall(run, "bearing_force", highest=15).amplitude[0, 0]
    np.testing.assert_allclose(force["data"] ** 2, np.mean(blocks**2, axis=0), rtol=1e-11)
    assert force["x"][16] == pytest.approx(1.0)


def test_records_have_the_columns_of_the_format(run, tmp_path):
    """Read by the format's own description, not by a reader that may share our mistakes."""
    write_universal_file(run, tmp_path / "run.unv")
    lines = (tmp_path / "run.unv").read_text().splitlines()
    assert max(map(len, lines)) <= 80
    at = lines.index("    58", 1)
    assert lines[at - 1] == "    -1"
    kind = lines[at + 6]
    assert [kind[0:5], kind[31:41], kind[41:51], kind[51:55]] == ["    1", "input.left", f"{1:10d}", "   1"]
    form = lines[at + 7]
    assert [int(form[0:10]), int(form[10:20]), int(form[20:30])] == [4, run.time.size, 1]
    assert float(form[43:56]) == pytest.approx(1.0 / run.sample_rate, rel=1e-5)
    ordinate = lines[at + 9]
    assert [int(ordinate[0:10]), int(ordinate[15:20]), ordinate[26:46].strip()] == [9, 1, "Force"]
    assert ordinate[47:67].strip() == "N"
    assert float(lines[at + 12][:20]) == pytest.approx(run.bearing_force[0, 0, 0], rel=1e-12)


def test_what_cannot_be_written_is_refused_and_leaves_nothing(run, tmp_path):
    for arguments, field in (
        (("rms",), "function"),
        (("time", 0.3, 0.4), "window"),
        (("orders", 0.0, 0.01), "result"),
    ):
        with pytest.raises(InputError, match=field):
            write_universal_file(run, tmp_path / "run.unv", *arguments)
    assert list(tmp_path.iterdir()) == []
