"""Tables with failed points and with noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fe_contact.errors import DatabaseError, SolveError
from fe_contact.ste.database import _without_failed
from fe_contact.types import Status


def failed_at(database, *places):
    """The database with some points failed."""
    ste, status = database.static_transmission_error.copy(), database.status.copy()
    for place in places:
        ste[place], status[place] = np.nan, Status.ITERATION_LIMIT
    return replace(database, static_transmission_error=ste, status=status)


class TestWithoutFailed:
    def test_a_complete_table_is_returned_as_it_is(self, spur):
        assert _without_failed(spur) is spur

    def test_a_failed_load_goes_as_a_load(self, spur):
        rest = _without_failed(failed_at(spur, np.s_[:, 4]))
        assert rest.force.tolist() == spur.force[:4].tolist()
        assert rest.position.size == 64

    def test_scattered_points_go_as_positions(self, spur):
        rest = _without_failed(failed_at(spur, (3, 0), (17, 4)))
        assert rest.position.tolist() == np.delete(spur.position, [3, 17]).tolist()
        assert rest.force.size == 5

    def test_what_stays_is_unchanged(self, four_axes):
        rest = _without_failed(failed_at(four_axes, np.s_[:, :, 3]))
        assert rest.misalignment.tolist() == four_axes.misalignment[:3].tolist()
        assert np.array_equal(rest.load_share, four_axes.load_share[:, :, :3])
        assert np.array_equal(rest.no_load_transmission_error, four_axes.no_load_transmission_error[:, :3])

    def test_nothing_left_is_an_error(self, spur):
        with pytest.raises(SolveError, match="No complete row remains"):
            _without_failed(failed_at(spur, np.s_[:]))


def noisy(make, size, seed=2):
    """A table with closely spaced loads and noise of `size` meters."""
    database = make(force=2660.0 * (1.0 + 0.01 * np.arange(8)))
    noise = np.random.default_rng(seed).normal(scale=size, size=(64, 8, 1, 1))
    return replace(database, static_transmission_error=database.static_transmission_error + noise)


class TestMonotoneRepaired:
    def test_noise_is_refused_first_and_repaired_on_request(self, make):
        database = noisy(make, 5e-8)
        with pytest.raises(DatabaseError, match="monotone_repaired"):
            database.force_table()
        repaired, report = database.monotone_repaired()
        assert np.all(np.diff(repaired.force_table().deflection, axis=-1) > 0.0)
        assert report.curves > 30

    def test_the_report_names_the_largest_change(self, make):
        database = noisy(make, 5e-8)
        repaired, report = database.monotone_repaired()
        change = np.abs(repaired.static_transmission_error - database.static_transmission_error)
        i, k = (
            int(np.searchsorted(database.position, report.position)),
            int(np.searchsorted(database.force, report.force)),
        )
        assert report.largest_change == pytest.approx(change.max(), rel=1e-9)
        assert change[i, k, 0, 0] == change.max()
        assert repaired.metadata.receipt["monotone_repair"]["largest_change"] == report.largest_change

    def test_the_change_widens_the_error_band(self, make):
        database = noisy(make, 5e-8)
        repaired, _ = database.monotone_repaired()
        change = np.abs(repaired.static_transmission_error - database.static_transmission_error)
        assert repaired.error_estimate == pytest.approx(database.error_estimate + change, rel=1e-9)

    def test_repair_comes_closer_to_the_truth(self, make):
        truth = make(force=2660.0 * (1.0 + 0.01 * np.arange(8))).static_transmission_error
        database = noisy(make, 5e-8)
        repaired, _ = database.monotone_repaired()
        before = np.sqrt(np.mean((database.static_transmission_error - truth) ** 2))
        assert np.sqrt(np.mean((repaired.static_transmission_error - truth) ** 2)) < before

    def test_lift_off_is_not_moved(self, make):
        """The no-load transmission error is geometry; a first load below it is what has to yield."""
        database = make()
        ste = database.static_transmission_error.copy()
        ste[7, 0] = -1e-7
        repaired, report = replace(database, static_transmission_error=ste).monotone_repaired()
        assert report.curves == 1
        moved = repaired.no_load_transmission_error - database.no_load_transmission_error
        assert np.abs(moved).max() < 1e-12
        assert repaired.static_transmission_error[7, 0, 0, 0] > 0.0

    def test_series_in_order_are_not_touched(self, make):
        database = make()
        repaired, report = database.monotone_repaired()
        assert report.curves == 0
        assert report.largest_change == 0.0
        assert np.array_equal(repaired.static_transmission_error, database.static_transmission_error)

    def test_failed_points_come_first(self, spur):
        with pytest.raises(SolveError, match="1 of 320"):
            failed_at(spur, (1, 1)).monotone_repaired()
