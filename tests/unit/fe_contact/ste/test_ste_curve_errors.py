"""Errors of mean, peak-to-peak and harmonics: how changes are measured, stored and requested."""

from __future__ import annotations

import math
from dataclasses import replace

import h5netcdf
import numpy as np
import pytest

from fe_contact.errors import DatabaseError
from fe_contact.ste.curve import AT_NODES, SOURCES
from fe_contact.ste.curve_quantities import (
    FIRST_HARMONIC,
    MEAN,
    PEAK_TO_PEAK,
    QUANTITIES,
    missed_peaks,
    quantity_changes,
)
from fe_contact.ste.database import SteDatabase

X = np.arange(64) / 64
WAVE = (8e-6 + 2e-6 * np.cos(2.0 * np.pi * X) + 0.5e-6 * np.cos(6.0 * np.pi * X))[:, None]


def test_no_difference_is_no_change() -> None:
    assert not quantity_changes(X, WAVE, WAVE, 1).any()


def test_a_constant_moves_the_mean_alone() -> None:
    change = quantity_changes(X, WAVE, WAVE + 1e-7, 1)[:, 0]
    assert change[MEAN] == pytest.approx(1e-7, rel=1e-9)
    assert change[1:].max() < 1e-19


def test_changes_scale_with_the_difference() -> None:
    bend = 1e-8 * np.cos(2.0 * np.pi * X)[:, None]
    one = quantity_changes(X, WAVE, WAVE + bend, 1)
    three = quantity_changes(X, WAVE, WAVE + 3.0 * bend, 1)
    assert three[:3] == pytest.approx(3.0 * one[:3], rel=1e-6, abs=1e-18)
    assert one[FIRST_HARMONIC, 0] == pytest.approx(1e-8, rel=1e-3)
    assert one[PEAK_TO_PEAK, 0] == pytest.approx(2e-8, rel=1e-2)


def test_a_shift_in_phase_does_not_hide_in_an_amplitude() -> None:
    moved = (8e-6 + 2e-6 * np.cos(2.0 * np.pi * (X - 0.01)))[:, None]
    still = (8e-6 + 2e-6 * np.cos(2.0 * np.pi * X))[:, None]
    change = quantity_changes(X, still, moved, 1)[FIRST_HARMONIC, 0]
    assert change == pytest.approx(2e-6 * 2.0 * math.sin(0.01 * math.pi), rel=1e-2)


def test_rows_that_failed_are_left_out_and_too_few_are_unknown() -> None:
    holed = np.tile(WAVE, 2)
    holed[5, 0] = np.nan
    holed[4:, 1] = np.nan
    change = quantity_changes(X, np.tile(WAVE, 2), holed + 1e-7, 1)
    assert change[MEAN, 0] == pytest.approx(1e-7, rel=1e-9)
    assert np.isnan(change[:, 1]).all()


def test_a_change_of_shape_that_leaves_peak_to_peak_counts_by_half() -> None:
    moved = WAVE + 1e-8 * np.sin(2.0 * np.pi * X)[:, None]
    change = quantity_changes(X, WAVE, moved, 1)[PEAK_TO_PEAK, 0]
    assert change == pytest.approx(1e-8, rel=1e-2)


@pytest.mark.parametrize("apex", [0.3 / 64, 0.5 / 64, 0.5 + 0.8 / 64])
def test_the_peak_of_a_tent_between_two_knots_is_found(apex: float) -> None:
    tent = np.abs((X - apex + 0.5) % 1.0 - 0.5)[:, None]
    missed = 0.5 - np.ptp(tent)
    assert missed > 1e-3
    assert missed_peaks(X, tent, 1)[0] == pytest.approx(missed, rel=1e-9)
    assert missed_peaks(X, -tent, 1)[0] == pytest.approx(missed, rel=1e-9)


def test_a_step_between_flat_parts_misses_nothing() -> None:
    step = np.where((X > 0.2) & (X < 0.7), 1.0, 0.0)[:, None]
    assert missed_peaks(X, step, 1)[0] == 0.0


