"""Errors measured at some nodes of an axis: exact there, exact for what is linear, NaN beside NaN."""

import numpy as np
import pytest

from fe_contact import Gear, GearPair, analyze
from fe_contact.analysis.estimates import position_errors
from fe_contact.analysis.estimates import table_sample as solved_again
from fe_contact.sampled import sample_of, sampled_positions, spread, spread_around
from fe_contact.ste.curve_errors import AT_NODES

LOADS = np.array([100.0, 150.0, 230.0, 400.0, 700.0, 1100.0, 2000.0])


def test_both_ends_are_always_solved_and_positions_evenly_taken():
    for count in range(1, 12):
        sample = sample_of(count, 4)
        assert sample.size == min(count, 4)
        assert (sample[0], sample[-1]) == (0, count - 1)
        assert np.all(np.diff(sample) > 0)
    for count in (8, 31, 32, 63, 64, 110, 768):
        rows = sampled_positions(count)
        assert rows[0] == 0 and rows.size >= min(count, 32)
        assert np.unique(np.diff(rows)).size == 1
        assert rows.size < 64 or count < 64


@pytest.mark.parametrize("axis", [0, 1, -1])
def test_what_is_linear_is_carried_on_exactly(axis):
    sample = sample_of(LOADS.size, 4)
    values = np.random.default_rng(3).random((7, 7, 7))
    line = 2.0 + 3e-3 * LOADS
    whole = np.moveaxis(values[:, :, :1] * line, -1, axis)
    found = spread(LOADS, sample, np.take(whole, sample, axis=axis), axis)
    np.testing.assert_allclose(found, whole, rtol=1e-13)


def test_what_is_solved_stays_and_a_closed_axis_is_linear_over_its_seam():
    sample = sample_of(LOADS.size, 4)
    values = np.array([1.0, np.nan, 3.0, 5.0])
    found = spread(LOADS, sample, values, 0)
    assert np.array_equal(found[sample], values, equal_nan=True)
    assert np.isfinite(found[sample[2] :]).all()
    full = np.arange(7.0)
    assert spread(LOADS, np.arange(7), full, 0) is full
    knots = np.array([0.0, 0.1, 0.4, 0.8, 1.0, 1.7])
    around = np.array([0.0, 0.4, 1.0])
    values = np.array([1.0, 5.0, 3.0])
    found = spread_around(knots, 2, np.searchsorted(knots, around), values)
    np.testing.assert_allclose(found, np.interp(knots, [*around, 2.0], [*values, 1.0]), rtol=1e-13)


@pytest.mark.law
def test_stated_errors_hardly_depend_on_what_is_sampled(monkeypatch):
    """Against errors that are measured at every position, load and misalignment, from three loads on."""
    gear = Gear(teeth=20, normal_module=2e-3, face_width=8e-3, bore_diameter=20e-3)
    how = {
        "normal_forces": list(LOADS),
        "level": "draft",
        "positions": 64,
        "misalignments": [-1e-5, -5e-6, 0.0, 5e-6, 1e-5],
    }
    sampled = analyze(GearPair(gear, gear, 40e-3), **how)
    for module in (solved_again, position_errors):
        monkeypatch.setattr(module, "sample_of", lambda count, _: np.arange(count))
    monkeypatch.setattr(solved_again, "sampled_positions", np.arange)
    whole = analyze(GearPair(gear, gear, 40e-3), **how)
    one, all_ = (table.curve_error[: len(AT_NODES), :2].sum(axis=0) for table in (sampled, whole))
    assert 0.9 < np.median(one / all_) < 1.1
    assert 0.8 < (one / all_).min() < (one / all_).max() < 1.6
    assert np.array_equal(sampled.static_transmission_error, whole.static_transmission_error)
