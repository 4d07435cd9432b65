"""The floor of long tables: the power of the lines left out, its error, what has none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from geared_scenes import gear_pair_scene, spring_table, with_mesh
from long_tables import deviating_unit, repeated

from dynamics.assembly.assemble import assemble
from dynamics.linearize import ForcedResponse, common_period, forced_response, harmonic_response
from dynamics.orders.third_octaves import band_number

LONG = 67
SPEED = np.linspace(20.0, 200.0, 50)
SPEEDS = {"pair": SPEED, "lightly damped pair": SPEED, "unit in its housing": np.linspace(30.0, 700.0, 6)}
ORDERS = 9


@cache
def system(name: str):
    if name == "unit in its housing":
        return assemble(deviating_unit(59))
    table = repeated(spring_table(4e8, 1e-7), LONG, 1e-6 * np.random.default_rng(1).normal(size=LONG))
    ratio = 0.05 if name == "pair" else 0.001
    return assemble(with_mesh(gear_pair_scene(table), damping_ratio=ratio, damping=None))


@cache
def every(name: str) -> ForcedResponse:
    return forced_response(system(name), SPEEDS[name], ORDERS)


@pytest.fixture
def few(monkeypatch):
    """A hundred lines, as a much longer table would have of its own."""
    monkeypatch.setattr("dynamics.linearize.strongest_lines.MAX_AMPLITUDES", 0.0)
    monkeypatch.setattr("dynamics.linearize.strongest_lines.ALWAYS", 100)


def some(name: str) -> ForcedResponse:
    return forced_response(system(name), SPEEDS[name], ORDERS)


@pytest.mark.parametrize("name", SPEEDS)
def test_with_the_floor_mean_squares_are_those_of_all_lines_within_the_stated_error(few, monkeypatch, name):
    with monkeypatch.context() as whole:
        whole.setattr("dynamics.linearize.strongest_lines.ALWAYS", 100_000)
        true = every(name).bearing_mean_square
    found = some(name)
    assert found.metadata["lines_left_out"]["in_totals"]
    assert found.bearing_floor.size and np.max(found.bearing_floor / true) > 0.5
    assert np.all(np.abs(found.bearing_mean_square - true) <= found.bearing_floor_error)
    floor = replace(found.floor, changed=np.zeros_like(found.floor.changed))
    straight = [floor.of_bearing(index) for index in range(len(floor.bearing))]
    part = [np.sum(own.missed, axis=1) / np.sum(own.power, axis=1) for own in straight]
    assert np.median(part) < 0.06


@pytest.mark.parametrize("name", SPEEDS)
def test_every_single_line_with_mean_stiffness_lies_within_its_stated_error(few, monkeypatch, name):
    with monkeypatch.context() as whole:
        whole.setattr("dynamics.linearize.strongest_lines.ALWAYS", 100_000)
        true = harmonic_response(system(name), SPEEDS[name], ORDERS)
    floor = harmonic_response(system(name), SPEEDS[name], ORDERS).floor
    harmonic = np.rint(true.order * common_period(system(name)).counted)
    for line in range(0, floor.harmonic.size, 9):
        own = replace(floor, harmonic=floor.harmonic[[line]], inputs=floor.inputs[:, [line]]).of_bearing(0)
        force = true.bearing_force[0, :3, :, harmonic == floor.harmonic[line]]
        square = 0.5 * np.sum(np.abs(force) ** 2, axis=(0, 1))
        assert np.all(np.abs(own.power.sum(axis=1) - square) <= own.missed.sum(axis=1))


def test_what_is_stated_falls_with_the_square_of_the_steps(few, monkeypatch):
    coarse = some("pair")
    monkeypatch.setattr("dynamics.linearize.line_floor.WIDEST", 0.005)
    monkeypatch.setattr("dynamics.linearize.line_floor.MODE_STEP", 0.125)
    ratio = some("pair").bearing_floor_error / coarse.bearing_floor_error
    assert np.all((ratio > 0.19) & (ratio < 0.3))


def test_where_nothing_is_left_out_there_is_no_floor():
    found = every("pair")
    assert found.floor is None and found.bearing_floor.size == 0 and "lines_left_out" not in found.metadata
    listed = 0.5 * np.sum(np.abs(found.bearing_force[:, :3]) ** 2, axis=(1, 3))
    np.testing.assert_array_equal(found.bearing_mean_square, listed)


def test_powers_are_in_bins_whose_frequency_is_that_of_their_lines(few):
    floor = some("pair").floor
    power = floor.of_bearing(0)
    hertz = np.outer(floor.pace, floor.harmonic)
    kept = power.power > 0.0
    bands = [np.unique(band_number(own)) for own in hertz]
    for row, own in enumerate(bands):
        assert set(band_number(power.frequency[row, kept[row]])) <= set(own)
    # a form that is 1 W per N^2 is the power of the inputs
    unit = np.broadcast_to(np.eye(len(floor.inputs)), (floor.frequency.size, *2 * (len(floor.inputs),)))
    made = floor.power(unit)
    np.testing.assert_allclose(made.power.sum(axis=1), np.sum(np.abs(floor.inputs) ** 2), rtol=1e-12)
    mean = np.sum(made.power * made.frequency, axis=1) / made.power.sum(axis=1)
    whole = np.sum(np.abs(floor.inputs) ** 2, axis=0)
    np.testing.assert_allclose(mean, hertz @ whole / whole.sum(), rtol=1e-12)
    assert np.all(made.missed <= 1e-12 * made.power.max())


def test_a_file_keeps_mean_squares_and_not_the_floor(few, tmp_path):
    found = some("pair")
    found.to_netcdf(tmp_path / "response.nc")
    read = ForcedResponse.from_netcdf(tmp_path / "response.nc")
    assert read.floor is None
    np.testing.assert_array_equal(read.bearing_mean_square, found.bearing_mean_square)
    np.testing.assert_array_equal(read.bearing_floor_error, found.bearing_floor_error)


@pytest.mark.parametrize("choice", ["off", "on"])
def test_totals_lack_the_lines_left_out_where_shafts_gyrate_and_say_so(few, choice):
    """Gyroscopic terms of shafts alone, without a carrier: transfer functions are others at every speed."""
    table = repeated(spring_table(4e8, 1e-7), LONG, 1e-6 * np.random.default_rng(1).normal(size=LONG))
    effects = {"lateral": "on", "tilt": "on", "gyroscopic": choice}
    made = forced_response(assemble(gear_pair_scene(table, effects=effects)), SPEED[:3], ORDERS)
    there = choice == "off"
    assert made.metadata["lines_left_out"]["in_totals"] == there == (made.floor is not None)
    assert 0.0 < made.metadata["lines_left_out"]["force"] < 1.0
    assert bool(made.bearing_floor.size) == there