def test_harmonics_of_a_longer_period_are_those_of_the_mesh() -> None:
    position = np.arange(192) / 64
    other = np.tile(WAVE, (3, 1)) + 1e-8 * np.cos(2.0 * np.pi * position)[:, None]
    change = quantity_changes(position, np.tile(WAVE, (3, 1)), other, 3)[:, 0]
    assert change[FIRST_HARMONIC] == pytest.approx(1e-8, rel=1e-3)
    assert change[FIRST_HARMONIC + 1 :].max() < 1e-10


@pytest.fixture
def assessed(spur: SteDatabase) -> SteDatabase:
    """The fake table with errors of every source: source number in nm, times the load's number."""
    shape = spur.static_transmission_error.shape[1:]
    errors = np.zeros((len(SOURCES), QUANTITIES, *shape))
    errors[:5] = np.arange(1, 6).reshape(5, 1, 1, 1, 1) * 1e-9
    errors *= np.arange(1, shape[0] + 1)[:, None, None]
    errors[SOURCES.index("force"), :, :-1] = 7e-9
    return replace(spur, curve_error=errors)


def test_the_error_is_that_of_independent_sources(assessed: SteDatabase) -> None:
    for k, force in enumerate(assessed.force):
        curve = assessed.curve(force=float(force))
        for found in (curve.mean, curve.peak_to_peak, *curve.harmonics):
            assert found.error == pytest.approx(math.sqrt(55.0) * 1e-9 * (k + 1), rel=1e-12, abs=0.0)


def test_between_two_loads_their_interpolation_is_added(assessed: SteDatabase) -> None:
    middle = 0.5 * float(assessed.force[0] + assessed.force[1])
    expected = math.hypot(1.5 * math.sqrt(55.0), 7.0) * 1e-9
    assert assessed.mean(force=middle).error == pytest.approx(expected, rel=1e-9, abs=0.0)


def test_what_was_not_estimated_is_no_number(assessed: SteDatabase) -> None:
    errors = assessed.curve_error.copy()
    errors[1] = np.nan
    assert math.isnan(
        replace(assessed, curve_error=errors).peak_to_peak(force=float(assessed.force[0])).error
    )


def test_files_keep_the_errors_and_older_ones_have_bands(assessed: SteDatabase, spur, tmp_path) -> None:
    assessed.to_netcdf(tmp_path / "new.nc")
    spur.to_netcdf(tmp_path / "old.nc")
    assert SteDatabase.from_netcdf(tmp_path / "new.nc").identical(assessed)
    old = SteDatabase.from_netcdf(tmp_path / "old.nc")
    assert old.curve_error.size == 0
    assert old.mean(force=float(old.force[0])) == spur.mean(force=float(old.force[0]))
    assert not assessed.identical(spur)


def test_files_of_schema_1_state_no_error_of_the_model(assessed: SteDatabase, tmp_path) -> None:
    source = AT_NODES.index("model")
    before = replace(assessed, curve_error=np.delete(assessed.curve_error, source, axis=0))
    before.to_netcdf(tmp_path / "one.nc")
    found = SteDatabase.from_netcdf(tmp_path / "one.nc")
    assert not found.curve_error[source].any()
    assert np.array_equal(np.delete(found.curve_error, source, axis=0), before.curve_error)
    found.to_netcdf(tmp_path / "again.nc")
    assert SteDatabase.from_netcdf(tmp_path / "again.nc").identical(found)


def test_damaged_errors_are_refused(assessed: SteDatabase, tmp_path) -> None:
    assessed.to_netcdf(tmp_path / "ste.nc")
    with h5netcdf.File(tmp_path / "ste.nc", "a") as file:
        file.variables["curve_error"][0, 0, 0, 0, 0] = 1.0
    with pytest.raises(DatabaseError, match="checksum"):
        SteDatabase.from_netcdf(tmp_path / "ste.nc")


def test_errors_below_zero_or_of_another_table_are_refused(assessed: SteDatabase) -> None:
    with pytest.raises(DatabaseError, match="curve_error must be >= 0"):
        replace(assessed, curve_error=-assessed.curve_error)
    with pytest.raises(DatabaseError, match="curve_error must have the dimensions"):
        replace(assessed, curve_error=assessed.curve_error[:, :, :1])
