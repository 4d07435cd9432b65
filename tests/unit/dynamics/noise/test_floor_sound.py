"""Sound and vibration of long tables: totals with the orders left out are those of all orders."""

from dataclasses import replace

import numpy as np
import pytest
from long_tables import deviating_unit
from transferred_scenes import housing, sound_model

from dynamics.assembly.assemble import assemble
from dynamics.linearize import harmonic_response
from dynamics.noise import forced_power, sound_band
from dynamics.noise.floor_sound import radiated_floor
from dynamics.vibration import housing_vibration

SPEEDS, ORDERS = np.linspace(90.0, 700.0, 6), 6
NAMES = tuple(seat.name for seat in housing().seats)


@pytest.fixture(scope="module")
def model():
    return sound_model(deviating_unit(37))


@pytest.fixture(scope="module")
def every(model):
    with pytest.MonkeyPatch.context() as whole:
        whole.setattr("dynamics.linearize.strongest_lines.ALWAYS", 100_000)
        power = forced_power(model, SPEEDS, ORDERS)[1]
        return harmonic_response(assemble(model.scene), SPEEDS, ORDERS), power


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr("dynamics.linearize.strongest_lines.MAX_AMPLITUDES", 0.0)
    monkeypatch.setattr("dynamics.linearize.strongest_lines.ALWAYS", 60)


def test_total_levels_and_bands_are_those_of_all_orders_within_the_stated_error(few, model, every):
    found, true = forced_power(model, SPEEDS, ORDERS)[1], every[1]
    assert true.floor is None and true.total_error is None and found.power.shape[0] < true.power.shape[0]
    listed = replace(found, floor=None).total_weighted_level
    missing = true.total_weighted_level - listed
    assert np.max(missing) > 1.0
    assert np.all(np.abs(found.total_weighted_level - true.total_weighted_level) <= found.total_error)
    assert np.max(found.total_error) < 0.3
    np.testing.assert_allclose(found.total_level, true.total_level, atol=0.3)
    (center, power), (known, whole) = found.third_octaves(), true.third_octaves()
    np.testing.assert_array_equal(center, known)
    loud = whole > 1e-3 * whole.max(axis=0)
    np.testing.assert_allclose(power[loud], whole[loud], rtol=0.06)


def test_points_move_as_in_all_orders_within_the_stated_error(few, model, every):
    found, true = (
        housing_vibration(response, housing(), NAMES)
        for response in (harmonic_response(assemble(model.scene), SPEEDS, ORDERS), every[0])
    )
    listed = replace(found, floor=None).overall
    assert np.max(1.0 - listed / true.overall) > 0.1
    assert np.all(np.abs(found.overall - true.overall) <= found.overall_error)
    assert np.max(found.overall_error / true.overall) < 0.04
    assert np.all(true.overall_error == 0.0)


def test_the_band_of_totals_holds_the_error_of_the_orders_left_out(few, model):
    band = sound_band(model, SPEEDS, 3, {}, cases=1)
    power = forced_power(model, SPEEDS, 3)[1]
    own = int(np.argmax(power.total_weighted_power))
    assert band.largest_total.nominal == pytest.approx(power.total_weighted_level.max(), abs=1e-9)
    assert band.largest_total.below["orders_left_out"] == pytest.approx(power.total_error[own])
    assert all("orders_left_out" not in level.below for level in band.largest)


def test_two_halves_of_a_housing_radiate_what_it_does(few, model):
    floor = harmonic_response(assemble(model.scene), SPEEDS, ORDERS).floor
    whole = radiated_floor(floor, housing(), NAMES, model.resistance["case"])
    half = whole._replace(power=0.5 * whole.power, missed=0.5 * whole.missed)
    both = type(whole).of_all([half, half])
    for own, expected in zip(both, whole, strict=True):
        np.testing.assert_allclose(own, expected, rtol=1e-12)
